#include "precompute/transport/prm/linear_system.h"

namespace lightwell::transport {

Eigen::MatrixXd solve(Eigen::MatrixXd a, Eigen::MatrixXd b) {
  const LinearSystem system{a.rows(), a.data(), b.data()};
  if (!solveAvx2(system)) solveByEigen(system);
  return b;
}

}  // namespace lightwell::transport
