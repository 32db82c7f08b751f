#include "cli/environment_evaluator.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "cli/gl_handles.h"
#include "precompute/core/error.h"
#include "precompute/core/parallel.h"
#include "precompute/core/random.h"
#include "render/egl_context.h"
#include "render/error.h"

namespace lightwell::cli {
namespace {

constexpr uint64_t kSeed = 1;
constexpr size_t kSlotsAtOnce = 4096;
enum Dimension : uint32_t { kPatch = 0, kPlace = 1, kFirstSun = 2 };

struct TexelPoint {
  atlas::SurfacePoint surface;
  Sampler sampler;
  uint32_t sample;
};
TexelPoint pointOf(const EnvironmentEvaluation& evaluation, size_t slot, uint32_t sample) {
  const bake::ContainerScene& scene = evaluation.scene;
  const Sampler sampler(kSeed, scene.atlas.slots[slot].texel);
  return {atlas::sampleSlot(scene.scene.mesh, scene.atlas, scene.atlas.slots[slot], sampler.get1D(sample, kPatch), sampler.get2D(sample, kPlace)),
          sampler, sample};
}

/// The cells as lw_environment has them; rays to their centres, and all over the suns, which are discs.
class CellVisibility {
 public:
  CellVisibility(const EnvironmentEvaluation& evaluation, const lw_environment* environment) : evaluation_(evaluation) {
    evaluation.container.check(lw_environment_get_info(environment, &info_));
    evaluation.container.check(lw_environment_get_cells(environment, &cells_));
  }

  /// Of a point, [cells], into `visibility`.
  void trace(const TexelPoint& point, std::vector<float>& visibility) {
    rays_.clear(), cell_of_ray_.clear();
    visibility.assign(info_.cells, 0.0f);
    for (uint32_t i = 0; i < info_.cells; ++i) {
      const Vec3 direction = i < info_.suns ? insideSun(i, point) : centerOf(i);
      if (!(direction.dot(point.surface.geometric_normal) > 0)) continue;  // hidden by the surface itself
      rays_.push_back({.origin = trace::Tracer::offsetOrigin(point.surface.position, point.surface.geometric_normal, direction),
                       .direction = direction});
      cell_of_ray_.push_back(i);
    }
    transmittance_.resize(rays_.size());
    evaluation_.tracer.transmittance(rays_, transmittance_);
    for (size_t r = 0; r < rays_.size(); ++r) visibility[cell_of_ray_[r]] = transmittance_[r];
  }

 private:
  Vec3 centerOf(uint32_t i) const { return {cells_.direction[i * 3], cells_.direction[i * 3 + 1], cells_.direction[i * 3 + 2]}; }
  Vec3 insideSun(uint32_t i, const TexelPoint& point) const {
    const Vec2 u = point.sampler.get2D(point.sample, kFirstSun + i);
    const Vec3 axis = centerOf(i);
    Vec3 tangent, bitangent;
    orthonormalBasis(axis, tangent, bitangent);
    const float depth = u.x * std::min(cells_.solid_angle_sr[i] / (2 * kPi), 1.0f), phi = 2 * kPi * u.y;  // 1 − cos
    const float sine = std::sqrt(depth * (2 - depth));
    return tangent * (sine * std::cos(phi)) + bitangent * (sine * std::sin(phi)) + axis * (1 - depth);
  }

  const EnvironmentEvaluation& evaluation_;
  lw_environment_info info_;
  lw_environment_cells cells_;
  std::vector<trace::Ray> rays_;
  std::vector<uint32_t> cell_of_ray_;
  std::vector<float> transmittance_;
};

}  // namespace

std::vector<Rgb> evaluateEnvironmentOnCpu(const EnvironmentEvaluation& evaluation) {
  const auto environment = evaluation.container.loadEnvironment();
  std::vector<Rgb> irradiance_rgb(evaluation.scene.atlas.slots.size());
  std::mutex progress_mutex;
  size_t finished = 0;
  parallelFor(irradiance_rgb.size(), 64, evaluation.threads, evaluation.cancel, [&](size_t begin, size_t end) {
    CellVisibility cells(evaluation, environment.get());
    std::vector<float> visibility;
    for (size_t slot = begin; slot < end; ++slot) {
      Vec3d sum(0.0);
      for (uint32_t s = 0; s < evaluation.samples; ++s) {
        const TexelPoint point = pointOf(evaluation, slot, s);
        cells.trace(point, visibility);
        Rgb rgb;
        evaluation.container.check(lw_environment_irradiance(environment.get(), &point.surface.normal.x, visibility.data(), &rgb.x));
        sum += Vec3d(rgb);
      }
      irradiance_rgb[slot] = Rgb(sum / double(evaluation.samples));
    }
    if (evaluation.progress) {
      std::lock_guard lock(progress_mutex);
      finished += end - begin;
      evaluation.progress(double(finished) / double(irradiance_rgb.size()));
    }
  });
  return irradiance_rgb;
}

std::vector<Rgb> evaluateEnvironmentOnGl(const EnvironmentEvaluation& evaluation) try {
  const render::EglContext context;
  lw_gl_config config = LW_GL_CONFIG_INIT;
  std::string message;
  config.loader = render::EglContext::load;
  config.message_user = &message;
  config.message = [](void* user, lw_result, const char* text) { *static_cast<std::string*>(user) = text; };
  lw_gl* made = nullptr;
  evaluation.container.check(lw_gl_create(&config, &made));
  const GlHandle gl(made);
  const render::SceneMesh mesh(evaluation.container.get());
  std::optional<render::EnvironmentLight> light;
  try {
    light.emplace(evaluation.container.get(), gl.get(), mesh, evaluation.settings);
  } catch (const render::RenderError&) {
    if (!message.empty()) throw UsageError("--evaluator gl: " + message);
    throw;
  }
  light->update();

  const auto& slots = evaluation.scene.atlas.slots;
  const float metres = float(evaluation.scene.scene.metres_per_unit);
  const auto packed = [](const Vec3& v) { return render::Float3{v.x, v.y, v.z}; };
  std::vector<Rgb> irradiance_rgb(slots.size());
  std::vector<render::EnvironmentPoint> points;
  for (size_t begin = 0; begin < slots.size(); begin += kSlotsAtOnce) {
    if (evaluation.cancel) evaluation.cancel->check();
    const size_t end = std::min(begin + kSlotsAtOnce, slots.size());
    points.clear();
    for (size_t slot = begin; slot < end; ++slot)
      for (uint32_t s = 0; s < evaluation.samples; ++s) {
        const atlas::SurfacePoint surface = pointOf(evaluation, slot, s).surface;
        points.push_back({packed(surface.position * metres), packed(surface.geometric_normal), packed(surface.normal)});
      }
    const std::vector<render::Float3> answers = light->irradianceAt(points);
    for (size_t slot = begin; slot < end; ++slot) {
      Vec3d sum(0.0);
      for (uint32_t s = 0; s < evaluation.samples; ++s) {
        const render::Float3& rgb = answers[(slot - begin) * evaluation.samples + s];
        sum += Vec3d(double(rgb[0]), double(rgb[1]), double(rgb[2]));
      }
      irradiance_rgb[slot] = Rgb(sum / double(evaluation.samples));
    }
    if (evaluation.progress) evaluation.progress(double(end) / double(slots.size()));
  }
  return irradiance_rgb;
} catch (const render::RenderError& error) {
  if (error.result >= LW_GL_UNSUPPORTED) throw UsageError(std::string("--evaluator gl: ") + error.what());
  evaluation.container.check(error.result);
  throw;
}

}  // namespace lightwell::cli
