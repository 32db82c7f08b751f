// Products with AVX2. Compiled for it, and called only where the machine has it. Eigen has another name here: the linker would take these instantiations of its templates for
// those of all other files.
#define Eigen EigenAvx2
#include "precompute/transport/prm/product.h"

namespace lightwell::transport {

#ifdef __AVX2__
bool multiplyAvx2(const Product& product) {
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return false;
  multiplyByEigen(product);
  return true;
}

bool multiplySparseAvx2(const SparseProduct& product) {
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return false;
  multiplySparseByVectors(product);
  return true;
}
#else
bool multiplyAvx2(const Product&) { return false; }
bool multiplySparseAvx2(const SparseProduct&) { return false; }
#endif

}  // namespace lightwell::transport
