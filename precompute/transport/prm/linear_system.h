// Dense systems of linear equations, by the instructions that the machine has.
#pragma once
#include <Eigen/LU>
#include <cstddef>

namespace lightwell::transport {

/// The parts of a · x = b, all [size][size] by columns; a and b are used up, b receives x.
template <class Scalar>
struct LinearSystem {
  std::ptrdiff_t size;
  Scalar *a, *b;
};

namespace {
/// LU with partial pivoting in place, by Eigen for whichever instructions the including file is compiled for.
template <class Scalar>
[[maybe_unused]] void solveByEigen(const LinearSystem<Scalar>& system) {
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  Eigen::Map<Matrix> a(system.a, system.size, system.size), b(system.b, system.size, system.size);
  const Eigen::PartialPivLU<Eigen::Ref<Matrix>> lu(a);
  b = lu.solve(b).eval();
}
}  // namespace

/// Return whether the machine could.
bool solveAvx2(const LinearSystem<float>& system);
bool solveAvx2(const LinearSystem<double>& system);

/// x of a · x = b.
Eigen::MatrixXf solve(Eigen::MatrixXf a, Eigen::MatrixXf b);
Eigen::MatrixXd solve(Eigen::MatrixXd a, Eigen::MatrixXd b);

}  // namespace lightwell::transport
