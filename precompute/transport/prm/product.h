// Products of dense matrices, by the instructions that the machine has.
#pragma once
#include <Eigen/Core>
#include <cstddef>

namespace lightwell::transport {

/// The parts of c = a · b: a by columns; b by rows, of which one begins `b_stride` numbers after the other; c by rows. Then Eigen copies b, the large one, with the widest loads.
struct Product {
  std::ptrdiff_t rows, inner, columns;
  const float* a;
  const float* b;
  std::ptrdiff_t b_stride;
  float* c;
};

namespace {
/// The product by Eigen for whichever instructions the including file is compiled for.
[[maybe_unused]] void multiplyByEigen(const Product& p) {
  using Columns = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic>;
  using Rows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::Map<Rows>(p.c, p.rows, p.columns).noalias() =
      Eigen::Map<const Columns>(p.a, p.rows, p.inner) * Eigen::Map<const Rows, 0, Eigen::OuterStride<>>(p.b, p.inner, p.columns, Eigen::OuterStride<>(p.b_stride));
}
}  // namespace

using RowMajorMatrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Returns whether the machine could.
bool multiplyAvx2(const Product& product);

/// a · b. Fits spend a quarter of their time in such products, which Eigen makes for the machine that it is compiled for: any x86-64. As with Embree, another machine may round
/// differently.
RowMajorMatrix multiply(const Eigen::MatrixXf& a, const Eigen::Ref<const RowMajorMatrix>& b);

}  // namespace lightwell::transport
