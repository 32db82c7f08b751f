// Decoding an environment. Everything that evaluation relies on is checked here once.
#include <cmath>

#include "format/decode/pixel.h"
#include "runtime/src/container.h"
#include "runtime/src/environment.h"
#include "runtime/src/light.h"

namespace lightwell::runtime {
namespace {

using format::ElementType;

constexpr uint32_t kMostCells = 4096, kFewestFaceCells = 4, kMostFaceCells = 256;
constexpr float kMostNodeScale = 0x1p80f;

/// Decodes the section "environment" chunk by chunk; the first failure stays in `result`.
class Loader {
 public:
  Loader(const lw_container& container, lw_environment& environment) : container_(container), e_(environment) {}

  lw_result load() {
    if ((result_ = readEnvironmentHeader(container_, e_.header))) return result_;
    const format::EnvironmentHeader& h = e_.header;
    if (!h.cells || h.cells > kMostCells || h.suns > h.cells || h.face_cells < kFewestFaceCells || h.face_cells > kMostFaceCells ||
        h.face_cells % 2 != 0)
      return bad("header", "its counts cannot be");
    if (!(h.node_scale > 0 && h.node_scale <= kMostNodeScale) || !areAmounts(h.sky_flux_rgb, 3) || !allFinite(h.radiance_sh_rgb, 27))
      return bad("header", "a value is out of range");
    loadCells();
    if (!result_) loadSky();
    return result_;
  }

 private:
  lw_result bad(const char* chunk, const char* reason) {
    return result_ = container_.host.fail(LW_BAD_SECTION, "environment/%s: %s", chunk, reason);
  }
  lw_result noMemory() { return result_ = container_.host.fail(LW_OUT_OF_MEMORY, "environment: no memory for the cells and the sky"); }
  void decode(const char* name, uint64_t elements, Array<float>& values) {
    if (!result_) result_ = decodeChunk(container_, "environment", name, ElementType::f32, elements, values);
  }
  static bool areAmounts(const float* values, size_t count) {
    bool good = true;
    for (size_t i = 0; i < count; ++i) good &= values[i] >= 0 && values[i] <= kMaxIrradiance;
    return good;
  }
  static bool areWithin(const Array<float>& values, float least, float most) {
    bool good = true;
    for (const float v : values) good &= v >= least && v <= most;
    return good;
  }

  void loadCells() {
    const size_t cells = e_.header.cells;
    decode("cell_direction", cells * 3, e_.direction);
    decode("cell_flux", cells * 3, e_.flux_rgb);
    decode("cell_solid_angle", cells, e_.solid_angle_sr);
    decode("cell_spread", cells, e_.spread);
    decode("cell_covariance", cells * 3, e_.covariance);
    if (result_) return;
    if (!e_.cos_radius.allocate(container_.host, cells) || !e_.tangent.allocate(container_.host, cells * 3)) return void(noMemory());
    if (!areAmounts(e_.flux_rgb.data(), e_.flux_rgb.size())) return void(bad("cell_flux", "a value is out of range"));
    if (!areWithin(e_.solid_angle_sr, 0, 12.5664f)) return void(bad("cell_solid_angle", "a value is out of range"));
    if (!areWithin(e_.spread, 0, 1)) return void(bad("cell_spread", "a value is out of range"));
    if (!areWithin(e_.covariance, -1.001f, 1.001f)) return void(bad("cell_covariance", "a value is out of range"));
    for (size_t i = 0; i < cells; ++i) {
      const float* d = &e_.direction[i * 3];
      if (!(std::fabs(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - 1) <= 1e-3f))
        return void(bad("cell_direction", "a direction is not a unit vector"));
      e_.cos_radius[i] = 1 - e_.solid_angle_sr[i] * 0.159154943f;
      // Duff et al., "Building an Orthonormal Basis, Revisited" (JCGT 2017).
      const float sign = std::copysign(1.0f, d[2]), a = -1 / (sign + d[2]);
      float* tangent = &e_.tangent[i * 3];
      tangent[0] = 1 + sign * d[0] * d[0] * a;
      tangent[1] = sign * d[0] * d[1] * a;
      tangent[2] = -sign * d[0];
    }
  }

  void loadSky() {
    const uint64_t side = uint64_t(e_.header.face_cells) + 1;
    Array<uint16_t> node;
    if ((result_ = decodeChunk(container_, "environment", "node", ElementType::f16, 18 * side * side, node))) return;
    bool finite = true;
    for (const uint16_t v : node) finite &= (v & 0x7c00u) != 0x7c00u;
    if (!finite) return void(bad("node", "a value is not finite"));
    if (!e_.sky.build(container_.host, e_.header, node)) noMemory();
  }

  const lw_container& container_;
  lw_environment& e_;
  lw_result result_ = LW_OK;
};

}  // namespace
}  // namespace lightwell::runtime

using namespace lightwell::runtime;

lw_result lw_environment_load(const lw_container* container, lw_environment** out) {
  if (!container || !out) return LW_INVALID_ARGUMENT;
  auto* environment = createHandle<lw_environment>(container->host);
  if (!environment) return container->host.fail(LW_OUT_OF_MEMORY, "no memory for the environment's handle");
  if (const lw_result result = Loader(*container, *environment).load()) {
    destroyHandle(environment);
    return result;
  }
  *out = environment;
  return LW_OK;
}

void lw_environment_release(lw_environment* environment) { destroyHandle(environment); }

lw_result lw_environment_get_info(const lw_environment* environment, lw_environment_info* info) {
  if (!environment || !info) return LW_INVALID_ARGUMENT;
  const lightwell::format::EnvironmentHeader& h = environment->header;
  lw_environment_info out{};
  out.cells = h.cells;
  out.suns = h.suns;
  out.max_shininess = environment->sky.maxShininess();
  for (int c = 0; c < 3; ++c) out.sky_flux_rgb[c] = h.sky_flux_rgb[c];
  for (int i = 0; i < 27; ++i) out.sky_radiance_sh[i / 3][i % 3] = h.radiance_sh_rgb[i];
  *info = out;
  return LW_OK;
}

lw_result lw_environment_get_cells(const lw_environment* environment, lw_environment_cells* cells) {
  if (!environment || !cells) return LW_INVALID_ARGUMENT;
  const lw_environment& e = *environment;
  *cells = {e.direction.data(), e.flux_rgb.data(), e.solid_angle_sr.data(), e.cos_radius.data(),
            e.spread.data(),    e.covariance.data(), e.tangent.data()};
  return LW_OK;
}
