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
  Job job{.sky = setup.sky, .technique = technique_, .component = setup.component, .settings = setup.settings};
  job.settings.lightmap_size = kPlainSize;
  PlainCost& cost = plain_[{technique_, kPlainSize, setup.sky != nullptr, int(setup.settings.quality)}];
  if (cost.texels == 0) {
    const GltfDocument room = plainRoom();
    job.scene = &room;
    const Lit lit = bench_.light(job);
    cost = {lit.rays, lit.seconds, lit.scene.atlas.slots.size()};
  }
  return cost;
}

void Trial::checkCost(const Lit& lit, const GltfDocument& scene, const Setup& setup) {
  const PlainCost plain = plainCost(setup);
  const double share = std::max(1.0, double(lit.scene.atlas.slots.size()) / double(plain.texels));
  const double most_rays = setup.most_work * share * double(plain.rays);
  expect("rays", double(lit.rays) <= most_rays, "at most " + number(most_rays), number(double(lit.rays)));
  const double most_seconds =
      setup.most_work * share * plain.seconds + kSlackSeconds + kSecondsPerMillionTriangles * 1e-6 * double(scene.triangleCount());
  expect("seconds", lit.seconds <= most_seconds, "at most " + number(most_seconds), number(lit.seconds));
}

Lit Trial::light(const GltfDocument& scene, const Setup& setup) {
  Lit lit = bench_.light({.scene = &scene, .sky = setup.sky, .technique = technique_, .component = setup.component, .settings = setup.settings});
  rays_ += lit.rays;
  size_t not_finite = 0, negative = 0;
  for (const Rgb& rgb : lit.irradiance_rgb) {
    not_finite += !isFinite(rgb);
    negative += rgb.x < 0 || rgb.y < 0 || rgb.z < 0;
  }
  const std::string texels = std::to_string(lit.irradiance_rgb.size()) + " texels";
  expect("finite", not_finite == 0, "all of " + texels, std::to_string(not_finite) + " are not");
  expect("not negative", negative == 0, "all of " + texels, std::to_string(negative) + " are");
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
  double difference2 = 0, square = 0, sum = 0, like_sum = 0;
  for (size_t i = 0; i < got.irradiance_rgb.size(); ++i) {
    const Vec3d expected = Vec3d(like.irradiance_rgb[i]) * factor, is(got.irradiance_rgb[i]);
    difference2 += (is - expected).length2(), square += expected.length2();
    sum += is.x + is.y + is.z, like_sum += expected.x + expected.y + expected.z;
  }
  const double relrmse = square > 0 ? std::sqrt(difference2 / square) : difference2 > 0 ? HUGE_VAL : 0;
  const double bias = like_sum > 0 ? sum / like_sum - 1 : sum;
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
