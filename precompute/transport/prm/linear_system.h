// Dense systems of linear equations, by the instructions that the machine has.
#pragma once
#include <Eigen/LU>
#include <cstddef>

namespace lightwell::transport {

/// The parts of a · x = b, all [size][size] by columns; a and b are used up, b receives x.
struct LinearSystem {
  std::ptrdiff_t size;
  double *a, *b;
};

namespace {
/// LU with partial pivoting in place, by Eigen for whichever instructions the including file is compiled for.
[[maybe_unused]] void solveByEigen(const LinearSystem& system) {
  using Map = Eigen::Map<Eigen::MatrixXd>;
  Map a(system.a, system.size, system.size), b(system.b, system.size, system.size);
  const Eigen::PartialPivLU<Eigen::Ref<Eigen::MatrixXd>> lu(a);
  b = lu.solve(b).eval();
}
}  // namespace

/// Returns whether the machine could.
bool solveAvx2(const LinearSystem& system);

/// x of a · x = b.
Eigen::MatrixXd solve(Eigen::MatrixXd a, Eigen::MatrixXd b);

}  // namespace lightwell::transport
