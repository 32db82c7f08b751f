// The section environment. docs/format.md has its table.
#include "precompute/bake/sections.h"

namespace lightwell::bake {
namespace {

template <class Vector>
std::vector<float> flat(const std::vector<Vector>& vectors) {
  std::vector<float> values;
  values.reserve(vectors.size() * 3);
  for (const auto& v : vectors)
    for (int i = 0; i < 3; ++i) values.push_back(v[i]);
  return values;
}

}  // namespace

void addEnvironmentSection(format::Writer& writer, const transport::Environment& environment, const plan::EnvironmentPlacement& placement) {
  const transport::EnvironmentCells& cells = environment.cells;
  const transport::EnvironmentSky& sky = environment.sky;
  v1::EnvironmentHeader header;
  header.set_cells(cells.count());
  header.set_suns(cells.sun_count);
  header.set_face_cells(sky.face_cells);
  header.set_node_scale(sky.scale);
  for (int c = 0; c < 3; ++c) header.add_sky_flux(sky.flux_rgb[c]);
  for (const Rgb& coefficient : sky.radiance_sh)
    for (int c = 0; c < 3; ++c) header.add_radiance_sh(coefficient[c]);
  header.set_rotation_deg(placement.rotation_deg);
  header.set_intensity(placement.intensity);
  if (placement.ground_radiance_rgb)
    for (const float v : *placement.ground_radiance_rgb) header.add_ground_radiance(v);

  const uint64_t count = cells.count(), side = uint64_t(sky.face_cells) + 1;
  std::vector<float> covariance;
  for (const auto& matrix : cells.covariance) covariance.insert(covariance.end(), matrix.begin(), matrix.end());
  writer.addSection("environment");
  writer.addMessage("environment", "header", header);
  writer.add("environment", "cell_direction", flat(cells.direction), {count, 3});
  writer.add("environment", "cell_flux", flat(cells.flux_rgb), {count, 3});
  writer.add("environment", "cell_solid_angle", cells.solid_angle_sr);
  writer.add("environment", "cell_spread", cells.spread);
  writer.add("environment", "cell_covariance", covariance, {count, 3});
  writer.add("environment", "node", sky.value, {6, side, side, 3}, format::ElementType::f16);
}

}  // namespace lightwell::bake
