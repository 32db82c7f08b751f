#include "precompute/transport/prm/linear_system.h"

#include <utility>

namespace lightwell::transport {
namespace {

template <class Matrix>
Matrix solveInPlace(Matrix& a, Matrix& b) {
  const LinearSystem<typename Matrix::Scalar> system{a.rows(), a.data(), b.data()};
  if (!solveAvx2(system)) solveByEigen(system);
  return std::move(b);
}

}  // namespace

Eigen::MatrixXf solve(Eigen::MatrixXf a, Eigen::MatrixXf b) { return solveInPlace(a, b); }
Eigen::MatrixXd solve(Eigen::MatrixXd a, Eigen::MatrixXd b) { return solveInPlace(a, b); }

}  // namespace lightwell::transport
