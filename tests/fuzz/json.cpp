// Any text as one of the JSON files that the command takes. The first byte says which: L a scene's LIGHTS.json, l the viewer's, c a camera, q queries, p probes; s settings of a bake.
#include <cmath>

#include "cli/environment_queries.h"
#include "precompute/plan/plan.h"
#include "precompute/plan/probe_points.h"
#include "precompute/plan/settings.h"
#include "precompute/scene/import.h"
#include "render/camera_json.h"
#include "render/error.h"
#include "render/lights_json.h"
#include "tests/fuzz/temporary_file.h"

namespace lightwell::fuzz {
namespace {

void requireFinite(const float* values, int count, const char* what) {
  for (int i = 0; i < count; ++i) require(std::isfinite(values[i]), what);
}

void read(char kind, std::string_view text) {
  static TemporaryFile file("input.json");
  Diagnostics diagnostics;
  switch (kind) {
    case 'L': {
      scene::Scene scene;
      scene::replaceLights(scene, file.write(text.data(), text.size()), diagnostics);
      for (const scene::Light& light : scene.lights) {
        requireFinite(&light.position.x, 3, "a finite position");
        require(std::abs(light.direction.length2() - 1) < 1e-3f, "a unit direction");
        for (int k = 0; k < 3; ++k) require(light.intensity[k] >= 0 && std::isfinite(light.intensity[k]), "a finite intensity");
      }
      return;
    }
    case 'l': {
      const double origin_m[3] = {1, 2, 3};
      for (const lw_light& light : render::parseLights(text, "input.json", origin_m)) requireFinite(light.intensity_rgb, 3, "a finite intensity");
      return;
    }
    case 'c': render::parseCamera(text, "input.json"); return;
    case 'q':
      for (const auto& query : cli::readQueries(file.write(text.data(), text.size()))) require(std::abs(query.axis.length2() - 1) < 1e-3f, "a unit direction");
      return;
    case 'p': plan::readProbePoints(file.write(text.data(), text.size())); return;
    case 's': {
      const std::string canonical = plan::canonicalJson(plan::settingsFromJson(text));
      require(plan::canonicalJson(plan::settingsFromJson(canonical)) == canonical, "canonical settings are read as themselves");
      return;
    }
    default: return;
  }
}

}  // namespace
}  // namespace lightwell::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lightwell;
  if (size == 0) return 0;
  try {
    fuzz::read(char(data[0]), {reinterpret_cast<const char*>(data) + 1, size - 1});
  } catch (const InputError&) {
  } catch (const UsageError&) {
  } catch (const render::FileError&) {
  }
  return 0;
}
