#include "cli/stress/trial.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace lightwell::stress {
namespace {

using plan::Technique;
using transport::Component;

constexpr double kSlackSeconds = 5;                 // machines are busy, and small rooms take milliseconds
constexpr double kSecondsPerMillionTriangles = 60;  // import, charts, acceleration
constexpr int kPlainSize = 32;

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.5g", value);
  return text;
}

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g %%", 100 * share);
  return text;
}

struct Difference {
  double relrmse, bias;
};

/// Of `got` from factor × `like`, all channels together. Values that are no numbers make it one.
Difference differenceOf(const std::vector<Rgb>& got, const std::vector<Rgb>& like, double factor) {
  double difference2 = 0, square = 0, sum = 0, like_sum = 0;
  for (size_t i = 0; i < got.size(); ++i) {
    const Vec3d expected = Vec3d(like[i]) * factor, is(got[i]);
    difference2 += (is - expected).length2(), square += expected.length2();
    sum += is.x + is.y + is.z, like_sum += expected.x + expected.y + expected.z;
  }
  const double none = difference2 == 0 ? 0 : HUGE_VAL;
  return {square > 0 ? std::sqrt(difference2 / square) : none, like_sum > 0 ? sum / like_sum - 1 : none};
}

/// How far OpenGL may be from the CPU. Virtual lights and a sky's cells are shadowed by depth maps there, and by rays here.
struct GlTolerance {
  double relrmse, bias;
};

GlTolerance glTolerance(Technique technique) {
  switch (technique) {
    case Technique::prm:
    case Technique::radiosity:
    case Technique::lightmap: return {0.001, 0.001};
    case Technique::vpl:
    case Technique::environment: return {0.1, 0.02};
  }
  return {};
}

}  // namespace

GltfDocument plainRoom(const Look& look, double intensity_cd) {
  GltfDocument room;
  room.box({-2, -1.5, -2}, {2, 1.5, 2}, room.material(look), true);
  if (intensity_cd > 0) room.lamp({.position_m = {0.5f, 0.75f, -0.25f}, .intensity = intensity_cd});
  return room;
}

plan::Settings Trial::plainSettings() {
  plan::Settings settings;
  settings.lightmap_size = kPlainSize;
  settings.quality = plan::Quality::draft;
  return settings;
}

PlainCost Trial::plainCost(const Setup& setup) {
  // Small atlases cost what the technique costs at all; large ones are compared texel by texel.
  Job job{.sky = setup.sky, .technique = technique_, .component = setup.component, .settings = setup.settings, .dynamic = setup.dynamic};
  job.settings.lightmap_size = kPlainSize;
  PlainCost& cost = plain_[{technique_, setup.dynamic.has_value(), setup.sky != nullptr, int(setup.settings.quality)}];
  if (cost.texels == 0) {
    const GltfDocument room = plainRoom();
    job.scene = &room;
    const Lit lit = bench_.light(job);
    cost = {lit.rays, lit.seconds, lit.gl_seconds, lit.scene.atlas.slots.size()};
  }
  return cost;
}

void Trial::checkCost(const Lit& lit, const GltfDocument& scene, const Setup& setup) {
  const PlainCost plain = plainCost(setup);
  const double share = std::max(1.0, double(lit.scene.atlas.slots.size()) / double(plain.texels));
  const double most_rays = setup.most_work * share * double(plain.rays);
  expect("rays", double(lit.rays) <= most_rays, "at most " + number(most_rays), number(double(lit.rays)));
  const double slack = kSlackSeconds + kSecondsPerMillionTriangles * 1e-6 * double(scene.triangleCount());
  expectAtMost("seconds", lit.seconds, setup.most_work * share * plain.seconds + slack);
  if (lit.gl_irradiance_rgb) expectAtMost("OpenGL: seconds", lit.gl_seconds, setup.most_work * share * plain.gl_seconds + slack);
}

void Trial::checkNumbers(const std::string& prefix, const std::vector<Rgb>& irradiance_rgb) {
  size_t not_finite = 0, negative = 0;
  for (const Rgb& rgb : irradiance_rgb) {
    not_finite += !isFinite(rgb);
    negative += rgb.x < 0 || rgb.y < 0 || rgb.z < 0;
  }
  const std::string texels = std::to_string(irradiance_rgb.size()) + " texels";
  expect(prefix + "finite", not_finite == 0, "all of " + texels, std::to_string(not_finite) + " are not");
  expect(prefix + "not negative", negative == 0, "all of " + texels, std::to_string(negative) + " are");
}

