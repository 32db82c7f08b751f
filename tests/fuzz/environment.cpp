// Any bytes as an environment map: Radiance HDR or OpenEXR. Rows of what is accepted are finite radiance.
#include <cmath>

#include "precompute/transport/environment/environment_map.h"
#include "tests/fuzz/temporary_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lightwell;
  static fuzz::TemporaryFile file("sky.hdr");
  Diagnostics diagnostics;
  try {
    auto source = transport::openRowSource(file.write(data, size), diagnostics);
    if (int64_t(source->width()) * source->height() > 1 << 22) return 0;  // sound, but slow under a sanitizer
    transport::EnvironmentMap map(std::move(source), "sky.hdr");
    int rows = 0;
    map.visitRows(diagnostics, nullptr, [&](int row, std::span<const Rgb> radiance_rgb) {
      fuzz::require(row >= 0 && row < map.height() && radiance_rgb.size() == size_t(map.width()), "rows of the map");
      for (const Rgb& radiance : radiance_rgb)
        for (int k = 0; k < 3; ++k) fuzz::require(radiance[k] >= 0 && radiance[k] <= transport::kMaxRadiance, "radiance within its range");
      ++rows;
    });
    fuzz::require(rows == map.height(), "every row once");
  } catch (const InputError& error) {
    fuzz::require(!error.reason.empty(), "a reason");
  }
  return 0;
}
