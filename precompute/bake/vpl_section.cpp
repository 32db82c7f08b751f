#include <algorithm>

#include "precompute/bake/sections.h"

namespace lightwell::bake {
namespace {

void append(const Vec3& v, double factor, std::vector<float>& values) {
  for (int k = 0; k < 3; ++k) values.push_back(float(double(v[k]) * factor));
}

}  // namespace

void addVplSection(format::Writer& writer, const VplResult& vpl, const scene::Scene& scene) {
  const double metres = scene.metres_per_unit;
  std::vector<uint8_t> type, bounce;
  std::vector<uint32_t> source, first_vertex{0};
  std::vector<float> position, normal, flux, radius, vertex;
  for (const transport::VirtualLight& light : vpl.lights) {
    type.push_back(uint8_t(light.type));
    source.push_back(light.source);
    bounce.push_back(uint8_t(std::min(light.bounce, 255u)));
    append(light.position, metres, position);
    append(light.normal, 1, normal);
    append(light.power_rgb, metres * metres, flux);
    radius.push_back(float(double(light.radius) * metres));
    for (const Vec3& v : light.vertices) append(v, metres, vertex);
    first_vertex.push_back(uint32_t(vertex.size() / 3));
  }
  const uint64_t lights = vpl.lights.size();
  v1::VplHeader header;
  header.set_lights(uint32_t(lights));
  header.set_vertices(first_vertex.back());
  const uint32_t of_sky = uint32_t(scene.lights.size()) + 1;
  header.set_sources(std::ranges::find(source, of_sky) == source.end() ? of_sky : of_sky + 1);
  header.set_points(vpl.points);
  writer.addSection("vpl");
  writer.addMessage("vpl", "header", header);
  writer.add("vpl", "type", type);
  writer.add("vpl", "source", source);
  writer.add("vpl", "bounce", bounce);
  writer.add("vpl", "position", position, {lights, 3});
  writer.add("vpl", "normal", normal, {lights, 3});
  writer.add("vpl", "flux", flux, {lights, 3});
  writer.add("vpl", "radius", radius);
  writer.add("vpl", "first_vertex", first_vertex);
  if (!vertex.empty()) writer.add("vpl", "vertex", vertex, {first_vertex.back(), 3});
}

}  // namespace lightwell::bake