void Trial::checkGl(const Lit& lit) {
  checkNumbers("OpenGL: ", *lit.gl_irradiance_rgb);
  const auto [relrmse, bias] = differenceOf(*lit.gl_irradiance_rgb, lit.irradiance_rgb, 1);
  const GlTolerance most = glTolerance(technique_);
  expect("OpenGL: as on the CPU", relrmse <= most.relrmse && std::abs(bias) <= most.bias, "relrmse " + percent(most.relrmse) + ", bias " + percent(most.bias),
         "relrmse " + percent(relrmse) + ", bias " + percent(bias));
}

Lit Trial::light(const GltfDocument& scene, const Setup& setup) {
  Lit lit = bench_.light({.scene = &scene, .sky = setup.sky, .technique = technique_, .component = setup.component, .settings = setup.settings, .dynamic = setup.dynamic, .on_gl = setup.on_gl});
  rays_ += lit.rays;
  checkNumbers("", lit.irradiance_rgb);
  if (lit.gl_irradiance_rgb) checkGl(lit);
  expect("sound container", lit.unsound.empty(), "no issue", lit.unsound.empty() ? "none" : lit.unsound.front());
  checkCost(lit, scene, setup);
  return lit;
}

void Trial::expect(std::string_view what, bool passed, std::string_view expected, std::string_view got) {
  checks_.push_back({std::string(what), std::string(expected), std::string(got), passed});
}

void Trial::expectNear(std::string_view what, double got, double expected, double tolerance) {
  expect(what, std::abs(got - expected) <= tolerance * std::abs(expected), number(expected) + " ± " + percent(tolerance), number(got));
}

void Trial::expectAtMost(std::string_view what, double got, double most) { expect(what, got <= most, "at most " + number(most), number(got)); }

void Trial::expectEnergy(const Lit& lit, const Vec3d& emitted_lm, const Rgb& albedo_rgb, Component component, double tolerance) {
  const Vec3d flux_lm = lit.flux_rgb();
  static constexpr const char* kNames[] = {"received lumen, red", "received lumen, green", "received lumen, blue"};
  const bool grey = albedo_rgb.x == albedo_rgb.y && albedo_rgb.y == albedo_rgb.z && emitted_lm.x == emitted_lm.y && emitted_lm.y == emitted_lm.z;
  for (int c = 0; c < (grey ? 1 : 3); ++c) {
    const double albedo = double(albedo_rgb[c]), share = component == Component::indirect ? albedo / (1 - albedo) : component == Component::direct ? 1 : 1 / (1 - albedo);
    expectNear(grey ? "received lumen" : kNames[c], flux_lm[c], emitted_lm[c] * share, tolerance);
  }
}

void Trial::expectSame(std::string_view what, const Lit& got, const Lit& like, double factor, double tolerance) {
  if (got.irradiance_rgb.size() != like.irradiance_rgb.size() || got.irradiance_rgb.empty()) {
    expect(what, false, std::to_string(like.irradiance_rgb.size()) + " texels", std::to_string(got.irradiance_rgb.size()) + " texels");
    return;
  }
  const auto [relrmse, bias] = differenceOf(got.irradiance_rgb, like.irradiance_rgb, factor);
  const bool passed = relrmse <= tolerance && std::abs(bias) <= tolerance / 3;
  expect(what, passed, tolerance == 0 ? "the same bits" : "relrmse " + percent(tolerance) + ", bias " + percent(tolerance / 3), "relrmse " + percent(relrmse) + ", bias " + percent(bias));
}

void Trial::expectSection(const Lit& lit, bool there) {
  const std::string type(plan::name(technique_));
  std::string why;
  for (const auto& omitted : lit.omitted)
    if (omitted.type == type) why = omitted.reason;
  if (there) expect("section", lit.baked, "there", lit.baked ? "there" : "left out: " + why);
  else expect("section", !lit.baked && !why.empty(), "left out, with a reason", lit.baked ? "there" : why.empty() ? "no reason" : why);
}

void Trial::expectWarning(const Lit& lit, std::string_view part_of_it) {
  const bool warned = std::any_of(lit.warnings.begin(), lit.warnings.end(), [&](const Warning& w) { return w.message.find(part_of_it) != std::string::npos; });
  expect("warning", warned, part_of_it, warned ? "given" : std::to_string(lit.warnings.size()) + " others");
}

}  // namespace lightwell::stress
