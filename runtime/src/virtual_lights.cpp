// Virtual lights: decoding, and what one of them gives to a point.
#include "runtime/src/virtual_lights.h"

#include <cmath>
#include <cstring>

#include "runtime/src/container.h"
#include "runtime/src/form_factor.h"

namespace lightwell::runtime {
namespace {

using format::ElementType;
constexpr const char* kSection = "vpl";

Float3 float3(const float* v) { return {v[0], v[1], v[2]}; }

/// Twice the area of a planar polygon, as a vector along its normal.
Float3 areaVector(const float* vertices, uint32_t count) {
  Float3 sum{0, 0, 0};
  const Float3 origin = float3(vertices);
  for (uint32_t i = 2; i < count; ++i) sum = sum + cross(float3(vertices + (i - 1) * 3) - origin, float3(vertices + i * 3) - origin);
  return sum;
}

lw_result load(const lw_container& container, lw_virtual_lights& lights) {
  if (const lw_result result = readHeader(container, kSection, [&](const Array<uint8_t>& message) {
        return format::parseVplHeader(message.data(), message.size(), lights.header);
      }))
    return result;
  const uint64_t n = lights.header.lights, v = lights.header.vertices;
  if (n == 0) return container.host.fail(LW_BAD_SECTION, "vpl/header: it has no lights");
  const auto floats = [&](const char* name, uint64_t count, Array<float>& values) -> lw_result {
    if (const lw_result result = decodeChunk(container, kSection, name, ElementType::f32, count, values)) return result;
    return allFinite(values.data(), values.size()) ? LW_OK : container.host.fail(LW_BAD_SECTION, "vpl/%s: a value is not finite", name);
  };
  if (const lw_result result = decodeChunk(container, kSection, "type", ElementType::u8, n, lights.type)) return result;
  if (const lw_result result = decodeChunk(container, kSection, "source", ElementType::u32, n, lights.source)) return result;
  if (const lw_result result = decodeChunk(container, kSection, "bounce", ElementType::u8, n, lights.bounce)) return result;
  if (const lw_result result = floats("position", n * 3, lights.position_m)) return result;
  if (const lw_result result = floats("normal", n * 3, lights.normal)) return result;
  if (const lw_result result = floats("flux", n * 3, lights.flux_rgb)) return result;
  if (const lw_result result = floats("radius", n, lights.radius_m)) return result;
  if (const lw_result result = decodeChunk(container, kSection, "first_vertex", ElementType::u32, n + 1, lights.first_vertex))
    return result;
  lights.vertex_m.allocate(container.host, 0);
  if (v > 0)
    if (const lw_result result = floats("vertex", v * 3, lights.vertex_m)) return result;
  if (!lights.area_m2.allocate(container.host, n))
    return container.host.fail(LW_OUT_OF_MEMORY, "vpl: no memory for %u areas", lights.header.lights);
  if (lights.first_vertex[0] != 0 || lights.first_vertex[n] != v)
    return container.host.fail(LW_BAD_SECTION, "vpl/first_vertex: it does not span the vertices");
  for (size_t i = 0; i < n; ++i) {
    const uint32_t type = lights.type[i], first = lights.first_vertex[i], end = lights.first_vertex[i + 1];
    const bool polygon = type == LW_VIRTUAL_POLYGON, round = type == LW_VIRTUAL_DISK || type == LW_VIRTUAL_SPHERE;
    if (type < LW_VIRTUAL_POINT || type > LW_VIRTUAL_POLYGON)
      return container.host.fail(LW_BAD_SECTION, "vpl/type: value %zu is unknown", i);
    if (end < first || end > v || (polygon ? end - first < 3 || end - first > kMostPolygonVertices : end != first))
      return container.host.fail(LW_BAD_SECTION, "vpl/first_vertex: value %zu does not fit its type", i);
    if (lights.source[i] >= lights.header.sources) return container.host.fail(LW_BAD_SECTION, "vpl/source: value %zu is no source", i);
    for (int k = 0; k < 3; ++k)
      if (!(lights.flux_rgb[i * 3 + size_t(k)] >= 0)) return container.host.fail(LW_BAD_SECTION, "vpl/flux: value %zu is negative", i);
    const Float3 normal = float3(&lights.normal[i * 3]);
    if (!(std::abs(dot(normal, normal) - 1) < 1e-3f))
      return container.host.fail(LW_BAD_SECTION, "vpl/normal: value %zu is not a unit vector", i);
    const float radius = lights.radius_m[i];
    if (round ? !(radius > 0) : radius != 0) return container.host.fail(LW_BAD_SECTION, "vpl/radius: value %zu does not fit its type", i);
    lights.area_m2[i] = round ? kPiF * radius * radius : 0;
    if (polygon) {
      const Float3 twice = areaVector(&lights.vertex_m[size_t(first) * 3], end - first);
      lights.area_m2[i] = 0.5f * std::sqrt(dot(twice, twice));
      if (!(lights.area_m2[i] > 0) || !(dot(twice, normal) > 0))
        return container.host.fail(LW_BAD_SECTION, "vpl/vertex: polygon %zu has no area on its front", i);
    }
  }
  return LW_OK;
}

/// Where the receiver is looked at from: out of the region within epsilon of the light's plane, along its own surface (Luksch et al. 2013,
/// section 6.1).
Float3 movedOffPlane(const lw_virtual_light& light, Float3 position, Float3 normal, float epsilon) {
  const Float3 plane = float3(light.normal), from = position - float3(light.position_m);
  const float height = dot(plane, from);
  if (!(epsilon > 0) || !(std::abs(height) < epsilon) || !(dot(normal, from) < 0)) return position;
  const Float3 along = plane - normal * dot(plane, normal);
  const float sine2 = dot(along, along);
  // Nearly parallel planes are left alone: the way along the surface would be long.
  return sine2 > 0.01f ? position + along * ((epsilon - height) / sine2) : position;
}

/// Irradiance by a light of flux 1.
float unitIrradiance(const lw_virtual_light& light, Float3 position, Float3 normal, float epsilon) {
  position = movedOffPlane(light, position, normal, epsilon);
  const Float3 to_light = float3(light.position_m) - position, light_normal = float3(light.normal);
  const float size = largest(to_light);
  if (!(size < 1e18f)) return 0;
  const float distance2 = dot(to_light, to_light), distance = std::sqrt(distance2);
  // At the light's own middle there is no direction to it: as if right above.
  const Float3 direction = distance > 0 ? to_light * (1 / distance) : normal;
  const float receiver_cosine = std::max(dot(direction, normal), 0.0f), light_cosine = std::max(-dot(direction, light_normal), 0.0f);
  const auto point = [&](float more_area) {
    return receiver_cosine * light_cosine / std::max(kPiF * std::max(distance2, epsilon * epsilon) + more_area, 1e-30f);
  };
  switch (light.type) {
    case LW_VIRTUAL_POINT:
      return point(0);
    case LW_VIRTUAL_DISK:
      return point(light.area_m2);  // Wallace et al. 1989
    case LW_VIRTUAL_SPHERE: {
      // Hasan et al., "Virtual Spherical Lights" (2009), for diffuse surfaces: mean over the sphere's cone of directions of both cosines,
      // here one by one.
      const float sine = distance > light.radius_m ? light.radius_m / distance : 1.0f;
      if (sine < 1e-3f) return point(0);
      const float solid_angle = 2 * kPiF * (sine * sine / (1 + std::sqrt(std::max(1 - sine * sine, 0.0f))));
      const float received = coneIrradiance(dot(direction, normal), sine),
                  sent = coneIrradiance(-dot(direction, light_normal), sine) / solid_angle;
      return received * sent / (kPiF * light.area_m2);
    }
    default:
      break;
  }
  if (!(dot(light_normal, to_light) < 0)) return 0;  // from behind
  float radius2 = 0;
  Float3 vertices[kMostPolygonVertices];
  for (uint32_t i = 0; i < light.vertex_count; ++i) {
    const Float3 vertex = float3(light.vertices_m + size_t(i) * 3), from_middle = vertex - float3(light.position_m);
    radius2 = std::max(radius2, dot(from_middle, from_middle));
    vertices[i] = vertex - position;
  }
  if (radius2 < kPointRadius * kPointRadius * distance2) return point(0);
  return polygonFormFactor(vertices, light.vertex_count, normal) / light.area_m2;
}

}  // namespace
}  // namespace lightwell::runtime

