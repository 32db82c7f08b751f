// Light of moving lamps on patches, as in "Realtime global illumination (part 1)" (Rasmus' blog, 2016), section Light injection: pictures of patch numbers from the lamp, whose pixels
// carry the light of the solid angle that they cover. That angle is exact here, so that the power is the lamp's whatever the number of pixels.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "runtime/src/container.h"
#include "runtime/src/light.h"
#include "runtime/src/radiosity.h"
#include "runtime/src/radiosity_view.h"

struct lw_radiosity_injector {
  template <class T>
  using Array = lightwell::runtime::Array<T>;

  lightwell::runtime::Host host;
  const lw_radiosity* radiosity = nullptr;
  lightwell::runtime::Surfaces surfaces;
  Array<float> lightmap_uv;            // [vertices][2]
  Array<uint8_t> flags;                // [triangles]
  Array<uint32_t> value_of_texel;      // [height * width]: index into the radiosity's texels, or kNone
  Array<uint32_t> nearest_patch;       // [triangles][2]: for light that falls on no texel's patch, front and back; kUnknown until it is needed
  Array<double> power_rgb;             // [patches][3]
  Array<double> corner;                // [2][side + 1]: solid angles to the corners of a row of pixels
  float bounds_min_m[3], bounds_max_m[3];
  lightwell::runtime::ViewRaster raster;
};

