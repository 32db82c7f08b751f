// One case under one technique: it bakes, states what must hold, and keeps what was found.
#pragma once
#include <map>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "cli/stress/workbench.h"

namespace lightwell::stress {

struct Check {
  std::string what, expected, got;
  bool passed = false;
};

/// What a plain room of the same settings costs; filled as it is asked for.
struct PlainCost {
  uint64_t rays = 0;
  double seconds = 0, gl_seconds = 0;
  size_t texels = 0;
};
using PlainCosts = std::map<std::tuple<plan::Technique, bool, bool, int>, PlainCost>;  // technique, dynamic, sky, quality

class Trial {
 public:
  Trial(plan::Technique technique, const Workbench& bench, PlainCosts& plain) : technique_(technique), bench_(bench), plain_(plain) {}

  plan::Technique technique() const { return technique_; }
  bool is(plan::Technique technique) const { return technique_ == technique; }
  const Workbench& bench() const { return bench_; }

  struct Setup {
    transport::Component component = transport::Component::indirect;
    const ImageRgba* sky = nullptr;
    plan::Settings settings = plainSettings();
    std::optional<Dynamic> dynamic;
    bool on_gl = true;
    double most_work = 20;  // rays and seconds, in those of a plain room for each of its texels
  };
  static plan::Settings plainSettings();

  /// Bakes and evaluates. Checks what holds for every scene there is: no number that is not finite or is negative, a container without an issue, rays and seconds in
  /// proportion to a plain room's, on OpenGL the light of the CPU.
  Lit light(const GltfDocument& scene, const Setup& setup);
  Lit light(const GltfDocument& scene) { return light(scene, Setup{}); }

  void expect(std::string_view what, bool passed, std::string_view expected, std::string_view got);
  /// |got − expected| ≤ tolerance × |expected|
  void expectNear(std::string_view what, double got, double expected, double tolerance);
  void expectAtMost(std::string_view what, double got, double most);
  /// Where all light stays in a room of one albedo, each surface absorbs (1 − albedo) E: together just what is emitted, whatever the shape. `emitted_lm`: per channel.
  /// `component`: that `lit` has: after reflections it is the albedo's share of it.
  void expectEnergy(const Lit& lit, const Vec3d& emitted_lm, const Rgb& albedo_rgb, transport::Component component, double tolerance);
  /// Texel by texel: rms of `got` − factor × `like` at most tolerance × rms of the latter; the mean within a third of it.
  void expectSame(std::string_view what, const Lit& got, const Lit& like, double factor, double tolerance);
  void expectSection(const Lit& lit, bool there);
  void expectWarning(const Lit& lit, std::string_view part_of_it);

  const std::vector<Check>& checks() const { return checks_; }
  uint64_t rays() const { return rays_; }

 private:
  PlainCost plainCost(const Setup& setup);
  void checkNumbers(const std::string& prefix, const std::vector<Rgb>& irradiance_rgb);
  void checkGl(const Lit& lit);
  void checkCost(const Lit& lit, const GltfDocument& scene, const Setup& setup);
  plan::Technique technique_;
  const Workbench& bench_;
  PlainCosts& plain_;
  std::vector<Check> checks_;
  uint64_t rays_ = 0;
};

/// 4 × 3 × 4 m about the origin, one material, with a lamp of 10 cd.
GltfDocument plainRoom(const Look& look = {}, double intensity_cd = 10);
/// Of a lamp of one candela.
inline constexpr double kLumenPerCandela = 4 * std::numbers::pi;

}  // namespace lightwell::stress
