// Light of moving lamps on patches, as in "Realtime global illumination (part 1)" (Rasmus' blog, 2016), section Light injection: pictures of patch numbers from the lamp, whose pixels
// carry the light of the solid angle that they cover. That angle is exact here, so that the power is the lamp's whatever the number of pixels.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "runtime/src/geometry.h"
#include "runtime/src/radiosity_injector.h"

namespace lightwell::runtime {
namespace {

/// Where the light of a view's pixels goes.
class Injection {
 public:
  Injection(lw_radiosity_injector& injector, const PackedLight& light) : i_(injector), finder_(injector), light_(light) {}

  void run() {
    const LampViews views = lampViews(light_, i_.bounds_min_m, i_.bounds_max_m);
    const uint32_t side = i_.raster.side();
    if (!views.view[0].perspective) {
      const View& view = views.view[0];
      i_.raster.draw(i_.surfaces, view);
      const double area_m2 = std::sqrt(dot(view.right, view.right) * dot(view.up, view.up)) * 4 / (double(side) * side);
      forPixels(view, [&](uint32_t, uint32_t) { return area_m2; });
      return;
    }
    // A spot's edge is sampled at the centres of pixels: what that makes too much or too little of the whole is taken back.
    const double scale = spotScale(light_, views, side, i_.corner.data());
    if (!(scale > 0)) return;
    for (int v = 0; v < views.count; ++v) {
      const View& view = views.view[v];
      i_.raster.draw(i_.surfaces, view);
      uint32_t row = kNone;  // whose corners are known
      forPixels(view, [&](uint32_t i, uint32_t j) {
        const double edge = lampEdge(light_, view, center(i), center(j));
        if (!(edge > 0)) return 0.0;
        if (row != j) cornerAngles(views.tangent, side, row = j, i_.corner.data());
        return scale * edge * pixelAngle(i_.corner.data(), side, i);
      });
    }
  }

 private:
  double center(uint32_t i) const { return (2.0 * i + 1) / i_.raster.side() - 1; }

  /// `amount` of a pixel: what its light is multiplied with, steradians or square metres.
  template <class Amount>
  void forPixels(const View& view, Amount amount) {
    for (uint32_t j = 0; j < i_.raster.side(); ++j)
      for (uint32_t i = 0; i < i_.raster.side(); ++i) {
        const uint32_t triangle = i_.raster.triangleAt(i, j);
        if (triangle == ViewRaster::kNothing) continue;
        double power = amount(i, j);
        if (!(power > 0)) continue;
        double barycentrics[3];
        const double depth = i_.raster.placeAt(i_.surfaces, view, i, j, barycentrics);
        if (light_.range_m > 0) {
          double way[3];
          for (int k = 0; k < 3; ++k) way[k] = view.forward[k] + center(i) * view.right[k] + center(j) * view.up[k];
          const double relative = depth * depth * dot(way, way) / (double(light_.range_m) * double(light_.range_m));
          power *= std::clamp(1 - relative * relative, 0.0, 1.0);
        }
        const uint32_t patch = patchAt(view, triangle, barycentrics);
        if (patch == kNone) continue;
        for (size_t k = 0; k < 3; ++k) i_.power_rgb[size_t(patch) * 3 + k] += power * double(light_.intensity_rgb[k]);
      }
  }

  uint32_t patchAt(const View& view, uint32_t triangle, const double* barycentrics) {
    const uint32_t* index = &i_.surfaces.index[size_t(triangle) * 3];
    double normal[3], to_eye[3], uv[2] = {};
    finder_.normalOf(triangle, true, normal);
    for (int k = 0; k < 3; ++k) to_eye[k] = view.perspective ? view.eye_m[k] - double(i_.surfaces.position_m[size_t(index[0]) * 3 + size_t(k)]) : -view.forward[k];
    const bool front = dot(normal, to_eye) >= 0;
    if (!front)
      for (double& n : normal) n = -n;
    for (int c = 0; c < 3; ++c)
      for (int k = 0; k < 2; ++k) uv[k] += barycentrics[c] * double(i_.lightmap_uv[size_t(index[c]) * 2 + size_t(k)]);
    return finder_.patchAt(triangle, front, normal, uv);
  }

