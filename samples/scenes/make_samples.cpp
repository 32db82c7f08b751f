// lightwell_make_samples DIRECTORY: writes the sample scenes as .glb. The same bytes every time.
#include <cstdio>
#include <exception>

#include "samples/scenes/glb_writer.h"

int main(int argc, char** argv) {
  using namespace lightwell::samples;
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s DIRECTORY\n", argv[0]);
    return 2;
  }
  try {
    for (const SampleScene& scene :
         {makeCornellBox(false), makeCornellBox(true), makeMarbleChamber(), makeCorridorDoor(), makeColonnadeCourtyard()}) {
      const auto bytes = encodeGlb(scene);
      const auto file = std::filesystem::path(argv[1]) / (scene.name + ".glb");
      writeFile(file, bytes);
      std::printf("%-28s %5zu triangles %7zu bytes, light map %d\n", file.filename().c_str(), scene.triangleCount(), bytes.size(),
                  scene.lightmap_size);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
