// The sum over links with AVX2. Compiled for it, and called only where the machine has it.
#include "runtime/src/prm_links_sum.h"

#ifdef __AVX2__
#include <immintrin.h>

namespace lightwell::runtime {
namespace {

struct Eight {
  static void add(float* sum, const int8_t* coefficient, const float* light) {
    const __m256 value = _mm256_cvtepi32_ps(_mm256_cvtepi8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(coefficient))));
    _mm256_storeu_ps(sum, _mm256_fmadd_ps(value, _mm256_loadu_ps(light), _mm256_loadu_ps(sum)));
  }
};

}  // namespace

bool addChangesAvx2(const LinkArrays& links, const LinkChange& change, float tolerance, size_t& read) {
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return false;
  read = addChanges<Eight>(links, change, tolerance);
  return true;
}

}  // namespace lightwell::runtime
#else
namespace lightwell::runtime {
bool addChangesAvx2(const LinkArrays&, const LinkChange&, float, size_t&) { return false; }
}  // namespace lightwell::runtime
#endif
