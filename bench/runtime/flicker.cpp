// How virtual lights of a lamp that moves slowly flicker, how far they are from the truth, and what a frame of them costs.
//   flicker ROOM.lwc --move DX DY DZ [--frames 64] [--samples 1024] [--lights N …] [--sides N …] [--pictures DIR] [--json]
// The first lamp of the container moves by DX DY DZ metres over all frames while texels stand still; texels that show another's value do not count. Flicker: mean absolute change of a texel's irradiance from frame to frame over the
// mean irradiance; excess: the same of the difference to the truth's own change. The truth is path-traced, one reflection, with the same paths in each frame; its noise is taken out
// of errors by a second set of paths. Times are wall clock until glFinish returns, medians, without the first frame.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "bench/runtime/one_bounce.h"
#include "cli/runtime_handles.h"
#include "format/decode/pixel.h"
#include "lightwell/lightwell_gl_dynamic.h"
#include "precompute/core/error.h"
#include "render/egl_context.h"
#include "render/png.h"
#include "render/gl_objects.h"

using namespace lightwell;
using nlohmann::json;

namespace {

struct Options {
  std::filesystem::path container;
  std::vector<float> move_m{1, 0, 0};
  int frames = 64;
  uint32_t samples = 1024;
  std::vector<uint32_t> lights{256}, sides{0, 32}, updates{16};
  float softness = 0.25f;
  int threads = 2;
  std::optional<std::filesystem::path> pictures;
  bool json = false;
};

using Frames = std::vector<std::vector<Rgb>>;  // of shown slots

double lum(const Rgb& rgb) { return double(luminance(rgb)); }

double meanOf(const Frames& frames) {
  double sum = 0;
  size_t count = 0;
  for (const auto& frame : frames)
    for (const Rgb& v : frame) sum += lum(v), ++count;
  return sum / double(count);
}

/// Mean absolute change from frame to frame, of frames minus `of`, over the mean.
double flickerOf(const Frames& frames, const Frames* of, double mean) {
  double sum = 0;
  size_t count = 0;
  for (size_t f = 1; f < frames.size(); ++f)
    for (size_t i = 0; i < frames[f].size(); ++i) {
      const double change = lum(frames[f][i]) - lum(frames[f - 1][i]), own = of ? lum((*of)[f][i]) - lum((*of)[f - 1][i]) : 0;
      sum += std::abs(change - own), ++count;
    }
  return count ? sum / double(count) / mean : 0;
}

struct Error {
  double relrmse, texrel, bias;
};
/// Slots that show their own value: buried ones, under things that stand on the floor, show another's.
std::vector<uint32_t> shownSlots(const atlas::Atlas& atlas) {
  std::vector<uint32_t> shown;
  for (uint32_t i = 0; i < atlas.slots.size(); ++i)
    if (atlas.source[atlas.slots[i].texel] == atlas.slots[i].texel) shown.push_back(i);
  return shown;
}

Error errorOf(const Frames& frames, const Frames& a, const Frames& b) {
  double square = 0, reference = 0, relative = 0, sum = 0, truth = 0;
  const double mean = 0.5 * (meanOf(a) + meanOf(b));
  size_t count = 0;
  for (size_t f = 0; f < a.size(); ++f)
    for (size_t i = 0; i < a[f].size(); ++i) {
      const double c = lum(frames[f][i]), ra = lum(a[f][i]), rb = lum(b[f][i]), r = 0.5 * (ra + rb);
      square += (c - ra) * (c - rb), reference += ra * rb, ++count;
      relative += (c - ra) * (c - rb) / std::pow(r + 0.1 * mean, 2);
      sum += c, truth += r;
    }
  return {std::sqrt(std::max(square, 0.0) / reference), std::sqrt(std::max(relative, 0.0) / double(count)), sum / truth - 1};
}

/// The atlas in sRGB, so that twice the mean is white.
void writePicture(const std::filesystem::path& file, const atlas::Atlas& atlas, const std::vector<uint32_t>& shown, const std::vector<Rgb>& frame, double mean) {
  render::Image8 image{atlas.width, atlas.height, std::vector<uint8_t>(size_t(atlas.width) * size_t(atlas.height) * 4, 0)};
  for (size_t i = 0; i < frame.size(); ++i)
    for (int k = 0; k < 3; ++k) image.rgba[size_t(atlas.slots[shown[i]].texel) * 4 + size_t(k)] = format::encodeSrgb(float(double(frame[i][k]) / (2 * mean)));
  render::writePng(file, image);
}

struct Way {
  const char* name;
  bool incremental;
  uint32_t lights, side, updates;
};

struct Run {
  Frames frames;
  double update_ms = 0, gather_ms = 0;
  lw_gl_lamp_work work{};
  uint32_t most_updated = 0;
};

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
  return values[values.size() / 2];
}