using namespace lightwell::runtime;

lw_result lw_virtual_lights_load(const lw_container* container, lw_virtual_lights** out) {
  if (!container || !out) return LW_INVALID_ARGUMENT;
  lw_virtual_lights* lights = createHandle<lw_virtual_lights>(container->host);
  if (!lights) return container->host.fail(LW_OUT_OF_MEMORY, "no memory for the handle of the virtual lights");
  if (const lw_result result = load(*container, *lights)) {
    destroyHandle(lights);
    return result;
  }
  *out = lights;
  return LW_OK;
}

void lw_virtual_lights_release(lw_virtual_lights* lights) { destroyHandle(lights); }

lw_result lw_virtual_lights_get_info(const lw_virtual_lights* lights, lw_virtual_lights_info* info) {
  if (!lights || !info) return LW_INVALID_ARGUMENT;
  *info = {lights->header.lights, lights->header.sources};
  return LW_OK;
}

lw_result lw_virtual_lights_get(const lw_virtual_lights* lights, uint32_t index, lw_virtual_light* out) {
  if (!lights || !out || index >= lights->header.lights) return LW_INVALID_ARGUMENT;
  const size_t i = index;
  *out = {};
  out->type = lights->type[i], out->source = lights->source[i], out->bounce = lights->bounce[i];
  std::memcpy(out->position_m, &lights->position_m[i * 3], sizeof out->position_m);
  std::memcpy(out->normal, &lights->normal[i * 3], sizeof out->normal);
  std::memcpy(out->flux_rgb, &lights->flux_rgb[i * 3], sizeof out->flux_rgb);
  out->radius_m = lights->radius_m[i], out->area_m2 = lights->area_m2[i];
  out->vertex_count = lights->first_vertex[i + 1] - lights->first_vertex[i];
  if (out->vertex_count > 0) out->vertices_m = &lights->vertex_m[size_t(lights->first_vertex[i]) * 3];
  return LW_OK;
}