namespace lightwell::runtime {
namespace {

constexpr uint32_t kUnknown = 0xfffffffeu;
constexpr uint32_t kNeighbourhood = 2;    // texels around one without a patch in which another is looked for
constexpr float kWidestSpot_rad = 1.0f;   // half angle beyond which six faces show more than one
constexpr double kPi = 3.14159265358979323846;

double dot(const double* a, const double* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// Solid angle between the axis and the point (x, y) of the plane at 1: the corner term of a rectangle's.
double cornerAngle(double x, double y) { return std::atan2(x * y, std::sqrt(1 + x * x + y * y)); }

/// The integral of a spot's edge over its cone.
double spotAngle(const PackedLight& light) {
  const double scale = double(light.spot_scale), outer = -double(light.spot_offset) / scale, edge = 1 / scale;
  if (outer + edge <= 1) return 2 * kPi * ((1 - outer - edge) + edge / 3);
  return 2 * kPi * std::pow(1 - outer, 3) * scale * scale / 3;
}

void orthonormal(const float* direction, View& view) {
  double norm = 0;
  for (int k = 0; k < 3; ++k) norm += double(direction[k]) * double(direction[k]);
  for (int k = 0; k < 3; ++k) view.forward[k] = double(direction[k]) / std::sqrt(norm);
  const int least = std::fabs(direction[0]) < std::fabs(direction[1]) ? (std::fabs(direction[0]) < std::fabs(direction[2]) ? 0 : 2)
                                                                      : (std::fabs(direction[1]) < std::fabs(direction[2]) ? 1 : 2);
  double axis[3] = {};
  axis[least] = 1;
  const double along = dot(axis, view.forward);
  for (int k = 0; k < 3; ++k) view.right[k] = axis[k] - along * view.forward[k];
  const double length = std::sqrt(dot(view.right, view.right));
  for (double& v : view.right) v /= length;
  for (int k = 0; k < 3; ++k)
    view.up[k] = view.forward[(k + 1) % 3] * view.right[(k + 2) % 3] - view.forward[(k + 2) % 3] * view.right[(k + 1) % 3];
}

/// Where the light of a view's pixels goes.
class Injection {
 public:
  Injection(lw_radiosity_injector& injector, const PackedLight& light) : i_(injector), r_(*injector.radiosity), light_(light) {}

  void run() {
    View view;
    for (int k = 0; k < 3; ++k) view.eye_m[k] = double(light_.position_m[k]);
    if (isType(light_, LW_LIGHT_DIRECTIONAL)) {
      fitToBounds(view);
      i_.raster.draw(i_.surfaces, view);
      const double side = 2.0 / i_.raster.side();
      const double area_m2 = std::sqrt(dot(view.right, view.right) * dot(view.up, view.up)) * side * side;
      forPixels(view, [&](uint32_t, uint32_t) { return area_m2; });
      return;
    }
    const bool spot = isType(light_, LW_LIGHT_SPOT);
    const double outer = spot ? std::acos(std::clamp(-double(light_.spot_offset) / double(light_.spot_scale), 0.0, 1.0)) : kPi;
    if (spot && outer <= double(kWidestSpot_rad)) {
      orthonormal(light_.direction, view);
      const double tangent = std::tan(outer);
      for (int k = 0; k < 3; ++k) view.right[k] *= tangent, view.up[k] *= tangent;
      cones(&view, 1, tangent);
    } else {
      // A cube that is aligned with nothing: along the edges of patches, pixels then change sides one after the other when the lamp moves, not whole rows at once.
      constexpr float kAskew[3] = {0.51f, 0.62f, 0.5963f};
      orthonormal(kAskew, view);
      const double* axis[3] = {view.forward, view.right, view.up};
      View faces[6];
      for (int f = 0; f < 6; ++f) {
        faces[f] = view;
        for (int k = 0; k < 3; ++k) {
          faces[f].forward[k] = axis[f / 2][k] * (f % 2 ? -1 : 1);
          faces[f].right[k] = axis[(f / 2 + 1) % 3][k];
          faces[f].up[k] = axis[(f / 2 + 2) % 3][k];
        }
      }
      cones(faces, 6, 1);
    }
  }

 private:
  /// The share of a spot's light that goes a pixel's way; 1 for a point light.
  double edgeAt(const View& view, double x, double y) const {
    if (!isType(light_, LW_LIGHT_SPOT)) return 1;
    double way[3], along = 0;
    for (int k = 0; k < 3; ++k) way[k] = view.forward[k] + x * view.right[k] + y * view.up[k];
    for (int k = 0; k < 3; ++k) along += way[k] * double(light_.direction[k]);
    const double edge = std::clamp(along / std::sqrt(dot(way, way)) * double(light_.spot_scale) + double(light_.spot_offset), 0.0, 1.0);
    return edge * edge;
  }
  double center(uint32_t i) const { return (2.0 * i + 1) / i_.raster.side() - 1; }
  double border(uint32_t i) const { return 2.0 * i / i_.raster.side() - 1; }
  /// The solid angle of a pixel. Pixels are asked for row by row: the corners of one are kept.
  double angleOf(double tangent, uint32_t i, uint32_t j) {
    const uint32_t corners = i_.raster.side() + 1;
    if (row_ != j) {
      for (uint32_t k = 0; k < corners * 2; ++k) i_.corner[k] = cornerAngle(tangent * border(k % corners), tangent * border(j + k / corners));
      row_ = j;
    }
    return (i_.corner[corners + i + 1] - i_.corner[corners + i]) - (i_.corner[i + 1] - i_.corner[i]);
  }

  /// Perspective views from the light, whose edges lie at `tangent`.
  void cones(const View* views, int count, double tangent) {
    // A spot's edge is sampled at the centres of pixels: what that makes too much or too little of the whole is taken back.
    double scale = 1;
    if (isType(light_, LW_LIGHT_SPOT)) {
      double found = 0;
      for (int v = 0; v < count; ++v)
        for (uint32_t j = 0; j < i_.raster.side(); ++j)
          for (uint32_t i = 0; i < i_.raster.side(); ++i)
            if (const double edge = edgeAt(views[v], center(i), center(j)); edge > 0) found += edge * angleOf(tangent, i, j);
      if (!(found > 0)) return;
      scale = spotAngle(light_) / found;
    }
    for (int v = 0; v < count; ++v) {
      i_.raster.draw(i_.surfaces, views[v]);
      forPixels(views[v], [&](uint32_t i, uint32_t j) {
        const double edge = edgeAt(views[v], center(i), center(j));
        return edge > 0 ? scale * edge * angleOf(tangent, i, j) : 0.0;
      });
    }
  }

  void fitToBounds(View& view) {
    view.perspective = false;
    orthonormal(light_.direction, view);
    double center_m[3], half[2] = {};
    for (int k = 0; k < 3; ++k) center_m[k] = view.eye_m[k] = 0.5 * (double(i_.bounds_min_m[k]) + double(i_.bounds_max_m[k]));
    for (int k = 0; k < 3; ++k) {
      const double extent = double(i_.bounds_max_m[k]) - center_m[k];
      half[0] += extent * std::fabs(view.right[k]);
      half[1] += extent * std::fabs(view.up[k]);
    }
    for (int k = 0; k < 3; ++k) view.right[k] *= std::max(half[0], 1e-12), view.up[k] *= std::max(half[1], 1e-12);
  }

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

  /// The normal of the triangle on the side that the view sees, of any length; and whether that is the front.
  bool facing(const View& view, uint32_t triangle, double* normal) const {
    const uint32_t* index = &i_.surfaces.index[size_t(triangle) * 3];
    const float* p[3];
    for (int c = 0; c < 3; ++c) p[c] = &i_.surfaces.position_m[size_t(index[c]) * 3];
    double a[3], b[3], to_eye[3];
    for (int k = 0; k < 3; ++k) {
      a[k] = double(p[1][k]) - double(p[0][k]);
      b[k] = double(p[2][k]) - double(p[0][k]);
      to_eye[k] = view.perspective ? view.eye_m[k] - double(p[0][k]) : -view.forward[k];
    }
    for (int k = 0; k < 3; ++k) normal[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
    if (dot(normal, to_eye) >= 0) return true;
    for (int k = 0; k < 3; ++k) normal[k] = -normal[k];
    return false;
  }

  uint32_t patchOf(uint32_t texel, bool front) const {
    const uint32_t value = i_.value_of_texel[texel];
    if (value == kNone) return kNone;
    if (front) return r_.texel_patch[size_t(value) * 4];
    return r_.texel_back_patch.empty() ? kNone : r_.texel_back_patch[value];
  }
  bool faces(uint32_t patch, const double* normal) const {
    double cosine = 0;
    for (int k = 0; k < 3; ++k) cosine += normal[k] * double(r_.patch_normal[size_t(patch) * 3 + size_t(k)]);
    return cosine > 0;
  }

  uint32_t patchAt(const View& view, uint32_t triangle, const double* barycentrics) {
    double normal[3], uv[2] = {};
    const bool front = facing(view, triangle, normal);
    if (!front && !(i_.flags[triangle] & LW_TRIANGLE_DOUBLE_SIDED)) return kNone;  // absorbed
    const uint32_t* index = &i_.surfaces.index[size_t(triangle) * 3];
    for (int c = 0; c < 3; ++c)
      for (int k = 0; k < 2; ++k) uv[k] += barycentrics[c] * double(i_.lightmap_uv[size_t(index[c]) * 2 + size_t(k)]);
    const auto x = uint32_t(std::clamp(uv[0] * r_.width, 0.0, double(r_.width - 1))), y = uint32_t(std::clamp(uv[1] * r_.height, 0.0, double(r_.height - 1)));
    const uint32_t own = patchOf(y * r_.width + x, front);
    if (own != kNone) return own;
    // A sliver's texel, or one that is mostly behind something: what little is seen of it belongs to its neighbour.
    uint32_t best = kNone, best_distance = 2 * kNeighbourhood * kNeighbourhood + 1;
    for (uint32_t v = y - std::min(y, kNeighbourhood); v <= std::min(y + kNeighbourhood, r_.height - 1); ++v)
      for (uint32_t u = x - std::min(x, kNeighbourhood); u <= std::min(x + kNeighbourhood, r_.width - 1); ++u) {
        const uint32_t distance = (u > x ? u - x : x - u) * (u > x ? u - x : x - u) + (v > y ? v - y : y - v) * (v > y ? v - y : y - v);
        const uint32_t patch = distance < best_distance ? patchOf(v * r_.width + u, front) : kNone;
        if (patch != kNone && faces(patch, normal)) best = patch, best_distance = distance;
      }
    return best != kNone ? best : nearestTo(triangle, front, normal);
  }

  /// The patch nearest to the triangle's centre that faces the same way.
  uint32_t nearestTo(uint32_t triangle, bool front, const double* normal) {
    uint32_t& known = i_.nearest_patch[size_t(triangle) * 2 + !front];
    if (known != kUnknown) return known;
    double center_m[3] = {}, least = HUGE_VAL;
    for (int c = 0; c < 3; ++c)
      for (int k = 0; k < 3; ++k) center_m[k] += double(i_.surfaces.position_m[size_t(i_.surfaces.index[size_t(triangle) * 3 + size_t(c)]) * 3 + size_t(k)]) / 3;
    known = kNone;
    for (uint32_t p = 0; p < r_.patches(); ++p) {
      double square = 0;
      for (int k = 0; k < 3; ++k) square += std::pow(double(r_.patch_position_m[size_t(p) * 3 + size_t(k)]) - center_m[k], 2);
      if (square < least && faces(p, normal)) least = square, known = p;
    }
    return known;
  }

  lw_radiosity_injector& i_;
  const lw_radiosity& r_;
  const PackedLight& light_;
  uint32_t row_ = kNone;  // of pixels, whose corners are in i_.corner
};

/// Decodes an array whose element has `components` numbers.
template <class T>
lw_result decode(const lw_container* container, lw_array array, Array<T>& values) {
  lw_array_info info;
  if (const lw_result result = lw_get_array_info(container, array, &info)) return result;
  if (!values.allocate(container->host, info.bytes / sizeof(T))) return container->host.fail(LW_OUT_OF_MEMORY, "no memory for %zu bytes of geometry", info.bytes);
  return lw_decode_array(container, array, values.data(), info.bytes);
}

lw_result loadAlpha(const lw_container* container, const Array<uint8_t>& flags, AlphaSurfaces& alpha) {
  bool any = false;
  for (const uint8_t f : flags) any |= (f & (LW_TRIANGLE_CUT_OUT | LW_TRIANGLE_BLEND)) != 0;
  if (!any) return LW_OK;
  lw_result result = decode(container, LW_ARRAY_ALPHA_UV, alpha.uv);
  if (!result) result = decode(container, LW_ARRAY_TRIANGLE_ALPHA, alpha.triangle_material);
  if (result) return result;
  size_t materials = 0, bytes = 0;
  for (const uint16_t m : alpha.triangle_material)
    if (m != 0xffff) materials = std::max(materials, size_t(m) + 1);
  if (!alpha.material.allocate(container->host, materials) || !alpha.first_alpha.allocate(container->host, materials))
    return container->host.fail(LW_OUT_OF_MEMORY, "no memory for %zu materials", materials);
  for (size_t m = 0; m < materials; ++m) {
    if ((result = lw_get_alpha_material(container, uint32_t(m), &alpha.material[m]))) return result == LW_NOT_FOUND ? LW_BAD_SECTION : result;
    alpha.first_alpha[m] = bytes;
    bytes += size_t(alpha.material[m].texture_width) * alpha.material[m].texture_height;
  }
  if (!alpha.alpha.allocate(container->host, bytes)) return container->host.fail(LW_OUT_OF_MEMORY, "no memory for %zu bytes of textures", bytes);
  for (size_t m = 0; m < materials; ++m) {
    const lw_alpha_material& surface = alpha.material[m];
    if (surface.texture < 0) continue;
    if (!surface.texture_width || !surface.texture_height) return container->host.fail(LW_BAD_SECTION, "geometry: an alpha texture is empty");
    if ((result = lw_decode_alpha_texture(container, uint32_t(surface.texture), &alpha.alpha[alpha.first_alpha[m]],
                                          size_t(surface.texture_width) * surface.texture_height)))
      return result;
  }
  return LW_OK;
}

lw_result load(const lw_container* container, uint32_t side, lw_radiosity_injector& i) {
  const lw_radiosity& r = *i.radiosity;
  lw_result result = decode(container, LW_ARRAY_POSITION, i.surfaces.position_m);
  if (!result) result = decode(container, LW_ARRAY_INDEX, i.surfaces.index);
  if (!result) result = decode(container, LW_ARRAY_LIGHTMAP_UV, i.lightmap_uv);
  if (!result) result = decode(container, LW_ARRAY_TRIANGLE_FLAGS, i.flags);
  if (!result) result = loadAlpha(container, i.flags, i.surfaces.alpha);
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
  std::fill(i.nearest_patch.begin(), i.nearest_patch.end(), kUnknown);
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