class Player {
 public:
  Player(const Options& options, const cli::RuntimeContainer& runtime, const bake::ContainerScene& container, const std::vector<uint32_t>& shown)
      : options_(options), container_(container), shown_(shown) {
    lw_gl_config config = LW_GL_CONFIG_INIT;
    config.loader = render::EglContext::load;
    config.message = [](void* user, lw_result, const char* text) { *static_cast<std::string*>(user) = text; };
    config.message_user = &message_;
    lw_gl_dynamic_options scene_options = LW_GL_DYNAMIC_OPTIONS_INIT;
    scene_options.atlas_format = LW_GL_ATLAS_RGBA32F;
    scene_options.fill = 0;
    check(lw_gl_dynamic_create(&config, runtime.get(), &scene_options, &scene_));
    lw_atlas_info atlas;
    check(lw_get_atlas_info(runtime.get(), &atlas));
    rgba_.resize(size_t(atlas.width) * atlas.height * 4);
  }
  ~Player() { lw_gl_dynamic_destroy(scene_); }

  Run play(const Way& way, const std::vector<scene::Light>& lights) {
    lw_gl_lamp_options options = LW_GL_LAMP_OPTIONS_INIT;
    options.lights = way.lights, options.shadow_side = way.side, options.incremental = way.incremental, options.most_updates = way.updates;
    lw_gl_lamp* lamp = nullptr;
    check(lw_gl_lamp_create(scene_, &options, &lamp));
    lw_gl_gathering gathering = LW_GL_GATHERING_INIT;
    gathering.softness = options_.softness;
    Run run;
    std::vector<double> update_ms, gather_ms;
    // What a game has reached when it looks: the first place is settled.
    const lw_light first = cli::runtimeLight(container_.scene, lights[0]);
    for (int i = 0; i < 8 && way.incremental; ++i) check(lw_gl_lamp_update(lamp, &first, nullptr));
    for (const scene::Light& light : lights) {
      const lw_light given = cli::runtimeLight(container_.scene, light);
      glFinish();
      const auto begin = std::chrono::steady_clock::now();
      check(lw_gl_lamp_update(lamp, &given, &run.work));
      glFinish();
      const auto middle = std::chrono::steady_clock::now();
      check(lw_gl_dynamic_gather(scene_, &lamp, 1, &gathering));
      glFinish();
      const auto end = std::chrono::steady_clock::now();
      update_ms.push_back(std::chrono::duration<double, std::milli>(middle - begin).count());
      gather_ms.push_back(std::chrono::duration<double, std::milli>(end - middle).count());
      run.most_updated = std::max(run.most_updated, run.work.updated);
      check(lw_gl_dynamic_read_atlas(scene_, rgba_.data()));
      std::vector<Rgb>& frame = run.frames.emplace_back();
      for (const uint32_t slot : shown_) {
        const float* texel = &rgba_[size_t(container_.atlas.slots[slot].texel) * 4];
        frame.push_back({texel[0], texel[1], texel[2]});
      }
    }
    lw_gl_lamp_destroy(lamp);
    run.update_ms = median({update_ms.begin() + 1, update_ms.end()});
    run.gather_ms = median({gather_ms.begin() + 1, gather_ms.end()});
    return run;
  }

 private:
  void check(lw_result result) const {
    if (result) throw std::runtime_error(message_.empty() ? lw_result_name(result) : message_);
  }
  const Options& options_;
  const bake::ContainerScene& container_;
  const std::vector<uint32_t>& shown_;
  std::string message_;
  lw_gl_dynamic* scene_ = nullptr;
  std::vector<float> rgba_;
};

