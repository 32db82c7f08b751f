// What a virtual light costs on OpenGL: its shadow map and its light on all texels, beside the same on the CPU in the same run.
//   vpl_frame A.lwc [B.lwc …] [--sides 64,128,256,512] [--lights 200] [--repeats 3]
// CSV: milliseconds per light by wall clock until glFinish returns, medians of repetitions that take turns. cpu_ms: exact irradiance at one point of each texel and four shadow rays
// wherever there is some, on all threads.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>

#include "cli/gl_context.h"
#include "lightwell/lightwell_gl_vpl.h"
#include "precompute/bake/container_scene.h"
#include "precompute/core/parallel.h"
#include "precompute/core/random.h"
#include "precompute/trace/tracer.h"

using namespace lightwell;

namespace {

constexpr uint32_t kRays = 4;

double msOf(const std::function<void()>& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
  return values[values.size() / 2];
}

struct Release {
  void operator()(lw_virtual_lights* lights) const { lw_virtual_lights_release(lights); }
  void operator()(lw_gl_vpl* vpl) const { lw_gl_vpl_destroy(vpl); }
};

std::vector<lw_virtual_light> lightsOf(const cli::RuntimeContainer& container, const lw_virtual_lights* from, uint32_t most) {
  lw_virtual_lights_info info;
  container.check(lw_virtual_lights_get_info(from, &info));
  std::vector<lw_virtual_light> lights(std::min(info.lights, most));
  // Spread over all sources and bounces.
  for (size_t i = 0; i < lights.size(); ++i) container.check(lw_virtual_lights_get(from, uint32_t(i * info.lights / lights.size()), &lights[i]));
  return lights;
}

/// Milliseconds per light of drawing them all again.
double drawMs(const cli::RuntimeContainer& container, lw_gl_vpl* vpl) {
  container.check(lw_gl_vpl_redraw(vpl));
  double ms = 0;
  uint32_t drawn = 0;
  for (lw_gl_vpl_progress progress{0, 1, 0}; progress.lights_left > 0; ms += progress.ms, drawn += progress.lights_drawn) container.check(lw_gl_vpl_step(vpl, 1000, &progress));
  return ms / std::max(drawn, 1u);
}

double cpuMs(const bake::ContainerScene& scene, const trace::Tracer& tracer, const std::vector<lw_virtual_light>& lights) {
  const float metres = float(scene.scene.metres_per_unit);
  const auto& slots = scene.atlas.slots;
  std::vector<float> sum(slots.size());
  const double ms = msOf([&] {
    parallelFor(slots.size(), 64, 0, nullptr, [&](size_t begin, size_t end) {
      std::vector<trace::Ray> rays;
      std::vector<float> passed;
      for (size_t s = begin; s < end; ++s) {
        const Sampler sampler(1, slots[s].texel);
        const Vec3 position_m = slots[s].position * metres;
        rays.clear();
        for (uint32_t l = 0; l < lights.size(); ++l) {
          float rgb[3];
          lw_virtual_light_irradiance(&lights[l], &position_m.x, &slots[s].normal.x, 0, rgb);
          sum[s] += rgb[0];
          if (!(rgb[0] + rgb[1] + rgb[2] > 0)) continue;
          const Vec3 light_normal(lights[l].normal[0], lights[l].normal[1], lights[l].normal[2]);
          for (uint32_t i = 0; i < kRays; ++i) {
            const Vec2 uv = sampler.get2D(i, l);
            Vec3 target;
            lw_virtual_light_point(&lights[l], &uv.x, &target.x);
            target /= metres;
            const Vec3 origin = trace::Tracer::offsetOrigin(slots[s].position, slots[s].normal, slots[s].normal);
            rays.push_back({.origin = origin, .direction = trace::Tracer::offsetOrigin(target, light_normal, light_normal) - origin, .t_max = 1.0f - 1e-4f, .key = l});
          }
        }
        passed.resize(rays.size());
        tracer.transmittance(rays, passed);
        for (const float p : passed) sum[s] += 1e-9f * p;
      }
    });
  });
  return ms / double(std::max<size_t>(lights.size(), 1));
}

void measure(const std::string& file, const std::vector<uint32_t>& sides, uint32_t most_lights, int repeats) {
  const cli::RuntimeContainer container(file);
  const format::Reader reader(file);
  Diagnostics diagnostics;
  const bake::ContainerScene scene = bake::loadContainerScene(reader, diagnostics);
  const trace::Tracer tracer(scene.scene, 0);
  lw_virtual_lights* raw = nullptr;
  container.check(lw_virtual_lights_load(container.get(), &raw));
  const std::unique_ptr<lw_virtual_lights, Release> handle(raw);
  const auto lights = lightsOf(container, raw, most_lights);
  const cli::GlContext gl(container);
  struct Variant {
    uint32_t side;
    std::unique_ptr<lw_gl_vpl, Release> vpl;
    double setup_ms;
    std::vector<double> ms;
  };
  std::vector<Variant> variants;
  for (const uint32_t side : sides) {
    lw_gl_vpl_options options = LW_GL_VPL_OPTIONS_INIT;
    options.shadow_map_side = side;
    lw_gl_vpl* vpl = nullptr;
    const double setup_ms = msOf([&] { container.check(lw_gl_vpl_create(gl.get(), container.get(), nullptr, &options, &vpl)); });
    container.check(lw_gl_vpl_set_source_lights(vpl, 0, lights.data(), uint32_t(lights.size())));
    variants.push_back({side, std::unique_ptr<lw_gl_vpl, Release>(vpl), setup_ms, {}});
  }
  std::vector<double> cpu_ms;
  for (int i = -1; i < repeats; ++i) {
    for (Variant& variant : variants)
      if (const double ms = drawMs(container, variant.vpl.get()); i >= 0) variant.ms.push_back(ms);
    if (const double ms = cpuMs(scene, tracer, lights); i >= 0) cpu_ms.push_back(ms);
  }
  for (const Variant& v : variants)
    std::printf("%s,%d,%zu,%zu,%zu,%u,%.1f,%.3f,%.3f,%.2f,%.1f\n", std::filesystem::path(file).filename().c_str(), scene.atlas.width, scene.atlas.slots.size(), scene.scene.mesh.triangles.size(),
                lights.size(), v.side, v.setup_ms, median(v.ms), median(cpu_ms), median(cpu_ms) / median(v.ms), double(lw_gl_vpl_texture_bytes(v.vpl.get())) / 1e6);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("What a virtual light costs on OpenGL and on the CPU");
  std::vector<std::string> files;
  std::vector<uint32_t> sides{0, 64, 128, 256, 512};
  uint32_t lights = 200;
  int repeats = 3;
  app.add_option("containers", files, "Containers with section vpl")->required();
  app.add_option("--sides", sides, "Pixels along a shadow map's middle face; 0: no shadows")->delimiter(',');
  app.add_option("--lights", lights, "Use so many of the lights");
  app.add_option("--repeats", repeats, "Repetitions");
  CLI11_PARSE(app, argc, argv);
  try {
    std::printf("container,atlas,texels,triangles,lights,side,setup_ms,gl_ms,cpu_ms,cpu_over_gl,texture_mb\n");
    for (const auto& file : files) measure(file, sides, lights, repeats);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "vpl_frame: %s\n", error.what());
    return 1;
  }
  return 0;
}
