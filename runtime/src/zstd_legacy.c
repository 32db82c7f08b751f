/* What libzstd's decoder calls for frames of zstd before 1.0. A chunk is never such a frame (its magic number is checked before it is decoded), so the shared library goes without
 * these three old decoders, 70 kB: with the names defined here, the linker takes none of them out of libzstd.a. All of them answer with zstd's generic error. */
#include <stddef.h>

#define LEGACY(name) \
  size_t name(void); \
  size_t name(void) { return (size_t)-1; }
#define LEGACY_VERSION(v) \
  LEGACY(ZBUFF##v##_createDCtx) \
  LEGACY(ZBUFF##v##_decompressContinue) \
  LEGACY(ZBUFF##v##_decompressInitDictionary) \
  LEGACY(ZBUFF##v##_freeDCtx) \
  LEGACY(ZSTD##v##_createDCtx) \
  LEGACY(ZSTD##v##_decompress_usingDict) \
  LEGACY(ZSTD##v##_findFrameSizeInfoLegacy) \
  LEGACY(ZSTD##v##_freeDCtx) \
  LEGACY(ZSTD##v##_getFrameParams)

LEGACY_VERSION(v05)
LEGACY_VERSION(v06)
LEGACY_VERSION(v07)
