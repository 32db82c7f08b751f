#include "precompute/transport/prm/product.h"

namespace lightwell::transport {

RowMajorMatrix multiply(const Eigen::MatrixXf& a, const Eigen::Ref<const RowMajorMatrix>& b) {
  RowMajorMatrix c(a.rows(), b.cols());
  const Product product{a.rows(), a.cols(), b.cols(), a.data(), b.data(), b.outerStride(), c.data()};
  if (!multiplyAvx2(product)) multiplyByEigen(product);
  return c;
}

}  // namespace lightwell::transport
