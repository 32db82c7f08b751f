// lightwell_make_samples DIRECTORY: writes the sample scenes as .glb, and a sky, clear_sky.hdr. The same bytes every time.
#include <cstdio>
#include <exception>

#include "samples/scenes/glb_writer.h"
#include "samples/scenes/procedural_sky.h"

int main(int argc, char** argv) {
  using namespace lightwell::samples;
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s DIRECTORY\n", argv[0]);
    return 2;
  }
  try {
    for (const SampleScene& scene : makeAllScenes()) {
      const auto bytes = encodeGlb(scene);
      const auto file = std::filesystem::path(argv[1]) / (scene.name + ".glb");
      writeFile(file, bytes);
      std::printf("%-28s %5zu triangles %7zu bytes, light map %d\n", file.filename().c_str(), scene.triangleCount(), bytes.size(),
                  scene.lightmap_size);
    }
    const auto sky = encodeHdr(makeClearSky(lightwell::Vec3(0.6f, 0.55f, 0.35f).normalized(), 512, 256));
    writeFile(std::filesystem::path(argv[1]) / "clear_sky.hdr", sky);
    std::printf("%-28s 512 x 256       %7zu bytes\n", "clear_sky.hdr", sky.size());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