void run(const Options& options) {
  const format::Reader reader(options.container);
  Diagnostics diagnostics;
  const bake::ContainerScene container = bake::loadContainerScene(reader, diagnostics);
  if (container.scene.lights.empty()) throw std::runtime_error("the container has no lamp");
  const trace::Tracer tracer(container.scene, options.threads);
  const bench::OneBounce truth(reader, container, tracer);
  std::vector<scene::Light> lights;
  for (int f = 0; f < options.frames; ++f) {
    scene::Light light = container.scene.lights[0];
    for (int k = 0; k < 3; ++k) light.position[k] += float(double(options.move_m[size_t(k)]) * f / std::max(options.frames - 1, 1) / container.scene.metres_per_unit);
    lights.push_back(light);
  }
  const std::vector<uint32_t> shown = shownSlots(container.atlas);
  Frames a, b;
  for (const scene::Light& light : lights) {
    a.push_back(truth.irradiance(shown, light, options.samples, 1, options.threads));
    b.push_back(truth.irradiance(shown, light, options.samples, 2, options.threads));
  }
  const double mean = 0.5 * (meanOf(a) + meanOf(b));
  const render::EglContext context;
  const cli::RuntimeContainer runtime(options.container);
  Player player(options, runtime, container, shown);
  json document{{"renderer", context.description()}, {"texels", shown.size()}, {"frames", options.frames}, {"truth_change", flickerOf(a, nullptr, mean)},
                {"truth_change_second", flickerOf(b, nullptr, mean)}, {"truth_noise", flickerOf(a, &b, mean)}, {"ways", json::array()}};
  if (!options.json) {
    std::printf("%s, %zu texels, %d frames\ntruth: change %.3f %% a frame (second set of paths %.3f %%, difference of the two %.3f %%)\n", context.description().c_str(), shown.size(),
                options.frames, 100 * flickerOf(a, nullptr, mean), 100 * flickerOf(b, nullptr, mean), 100 * flickerOf(a, &b, mean));
    std::printf("| lights | | map | change | excess | relrmse | texrel | bias | moved a frame | update ms | gather ms | draws | points |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  }
  if (options.pictures) writePicture(*options.pictures / "truth.png", container.atlas, shown, a.back(), mean);
  std::vector<Way> ways;
  for (const uint32_t n : options.lights)
    for (const uint32_t side : options.sides) {
      ways.push_back({"rsm", false, n, side, 0});
      for (const uint32_t updates : options.updates) ways.push_back({"iir", true, n, side, std::min(updates, n)});
    }
  for (const Way& way : ways) {
    const Run run = player.play(way, lights);
    const Error error = errorOf(run.frames, a, b);
    if (options.pictures)
      writePicture(*options.pictures / (std::string(way.name) + "_" + std::to_string(way.lights) + "_" + std::to_string(way.side) + ".png"), container.atlas, shown, run.frames.back(), mean);
    const double change = flickerOf(run.frames, nullptr, mean), excess = flickerOf(run.frames, &a, mean);
    document["ways"].push_back({{"way", way.name}, {"lights", way.lights}, {"shadow_side", way.side}, {"most_updates", way.updates}, {"change", change}, {"excess", excess}, {"relrmse", error.relrmse},
                                {"texrel", error.texrel}, {"bias", error.bias}, {"most_updated", run.most_updated}, {"update_ms", run.update_ms}, {"gather_ms", run.gather_ms},
                                {"draws", run.work.draws}, {"points", run.work.points}});
    if (!options.json)
      std::printf("| %u | %s | %u² | %.3f %% | %.3f %% | %.1f %% | %.1f %% | %+.1f %% | %u | %.1f | %.1f | %u | %llu |\n", way.lights, way.name, way.side, 100 * change, 100 * excess,
                  100 * error.relrmse, 100 * error.texrel, 100 * error.bias, run.most_updated, run.update_ms, run.gather_ms, run.work.draws, static_cast<unsigned long long>(run.work.points));
    std::fflush(stdout);
  }
  if (options.json) std::printf("%s\n", document.dump(2).c_str());
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Flicker of virtual lights");
  app.add_option("container", options.container, "Container with section points and a lamp")->required();
  app.add_option("--move", options.move_m, "Metres that the lamp moves over all frames")->expected(3);
  app.add_option("--frames", options.frames, "Frames")->check(CLI::Range(2, 4096));
  app.add_option("--samples", options.samples, "Paths of each texel for the truth")->check(CLI::Range(1, 1 << 20));
  app.add_option("--lights", options.lights, "Virtual lights");
  app.add_option("--sides", options.sides, "Texels along shadow maps; 0: none");
  app.add_option("--updates", options.updates, "Incremental: lights that may move in a frame");
  app.add_option("--softness", options.softness, "lw_gl_gathering.softness");
  app.add_option("--threads", options.threads, "For the truth");
  app.add_option("--pictures", options.pictures, "Folder for the atlas in the last frame, as PNG: twice the mean is white");
  app.add_flag("--json", options.json, "JSON on stdout");
  CLI11_PARSE(app, argc, argv);
  try {
    run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "flicker: %s\n", error.what());
    return 1;
  }
  return 0;
}
