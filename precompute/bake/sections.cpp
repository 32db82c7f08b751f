#include "precompute/bake/sections.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "format/decode/pixel.h"

namespace lightwell::bake {
namespace {

using format::ElementType;

template <class Repeated, class Vector>
void setVector(Repeated* field, const Vector& v) {
  for (int i = 0; i < 3; ++i) field->Add(v[i]);
}

std::vector<float> toMetres(const std::vector<Vec3>& positions, double metres_per_unit) {
  std::vector<float> metres;
  metres.reserve(positions.size() * 3);
  for (const auto& p : positions)
    for (int i = 0; i < 3; ++i) metres.push_back(float(p[i] * metres_per_unit));
  return metres;
}

std::vector<int16_t> toOctahedral(const std::vector<Vec3>& normals) {
  std::vector<int16_t> packed;
  packed.reserve(normals.size() * 2);
  for (const auto& n : normals) {
    const auto oct = format::packOct({n.x, n.y, n.z});
    packed.push_back(oct.x);
    packed.push_back(oct.y);
  }
  return packed;
}

uint32_t toRgb9e5(const Rgb& c) { return format::packRgb9e5({c.x, c.y, c.z}); }
std::vector<uint32_t> toRgb9e5(const std::vector<Rgb>& colors) {
  std::vector<uint32_t> packed(colors.size());
  std::transform(colors.begin(), colors.end(), packed.begin(), [](const Rgb& c) { return toRgb9e5(c); });
  return packed;
}

/// A power of two that brings the brightest value to 2^14 to 2^15: a sky may have a sun of 100,000 lux, more than RGB9E5 can hold.
float skyScale(const SkyPanes& sky) {
  float largest = 0;
  for (const auto* pane : {&sky.direct_rgb, &sky.indirect_rgb})
    for (const Rgb& c : *pane) largest = std::max(largest, maxComponent(c));
  return largest > 0 ? std::exp2(std::clamp(std::floor(std::log2(largest)) - 14, -60.0f, 60.0f)) : 1.0f;
}

std::vector<Rgb> scaled(std::vector<Rgb> colors, float factor) {
  for (Rgb& c : colors) c *= factor;
  return colors;
}

void addPanes(format::Writer& writer, const transport::PrmResult& prm) {
  writer.add("prm", "pane", toRgb9e5(prm.panes.irradiance_rgb), {prm.entries.clusterCount(), prm.texel.size()}, ElementType::rgb9e5);
}

/// How the rectangles lie: half their sides in metres, and the turn of the first about the normal in half turns from orthonormalBasis()'s tangent.
std::vector<uint16_t> packRectangles(const transport::PrmEntries& entries, double metres_per_unit) {
  std::vector<uint16_t> packed;
  for (size_t i = 0; i < entries.position.size(); ++i) {
    Vec3 tangent, bitangent;
    const auto n = format::unpackOct(format::packOct({entries.normal[i].x, entries.normal[i].y, entries.normal[i].z}));
    orthonormalBasis(Vec3(n.x, n.y, n.z), tangent, bitangent);
    const Vec3 &u = entries.half_u[i], &v = entries.half_v[i];
    for (const double number : {u.length() * metres_per_unit, v.length() * metres_per_unit,
                                std::atan2(double(u.dot(bitangent)), double(u.dot(tangent))) / kPi})
      packed.push_back(format::packHalf(std::clamp(float(number), -65504.0f, 65504.0f)));
  }
  return packed;
}

/// Per block [rank][channel][link], the channels as G, R − G, B − G (modulo 256): what is near to zero stands together.
std::vector<int8_t> packCoefficients(const transport::PrmBlocks& bases) {
  std::vector<int8_t> packed(bases.coefficient.size());
  size_t base = 0;
  for (size_t b = 0; b < bases.block_rank.size(); ++b) {
    const size_t links = bases.block_first_link[b + 1] - bases.block_first_link[b], rank = bases.block_rank[b];
    for (size_t l = 0; l < links; ++l)
      for (size_t k = 0; k < rank; ++k) {
        const int8_t* rgb = &bases.coefficient[base + (l * rank + k) * 3];
        int8_t* to = &packed[base + k * 3 * links + l];
        to[0] = rgb[1];
        to[links] = int8_t(rgb[0] - rgb[1]);
        to[2 * links] = int8_t(rgb[2] - rgb[1]);
      }
    base += links * rank * 3;
  }
  return packed;
}

void addBlocks(format::Writer& writer, const char* section, const transport::PrmBlocks& blocks) {
  writer.add(section, "block_rank", blocks.block_rank);
  writer.add(section, "basis", blocks.basis);
  writer.add(section, "coefficient_scale", blocks.scale);
  writer.add(section, "block_first_link", blocks.block_first_link);
  writer.add(section, "link_wavelet", blocks.link_wavelet);
  writer.add(section, "coefficient", packCoefficients(blocks));
}

void addLocalBases(format::Writer& writer, const transport::PrmResult& prm, double metres_per_unit) {
  const transport::PrmLocalBases& bases = prm.bases;
  writer.add("prm", "entry_rectangle", packRectangles(prm.entries, metres_per_unit), {prm.entries.position.size(), 3}, ElementType::f16);
  writer.add("prm", "tree_first_leaves", bases.tree.first_leaves);
  writer.add("prm", "tree_first_share", bases.tree.first_share);
  writer.add("prm", "wavelet_unit", bases.wavelet_unit);
  writer.add("prm", "block_first_texel", bases.block_first_texel);
  addBlocks(writer, "prm", bases);
}

}  // namespace

void addSceneSection(format::Writer& writer, const scene::Scene& scene) {
  const double metres = scene.metres_per_unit;
  v1::SceneHeader header;
  setVector(header.mutable_origin(), scene.origin_m);
  if (!scene.mesh.triangles.empty()) {
    setVector(header.mutable_bounds_min(), Vec3(Vec3d(scene.bounds.min) * metres));
    setVector(header.mutable_bounds_max(), Vec3(Vec3d(scene.bounds.max) * metres));
  } else {
    setVector(header.mutable_bounds_min(), Vec3(0.0f));
    setVector(header.mutable_bounds_max(), Vec3(0.0f));
  }
  for (const auto& light : scene.lights) {
    const bool directional = light.type == scene::LightType::directional;
    v1::Light* out = header.add_lights();
    out->set_type(directional                            ? v1::LIGHT_TYPE_DIRECTIONAL
                  : light.type == scene::LightType::spot ? v1::LIGHT_TYPE_SPOT
                                                         : v1::LIGHT_TYPE_POINT);
    out->set_name(light.name);
    setVector(out->mutable_position(), directional ? Vec3(0.0f) : Vec3(Vec3d(light.position) * metres));
    setVector(out->mutable_direction(), light.direction);
    setVector(out->mutable_intensity(), directional ? light.intensity : Vec3(Vec3d(light.intensity) * (metres * metres)));
    if (light.type == scene::LightType::spot) {
      out->set_inner_cone_angle(light.inner_cone_angle);
      out->set_outer_cone_angle(light.outer_cone_angle);
    }
    if (!directional) out->set_range(float(light.range * metres));
  }
  writer.addSection("scene");
  writer.addMessage("scene", "header", header);
}

void addAtlasSection(format::Writer& writer, const atlas::Atlas& atlas) {
  const uint64_t width = atlas.width, height = atlas.height;
  v1::AtlasHeader header;
  header.set_width(atlas.width);
  header.set_height(atlas.height);
  header.set_covered_texels(uint32_t(atlas.slots.size()));
  header.set_charts(atlas.chart_count);
  header.set_unwrapped(atlas.unwrapped);
  std::vector<uint8_t> coverage(width * height, 0), albedo(width * height * 3, 0);
  std::vector<uint32_t> emission(width * height, 0);
  bool emits = false;
  for (size_t texel = 0; texel < width * height; ++texel) {
    coverage[texel] = atlas.texel_slot[texel] != kNone;
    const uint32_t source = atlas.source[texel];
    if (source == kNone) continue;
    const atlas::Slot& slot = atlas.slots[atlas.texel_slot[source]];
    for (int i = 0; i < 3; ++i) albedo[texel * 3 + i] = format::encodeSrgb(slot.albedo_rgb[i]);
    emission[texel] = toRgb9e5(slot.emitted_radiance_rgb);
    emits |= emission[texel] != 0;
  }
  writer.addSection("atlas");
  writer.addMessage("atlas", "header", header);
  writer.add("atlas", "source", atlas.source, {height, width});
  writer.add("atlas", "coverage", coverage, {height, width});
  writer.add("atlas", "albedo", albedo, {height, width, 3});
  if (emits) writer.add("atlas", "emission", emission, {height, width}, ElementType::rgb9e5);
}

void addPrmSection(format::Writer& writer, const transport::PrmResult& prm, const SkyPanes& sky, double metres_per_unit) {
  const bool bases = !prm.bases.block_rank.empty();
  const bool emitters = !prm.emitter_direct_rgb.empty();
  v1::PrmHeader header;
  header.set_layout(bases ? v1::PRM_LAYOUT_LOCAL_BASES : v1::PRM_LAYOUT_PANES);
  header.set_entries(uint32_t(prm.entries.position.size()));
  header.set_clusters(prm.entries.clusterCount());
  header.set_texels(uint32_t(prm.texel.size()));
  if (bases) {
    header.set_blocks(uint32_t(prm.bases.block_rank.size()));
    // Where nothing is reflected no block has a rank.
    header.set_max_rank(std::max<uint32_t>(1, *std::max_element(prm.bases.block_rank.begin(), prm.bases.block_rank.end())));
  }
  header.set_has_emitter(emitters);
  const bool has_sky = !sky.direct_rgb.empty();
  const float sky_scale = has_sky ? skyScale(sky) : 0;
  header.set_has_sky(has_sky);
  header.set_sky_scale(sky_scale);
  const uint64_t entries = prm.entries.position.size();
  writer.addSection("prm");
  writer.addMessage("prm", "header", header);
  writer.add("prm", "entry_position", toMetres(prm.entries.position, metres_per_unit), {entries, 3});
  writer.add("prm", "entry_normal", toOctahedral(prm.entries.normal), {entries, 2});
  writer.add("prm", "entry_weight", prm.entries.weight);
  writer.add("prm", "cluster_first_entry", prm.entries.cluster_first_entry);
  writer.add("prm", "texel", prm.texel);
  if (bases)
    addLocalBases(writer, prm, metres_per_unit);
  else
    addPanes(writer, prm);
  if (emitters) {
    writer.add("prm", "emitter_direct", toRgb9e5(prm.emitter_direct_rgb), {}, ElementType::rgb9e5);
    writer.add("prm", "emitter_indirect", toRgb9e5(prm.emitter_indirect_rgb), {}, ElementType::rgb9e5);
  }
  if (has_sky) {
    writer.add("prm", "sky_direct", toRgb9e5(scaled(sky.direct_rgb, 1 / sky_scale)), {}, ElementType::rgb9e5);
    writer.add("prm", "sky_indirect", toRgb9e5(scaled(sky.indirect_rgb, 1 / sky_scale)), {}, ElementType::rgb9e5);
  }
}

void addPrmProbesSection(format::Writer& writer, const transport::PrmProbes& probes, double metres_per_unit) {
  const uint64_t count = probes.position.size();
  v1::PrmProbesHeader header;
  header.set_probes(uint32_t(count));
  header.set_max_rank(*std::max_element(probes.block_rank.begin(), probes.block_rank.end()));
  header.set_has_emitter(!probes.emitter_radiance_sh.empty());
  writer.addSection("prm_probes");
  writer.addMessage("prm_probes", "header", header);
  writer.add("prm_probes", "position", toMetres(probes.position, metres_per_unit), {count, 3});
  addBlocks(writer, "prm_probes", probes);
  if (!header.has_emitter()) return;
  std::vector<uint16_t> halves;
  for (const auto& sh : probes.emitter_radiance_sh)
    for (const Rgb& coefficient : sh)
      for (int channel = 0; channel < 3; ++channel) halves.push_back(format::packHalf(std::clamp(coefficient[channel], -65504.0f, 65504.0f)));
  writer.add("prm_probes", "emitter", halves, {count, 9, 3}, ElementType::f16);
}

void addMetaSection(format::Writer& writer, const v1::MetaHeader& header) {
  writer.addSection("meta", 1, false);
  writer.addMessage("meta", "header", header);
}

}  // namespace lightwell::bake
