#include "tests/render/stage.h"

#include <array>

#include "format/decode/pixel.h"
#include "format/encode/writer.h"
#include "lightwell/v1/container.pb.h"
#include "precompute/bake/sections.h"
#include "precompute/transport/environment/bake_environment.h"

namespace lightwell::test {
namespace {

constexpr uint32_t kAtlas = 4;  // texels per side

void addQuad(std::vector<float>& positions, std::vector<float>& uvs, float half, float y) {
  for (const auto [x, z] : {std::array{-1, 1}, {1, 1}, {1, -1}, {-1, -1}}) {
    positions.insert(positions.end(), {float(x) * half, y, float(z) * half});
    uvs.insert(uvs.end(), {0.5f + 0.4f * float(x), 0.5f + 0.4f * float(z)});
  }
}

void addTransport(format::Writer& writer) {
  writer.addSection("prm");
  v1::PrmHeader header;
  header.set_layout(v1::PRM_LAYOUT_PANES);
  header.set_entries(1);
  header.set_clusters(1);
  header.set_texels(kAtlas * kAtlas);
  writer.addMessage("prm", "header", header);
  const format::Oct16 up = format::packOct({0, 1, 0});
  std::vector<uint32_t> texel(kAtlas * kAtlas);
  for (uint32_t i = 0; i < texel.size(); ++i) texel[i] = i;
  writer.add("prm", "entry_position", std::span<const float>(kEntry), {1, 3});
  writer.add("prm", "entry_normal", std::vector<int16_t>{up.x, up.y}, {1, 2});
  writer.add("prm", "entry_weight", std::vector<float>{1});
  writer.add("prm", "cluster_first_entry", std::vector<uint32_t>{0, 1});
  writer.add("prm", "texel", texel);
  const std::vector<uint32_t> pane(texel.size(), format::packRgb9e5({kTransport, kTransport, kTransport}));
  writer.add("prm", "pane", pane, {1, texel.size()}, format::ElementType::rgb9e5);
}

void addSky(format::Writer& writer) {
  transport::EnvironmentMap map(transport::memoryRowSource(64, 32, std::vector<Rgb>(64 * 32, Rgb(1, 1, 1))), "sky");
  Diagnostics diagnostics;
  transport::EnvironmentSettings settings;
  settings.decomposition.samples = 200;
  settings.sky_face_cells = 16;
  bake::addEnvironmentSection(writer, transport::bakeEnvironment(map, settings, diagnostics, nullptr), {});
}

}  // namespace

std::vector<uint8_t> makeStage(bool with_transport, double origin_x_m, bool with_sky) {
  format::Writer writer;
  writer.addSection("scene");
  v1::SceneHeader scene;
  for (const double value : {origin_x_m, 0.0, 0.0}) scene.add_origin(value);
  for (const float value : {-kFloorHalf, 0.0f, -kFloorHalf}) scene.add_bounds_min(value);
  for (const float value : {kFloorHalf, kPlateHeight, kFloorHalf}) scene.add_bounds_max(value);
  writer.addMessage("scene", "header", scene);

  std::vector<float> positions, uvs;
  addQuad(positions, uvs, kFloorHalf, 0);
  addQuad(positions, uvs, kPlateHalf, kPlateHeight);
  const format::Oct16 up = format::packOct({0, 1, 0});
  std::vector<int16_t> normals;
  for (int i = 0; i < 8; ++i) normals.insert(normals.end(), {up.x, up.y});
  writer.addSection("geometry");
  writer.add("geometry", "position", positions, {8, 3});
  writer.add("geometry", "normal", normals, {8, 2});
  writer.add("geometry", "lightmap_uv", uvs, {8, 2});
  writer.add("geometry", "index", std::vector<uint32_t>{0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7}, {4, 3});
  writer.add("geometry", "triangle_flags", std::vector<uint8_t>{0, 0, 1, 1});

  v1::AtlasHeader atlas;
  atlas.set_width(kAtlas);
  atlas.set_height(kAtlas);
  atlas.set_covered_texels(kAtlas * kAtlas);
  atlas.set_charts(1);
  std::vector<uint32_t> source(kAtlas * kAtlas);
  for (uint32_t i = 0; i < source.size(); ++i) source[i] = i;
  writer.addSection("atlas");
  writer.addMessage("atlas", "header", atlas);
  writer.add("atlas", "source", source, {kAtlas, kAtlas});
  writer.add("atlas", "coverage", std::vector<uint8_t>(source.size(), 1), {kAtlas, kAtlas});
  writer.add("atlas", "albedo", std::vector<uint8_t>(source.size() * 3, 255), {kAtlas, kAtlas, 3});
  if (with_transport) addTransport(writer);
  if (with_sky) addSky(writer);
  return writer.bytes();
}

}  // namespace lightwell::test
