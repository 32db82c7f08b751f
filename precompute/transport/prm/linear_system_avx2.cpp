// Systems with AVX2. Compiled for it, and called only where the machine has it; for Eigen's other name see product_avx2.cpp.
#define Eigen EigenAvx2
#include "precompute/transport/prm/linear_system.h"

namespace lightwell::transport {

#ifdef __AVX2__
bool solveAvx2(const LinearSystem& system) {
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return false;
  solveByEigen(system);
  return true;
}
#else
bool solveAvx2(const LinearSystem&) { return false; }
#endif

}  // namespace lightwell::transport
