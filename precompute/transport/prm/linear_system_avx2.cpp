// Systems with AVX2. Compiled for it, and called only where the machine has it; for Eigen's other name see product_avx2.cpp.
#define Eigen EigenAvx2
#include "precompute/transport/prm/linear_system.h"

namespace lightwell::transport {
namespace {

template <class Scalar>
bool solveWhereItCan(const LinearSystem<Scalar>& system) {
#ifdef __AVX2__
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return false;
  solveByEigen(system);
  return true;
#else
  return system.size < 0;
#endif
}

}  // namespace

bool solveAvx2(const LinearSystem<float>& system) { return solveWhereItCan(system); }
bool solveAvx2(const LinearSystem<double>& system) { return solveWhereItCan(system); }

}  // namespace lightwell::transport
