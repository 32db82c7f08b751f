// Tiles with AVX2. Compiled for it, and called only where the machine has it.
#include "runtime/src/prm_tile.h"

namespace lightwell::runtime {

#ifdef __AVX2__
bool reconstructTileAvx2(const Float4* amount_rgb, uint32_t rank, const int8_t* basis, uint32_t count, float* values_rgba) {
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return false;
  reconstructTile(amount_rgb, rank, basis, count, values_rgba);
  return true;
}

bool packTileAvx2(const float* values_rgba, uint32_t count, uint16_t* halfs_rgba) {
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return false;
  packTile(values_rgba, count, halfs_rgba);
  return true;
}
#else
bool reconstructTileAvx2(const Float4*, uint32_t, const int8_t*, uint32_t, float*) { return false; }
bool packTileAvx2(const float*, uint32_t, uint16_t*) { return false; }
#endif

}  // namespace lightwell::runtime
