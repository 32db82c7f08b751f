#include "tests/format/content.h"

#include "format/decode/pixel.h"

namespace lightwell::format {
namespace {

constexpr uint32_t kNone = 0xffffffffu;

void setVector(google::protobuf::RepeatedField<float>* field, std::initializer_list<float> values) {
  field->Clear();
  for (const float v : values) field->Add(v);
}

std::vector<uint32_t> packAll(size_t count, float step) {
  std::vector<uint32_t> packed(count);
  for (size_t i = 0; i < count; ++i) packed[i] = packRgb9e5({step * float(i), step * 0.5f * float(i), step * 0.25f});
  return packed;
}

Content commonContent() {
  Content c;
  c.meta.mutable_provenance()->set_tool_version("0.1.0");
  c.meta.mutable_provenance()->set_scene_name("two triangles.glb");
  c.meta.mutable_provenance()->set_scene_hash(0x0123456789abcdefu);
  c.meta.mutable_provenance()->set_settings_json(R"({"seed":1})");
  v1::Omitted& omitted = *c.meta.add_omitted();
  omitted.set_type("environment");
  omitted.set_reason("the scene has no sky");
  v1::MeasuredError& error = *c.meta.add_errors();
  error.set_section("prm");
  error.set_relrmse(0.03);
  error.set_texrel(0.04);
  error.set_bias(-0.001);
  error.set_against("a path-traced reference of 1024 samples");

  for (const double v : {10.0, 0.0, -2.5}) c.scene.add_origin(v);
  setVector(c.scene.mutable_bounds_min(), {0, 0, 0});
  setVector(c.scene.mutable_bounds_max(), {1, 0, 1});
  v1::Light& lamp = *c.scene.add_lights();
  lamp.set_type(v1::LIGHT_TYPE_SPOT);
  lamp.set_name("lamp");
  setVector(lamp.mutable_position(), {0.5f, 1, 0.5f});
  setVector(lamp.mutable_direction(), {0, -1, 0});
  setVector(lamp.mutable_intensity(), {100, 90, 80});
  lamp.set_inner_cone_angle(0.25f);
  lamp.set_outer_cone_angle(0.5f);

  c.position = {0, 0, 0, 0, 0, 1, 1, 0, 1, 1, 0, 0};
  c.normal = {0, 32767, 0, 32767, 0, 32767, 0, 32767};
  c.lightmap_uv = {0, 0, 0, 0.25f, 1, 0.25f, 1, 0};
  c.index = {0, 1, 2, 0, 2, 3};
  c.triangle_flags = {0, 3};
  c.alpha_uv = {0, 0, 0, 1, 1, 1, 1, 0};
  c.triangle_alpha = {0xffff, 0};
  v1::AlphaMaterial& leaf = *c.alpha_material.add_materials();
  leaf.set_mode(v1::ALPHA_MODE_MASK);
  leaf.set_cutoff(0.5f);
  leaf.set_factor(1);
  leaf.set_texture(0);
  leaf.set_wrap_u(v1::WRAP_MODE_REPEAT);
  leaf.set_wrap_v(v1::WRAP_MODE_CLAMP);
  c.alpha_texture = {0, 255, 255, 0};

  c.atlas.set_width(4);
  c.atlas.set_height(4);
  c.atlas.set_covered_texels(4);
  c.atlas.set_charts(1);
  c.source = {0, 1, 2, 2, 0, 1, 2, 2, kNone, kNone, kNone, kNone, kNone, kNone, kNone, kNone};
  c.coverage = {1, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  c.albedo.assign(48, 0);
  std::fill(c.albedo.begin(), c.albedo.begin() + 24, uint8_t(188));
  c.emission.assign(16, 0);
  c.emission[1] = packRgb9e5({4, 2, 1});

  c.prm.set_entries(3);
  c.prm.set_clusters(2);
  c.prm.set_texels(3);
  c.prm.set_has_emitter(true);
  c.entry_position = {0.25f, 0, 0.25f, 0.5f, 0, 0.75f, 0.75f, 0, 0.5f};
  c.entry_normal = {0, 32767, 0, 32767, 0, 32767};
  c.entry_weight = {0.75f, 0.25f, 1};
  c.cluster_first_entry = {0, 2, 3};
  c.texel = {0, 1, 2};
  c.emitter_direct = packAll(3, 0.5f);
  c.emitter_indirect = packAll(3, 0.125f);
  return c;
}

}  // namespace

Content panesContent() {
  Content c = commonContent();
  c.prm.set_layout(v1::PRM_LAYOUT_PANES);
  c.prm.set_brightest(1);
  c.pane = packAll(6, 0.0625f);
  return c;
}

Content skyPanesContent() {
  Content c = panesContent();
  c.prm.set_has_sky(true);
  c.prm.set_sky_scale(8);
  c.sky_direct = packAll(3, 2000);
  c.sky_indirect = packAll(3, 500);
  return c;
}

Content localBasesContent() {
  Content c = commonContent();
  c.prm.set_layout(v1::PRM_LAYOUT_LOCAL_BASES);
  c.prm.set_entries(4);
  c.prm.set_clusters(3);
  c.prm.set_blocks(2);
  c.prm.set_max_rank(2);
  c.entry_position.insert(c.entry_position.end(), {0.25f, 0, 0.75f});
  c.entry_normal.insert(c.entry_normal.end(), {0, 32767});
  c.entry_weight.push_back(1);
  c.cluster_first_entry.push_back(4);
  for (const float number : {0.25f, 0.5f, 0.0f, 0.25f, 0.25f, -0.75f, 0.0f, 0.0f, 0.0f, 2.0f, 0.125f, 1.0f})
    c.entry_rectangle.push_back(packHalf(number));
  c.tree_first_leaves = {2, 1};
  c.tree_first_share = {0x8000, 0xffff};
  c.wavelet_unit = {160, 168, 152, 0, 161, 255, 1};
  c.block_first_texel = {0, 2, 3};
  c.block_rank = {2, 1};
  c.basis = {127, -3, 90, 40, 127};
  c.block_first_link = {0, 3, 4};
  c.link_wavelet = {1, 1, 5, 6};
  c.coefficient_scale = {0.5f, 0.25f, 1, 2, 0.125f, 4, 1, 0, 0.75f};
  c.coefficient = {127, 1, 2, 3, 4, -5, 6, 7, 8, 9, -128, 11, 12, 13, 14, 15, 16, 17, -1, 0, 1};
  return c;
}

Writer toWriter(const Content& c) {
  Writer writer;
  const auto wanted = [&](const char* section, const char* name) {
    return !c.left_out.contains(section) && !c.left_out.contains(std::string(section) + "/" + name);
  };
  const auto section = [&](const char* type, bool required) {
    if (!c.left_out.contains(type)) writer.addSection(type, 1, required);
  };
  const auto message = [&](const char* type, const char* name, const google::protobuf::MessageLite& value) {
    if (wanted(type, name)) writer.addMessage(type, name, value);
  };
  const auto array = [&]<class T>(const char* type, const char* name, const std::vector<T>& values,
                                  std::initializer_list<uint64_t> shape = {}, ElementType element = detail::elementTypeOf<T>()) {
    if (wanted(type, name)) writer.add(type, name, values, shape, element);
  };
  const uint64_t vertices = c.position.size() / 3;

  section("meta", false);
  message("meta", "header", c.meta);
  section("scene", true);
  message("scene", "header", c.scene);
  section("geometry", true);
  array("geometry", "position", c.position, {vertices, 3});
  array("geometry", "normal", c.normal, {c.normal.size() / 2, 2});
  array("geometry", "lightmap_uv", c.lightmap_uv, {c.lightmap_uv.size() / 2, 2});
  array("geometry", "index", c.index, {c.index.size() / 3, 3});
  array("geometry", "triangle_flags", c.triangle_flags);
  array("geometry", "alpha_uv", c.alpha_uv, {c.alpha_uv.size() / 2, 2});
  array("geometry", "triangle_alpha", c.triangle_alpha);
  message("geometry", "alpha_material", c.alpha_material);
  array("geometry", "alpha_texture_0", c.alpha_texture, {2, 2});
  section("atlas", true);
  message("atlas", "header", c.atlas);
  const uint64_t width = c.atlas_width, height = c.source.size() / width;
  array("atlas", "source", c.source, {height, width});
  array("atlas", "coverage", c.coverage, {height, width});
  array("atlas", "albedo", c.albedo, {height, width, 3});
  array("atlas", "emission", c.emission, {height, width}, ElementType::rgb9e5);
  section("prm", true);
  message("prm", "header", c.prm);
  array("prm", "entry_position", c.entry_position, {c.entry_position.size() / 3, 3});
  array("prm", "entry_normal", c.entry_normal, {c.entry_normal.size() / 2, 2});
  array("prm", "entry_weight", c.entry_weight);
  array("prm", "cluster_first_entry", c.cluster_first_entry);
  array("prm", "texel", c.texel);
  if (c.prm.layout() == v1::PRM_LAYOUT_LOCAL_BASES) {
    array("prm", "entry_rectangle", c.entry_rectangle, {c.entry_rectangle.size() / 3, 3}, ElementType::f16);
    array("prm", "tree_first_leaves", c.tree_first_leaves);
    array("prm", "tree_first_share", c.tree_first_share);
    array("prm", "wavelet_unit", c.wavelet_unit);
    array("prm", "block_first_texel", c.block_first_texel);
    array("prm", "block_rank", c.block_rank);
    array("prm", "basis", c.basis);
    array("prm", "block_first_link", c.block_first_link);
    array("prm", "link_wavelet", c.link_wavelet);
    array("prm", "coefficient_scale", c.coefficient_scale);
    array("prm", "coefficient", c.coefficient);
  } else if (!c.pane_half.empty()) {
    array("prm", "pane", c.pane_half, {c.prm.clusters(), c.texel.size(), 3}, ElementType::f16);
  } else {
    array("prm", "pane", c.pane, {c.prm.clusters(), c.texel.size()}, ElementType::rgb9e5);
  }
  array("prm", "emitter_direct", c.emitter_direct, {}, ElementType::rgb9e5);
  array("prm", "emitter_indirect", c.emitter_indirect, {}, ElementType::rgb9e5);
  if (!c.sky_direct.empty()) array("prm", "sky_direct", c.sky_direct, {}, ElementType::rgb9e5);
  if (!c.sky_indirect.empty()) array("prm", "sky_indirect", c.sky_indirect, {}, ElementType::rgb9e5);
  return writer;
}

}  // namespace lightwell::format