  lw_radiosity_injector& i_;
  PatchFinder finder_;
  const PackedLight& light_;
};

/// The leaves of the portals, all shut.
lw_result loadLeaves(const lw_container* container, const lw_radiosity& r, Surfaces& surfaces) {
  size_t leaves = 0, end = 0;
  for (const auto& portal : r.portal) leaves += portal.triangles > 0;
  if (!surfaces.leaf.allocate(container->host, leaves) || !surfaces.gate_open.allocate(container->host, r.gates))
    return container->host.fail(LW_OUT_OF_MEMORY, "no memory for %zu leaves", leaves);
  std::fill(surfaces.gate_open.begin(), surfaces.gate_open.end(), 0.0f);
  leaves = 0;
  for (const auto& p : r.portal) {
    if (!p.triangles) continue;
    if (p.first_triangle < end || uint64_t(p.first_triangle) + p.triangles > surfaces.triangles())
      return container->host.fail(LW_BAD_SECTION, "radiosity/header: triangles of a portal are another's or not in the geometry");
    end = size_t(p.first_triangle) + p.triangles;
    surfaces.leaf[leaves++] = {p.first_triangle, p.triangles, {p.axis_per_m[0], p.axis_per_m[1], p.axis_per_m[2]}, p.offset, p.first_gate, p.strips};
  }
  return LW_OK;
}

lw_result load(const lw_container* container, uint32_t side, lw_radiosity_injector& i) {
  const lw_radiosity& r = *i.radiosity;
  lw_result result = decodeArray(container, LW_ARRAY_POSITION, i.surfaces.position_m);
  if (!result) result = decodeArray(container, LW_ARRAY_INDEX, i.surfaces.index);
  if (!result) result = decodeArray(container, LW_ARRAY_LIGHTMAP_UV, i.lightmap_uv);
  if (!result) result = decodeArray(container, LW_ARRAY_TRIANGLE_FLAGS, i.flags);
  if (!result) result = loadAlpha(container, i.flags, i.surfaces.alpha);
  if (!result) result = loadLeaves(container, r, i.surfaces);
  if (result) return result;
  const size_t vertices = i.surfaces.position_m.size() / 3;
  if (i.lightmap_uv.size() != vertices * 2 || i.flags.size() != i.surfaces.triangles() ||
      (!i.surfaces.alpha.uv.empty() && i.surfaces.alpha.uv.size() != vertices * 2) ||
      (!i.surfaces.alpha.triangle_material.empty() && i.surfaces.alpha.triangle_material.size() != i.surfaces.triangles()))
    return container->host.fail(LW_BAD_SECTION, "geometry: the lengths of its arrays contradict each other");
  if (!i.value_of_texel.allocate(i.host, r.source.size()) || !i.nearest_patch.allocate(i.host, size_t(i.surfaces.triangles()) * 2) ||
      !i.power_rgb.allocate(i.host, size_t(r.patches()) * 3) || !i.corner.allocate(i.host, (size_t(side) + 1) * 2) || !i.raster.allocate(i.host, side))
    return container->host.fail(LW_OUT_OF_MEMORY, "no memory for injecting light");
  std::fill(i.value_of_texel.begin(), i.value_of_texel.end(), kNone);
  std::fill(i.nearest_patch.begin(), i.nearest_patch.end(), kUnknownPatch);
  for (uint32_t t = 0; t < r.header.texels; ++t) i.value_of_texel[r.texel[t]] = t;
  for (int k = 0; k < 3; ++k) i.bounds_min_m[k] = vertices ? HUGE_VALF : 0, i.bounds_max_m[k] = vertices ? -HUGE_VALF : 0;
  for (size_t v = 0; v < vertices * 3; ++v) {
    i.bounds_min_m[v % 3] = std::min(i.bounds_min_m[v % 3], i.surfaces.position_m[v]);
    i.bounds_max_m[v % 3] = std::max(i.bounds_max_m[v % 3], i.surfaces.position_m[v]);
  }
  return LW_OK;
}

}  // namespace
}  // namespace lightwell::runtime

using namespace lightwell::runtime;

lw_result lw_radiosity_injector_create(const lw_container* container, const lw_radiosity* radiosity, uint32_t side, lw_radiosity_injector** out) {
  if (!container || !radiosity || !out) return LW_INVALID_ARGUMENT;
  if (side < 8 || side > 4096) return container->host.fail(LW_INVALID_ARGUMENT, "a view has 8 to 4096 pixels along its side, not %u", side);
  lw_radiosity_injector* injector = createHandle<lw_radiosity_injector>(container->host);
  if (!injector) return container->host.fail(LW_OUT_OF_MEMORY, "no memory for the handle of the injector");
  injector->radiosity = radiosity;
  if (const lw_result result = load(container, side, *injector)) {
    destroyHandle(injector);
    return result;
  }
  *out = injector;
  return LW_OK;
}

void lw_radiosity_injector_destroy(lw_radiosity_injector* injector) { destroyHandle(injector); }

lw_result lw_radiosity_injector_set_portals(lw_radiosity_injector* injector, const lw_radiosity_state* state) {
  if (!injector || !state) return LW_INVALID_ARGUMENT;
  if (state->gate_open.size() != injector->surfaces.gate_open.size()) return injector->host.fail(LW_INVALID_ARGUMENT, "the state is of other form factors");
  std::copy(state->gate_open.begin(), state->gate_open.end(), injector->surfaces.gate_open.begin());
  return LW_OK;
}

lw_result lw_radiosity_inject(lw_radiosity_injector* injector, const lw_light* lights, uint32_t light_count, float* irradiance_rgb) {
  if (!injector || !irradiance_rgb || (light_count && !lights)) return LW_INVALID_ARGUMENT;
  PackedLight light;
  for (uint32_t l = 0; l < light_count; ++l)
    if (const char* reason = packLight(lights[l], light)) return injector->host.fail(LW_INVALID_ARGUMENT, "light %u: %s", l, reason);
  std::fill(injector->power_rgb.begin(), injector->power_rgb.end(), 0.0);
  for (uint32_t l = 0; l < light_count; ++l) {
    packLight(lights[l], light);
    Injection(*injector, light).run();
  }
  for (size_t i = 0; i < injector->power_rgb.size(); ++i)
    irradiance_rgb[i] = float(std::min(injector->power_rgb[i] / double(injector->radiosity->patch_area_m2[i / 3]), double(LW_RADIOSITY_MOST)));
  return LW_OK;
}
