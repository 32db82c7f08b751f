#include "precompute/transport/prm/product.h"

namespace lightwell::transport {

RowMajorMatrix multiply(const Eigen::MatrixXf& a, const Eigen::Ref<const RowMajorMatrix>& b) {
  RowMajorMatrix c(a.rows(), b.cols());
  const Product product{a.rows(), a.cols(), b.cols(), a.data(), b.data(), b.outerStride(), c.data()};
  if (!multiplyAvx2(product)) multiplyByEigen(product);
  return c;
}

void multiply(const SparseRows& a, const Eigen::Ref<const RowMajorMatrix>& b, Eigen::Ref<RowMajorMatrix> c) {
  const SparseProduct product{&a, b.cols(), b.data(), b.outerStride(), c.data(), c.outerStride()};
  if (!multiplySparseAvx2(product)) multiplySparseByVectors(product);
}

}  // namespace lightwell::transport
