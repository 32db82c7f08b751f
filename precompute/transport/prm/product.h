// Products of matrices, by the instructions that the machine has.
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

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

typedef float Eight __attribute__((vector_size(32)));
}  // namespace

/// A sparse matrix by rows.
struct SparseRows {
  std::vector<uint32_t> first = {0};  // rows + 1
  std::vector<uint32_t> column;
  std::vector<float> value;
  size_t rows() const { return first.size() - 1; }
};

/// The parts of c = a · b with a sparse: b and c by rows.
struct SparseProduct {
  const SparseRows* a;
  std::ptrdiff_t columns;
  const float* b;
  std::ptrdiff_t b_stride;
  float* c;
  std::ptrdiff_t c_stride;
};

namespace {
/// `vectors` times eight columns from `begin` on: a row of the result stays in registers.
template <std::ptrdiff_t vectors>
void multiplyTile(const SparseProduct& p, std::ptrdiff_t begin) {
  for (size_t r = 0; r < p.a->rows(); ++r) {
    Eight sum[vectors] = {};
    for (uint32_t i = p.a->first[r]; i < p.a->first[r + 1]; ++i) {
      const float* b = p.b + std::ptrdiff_t(p.a->column[i]) * p.b_stride + begin;
      for (std::ptrdiff_t v = 0; v < vectors; ++v) {
        Eight eight;
        std::memcpy(&eight, b + v * 8, sizeof eight);
        sum[v] += eight * p.a->value[i];
      }
    }
    std::memcpy(p.c + std::ptrdiff_t(r) * p.c_stride + begin, sum, sizeof sum);
  }
}

/// In tiles of columns, so that those of `b` that are met stay in the second-level cache.
[[maybe_unused]] void multiplySparseByVectors(const SparseProduct& p) {
  std::ptrdiff_t begin = 0;
  for (; begin + 64 <= p.columns; begin += 64) multiplyTile<8>(p, begin);
  for (; begin + 16 <= p.columns; begin += 16) multiplyTile<2>(p, begin);
  for (; begin + 8 <= p.columns; begin += 8) multiplyTile<1>(p, begin);
  for (size_t r = 0; r < p.a->rows(); ++r)
    for (std::ptrdiff_t k = begin; k < p.columns; ++k) {
      float sum = 0;
      for (uint32_t i = p.a->first[r]; i < p.a->first[r + 1]; ++i) sum += p.b[std::ptrdiff_t(p.a->column[i]) * p.b_stride + k] * p.a->value[i];
      p.c[std::ptrdiff_t(r) * p.c_stride + k] = sum;
    }
}
}  // namespace

using RowMajorMatrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Return whether the machine could.
bool multiplyAvx2(const Product& product);
bool multiplySparseAvx2(const SparseProduct& product);

/// a · b, [rows][columns]. Eigen makes products for the machine that it is compiled for: any x86-64; these are for the machine that it runs on. As with Embree, another one may round
/// differently.
RowMajorMatrix multiply(const Eigen::MatrixXf& a, const Eigen::Ref<const RowMajorMatrix>& b);

/// The same with a sparse `a`, into `c`, [a.rows()][b.cols()].
void multiply(const SparseRows& a, const Eigen::Ref<const RowMajorMatrix>& b, Eigen::Ref<RowMajorMatrix> c);

}  // namespace lightwell::transport