lw_result lw_virtual_light_irradiance(const lw_virtual_light* light, const float position_m[3], const float normal[3], float epsilon_m,
                                      float irradiance_rgb[3]) {
  if (!light || !position_m || !normal || !irradiance_rgb || !(epsilon_m >= 0) || light->type < LW_VIRTUAL_POINT ||
      light->type > LW_VIRTUAL_POLYGON || light->vertex_count > kMostPolygonVertices ||
      (light->type == LW_VIRTUAL_POLYGON && !light->vertices_m) || (light->type != LW_VIRTUAL_POINT && !(light->area_m2 > 0)))
    return LW_INVALID_ARGUMENT;
  const float share = unitIrradiance(*light, float3(position_m), float3(normal), epsilon_m);
  for (int k = 0; k < 3; ++k) irradiance_rgb[k] = std::min(light->flux_rgb[k] * share, 1e30f);
  return LW_OK;
}

lw_result lw_virtual_light_point(const lw_virtual_light* light, const float uv[2], float position_m[3]) {
  if (!light || !uv || !position_m || (light->type == LW_VIRTUAL_POLYGON && (!light->vertices_m || light->vertex_count < 3)))
    return LW_INVALID_ARGUMENT;
  Float3 at = float3(light->position_m);
  if (light->type == LW_VIRTUAL_DISK || light->type == LW_VIRTUAL_SPHERE) {
    const Float3 n = float3(light->normal);
    const Float3 tangent = std::abs(n.x) > 0.5f ? Float3{n.y, -n.x, 0} : Float3{0, n.z, -n.y};
    const Float3 s = tangent * (1 / std::sqrt(std::max(dot(tangent, tangent), 1e-30f))), t = cross(n, s);
    const float r = light->radius_m * std::sqrt(std::max(uv[0], 0.0f)), angle = 2 * kPiF * uv[1];
    at = at + s * (r * std::cos(angle)) + t * (r * std::sin(angle));
  } else if (light->type == LW_VIRTUAL_POLYGON) {
    // A fan from the first vertex: the triangle by its share of the area, with u used again inside of it.
    const Float3 origin = float3(light->vertices_m);
    const auto vertex = [&](uint32_t i) { return float3(light->vertices_m + size_t(i) * 3); };
    const auto twiceArea = [&](uint32_t i) {
      const Float3 c = cross(vertex(i - 1) - origin, vertex(i) - origin);
      return std::sqrt(dot(c, c));
    };
    float total = 0;
    for (uint32_t i = 2; i < light->vertex_count; ++i) total += twiceArea(i);
    float rest = std::clamp(uv[0], 0.0f, 1.0f) * total;
    uint32_t i = 2;
    for (; i + 1 < light->vertex_count && rest >= twiceArea(i); ++i) rest -= twiceArea(i);
    const float u = std::sqrt(std::clamp(rest / std::max(twiceArea(i), 1e-30f), 0.0f, 1.0f)), v = std::clamp(uv[1], 0.0f, 1.0f);
    at = origin + (vertex(i - 1) - origin) * (u * (1 - v)) + (vertex(i) - origin) * (u * v);
  }
  if (!std::isfinite(at.x) || !std::isfinite(at.y) || !std::isfinite(at.z)) at = float3(light->position_m);  // of a size beyond what floats can add up
  position_m[0] = at.x, position_m[1] = at.y, position_m[2] = at.z;
  return LW_OK;
}
