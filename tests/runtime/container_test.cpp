// Opening, queries and decoding, of sound and of damaged containers.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "format/decode/pixel.h"
#include "format/decode/status.h"
#include "format/encode/writer.h"
#include "lightwell/v1/container.pb.h"
#include "tests/runtime/support.h"
#include "tests/runtime/synthetic_prm.h"

namespace lightwell::test {
namespace {

/// A quad with a cut-out triangle, an emitting texel, and a scene with two lights.
std::vector<uint8_t> quadContainer() {
  format::Writer writer;
  v1::SceneHeader scene;
  for (const double v : {1e6, 2.0, 3.0}) scene.add_origin(v);
  for (const float v : {0.0f, 0.0f, -1.0f}) scene.add_bounds_min(v);
  for (const float v : {1.0f, 0.0f, 0.0f}) scene.add_bounds_max(v);
  for (int i = 0; i < 2; ++i) {
    v1::Light& light = *scene.add_lights();
    light.set_type(i ? v1::LIGHT_TYPE_SPOT : v1::LIGHT_TYPE_POINT);
    light.set_name("lamp");
    for (const float v : {0.5f, 2.0f, float(i)}) light.add_position(v);
    for (const float v : {0.0f, -1.0f, 0.0f}) light.add_direction(v);
    for (const float v : {10.0f, 20.0f, 30.0f}) light.add_intensity(v);
    light.set_inner_cone_angle(0.1f);
    light.set_outer_cone_angle(0.5f);
    light.set_range(7);
  }
  writer.addSection("scene");
  writer.addMessage("scene", "header", scene);
  writer.addSection("geometry");
  writer.add("geometry", "position", std::vector<float>{0, 0, 0, 1, 0, 0, 1, 0, -1, 0, 0, -1}, {4, 3});
  std::vector<int16_t> normal;
  for (int i = 0; i < 4; ++i) {
    const format::Oct16 up = format::packOct({0, 1, 0});
    normal.insert(normal.end(), {up.x, up.y});
  }
  writer.add("geometry", "normal", normal, {4, 2});
  writer.add("geometry", "lightmap_uv", std::vector<float>{0, 0, 1, 0, 1, 1, 0, 1}, {4, 2});
  writer.add("geometry", "index", std::vector<uint32_t>{0, 1, 2, 0, 2, 3}, {2, 3});
  writer.add("geometry", "triangle_flags", std::vector<uint8_t>{1, 3});
  writer.add("geometry", "alpha_uv", std::vector<float>{0, 0, 2, 0, 2, 2, 0, 2}, {4, 2});
  writer.add("geometry", "triangle_alpha", std::vector<uint16_t>{0xffff, 0});
  v1::AlphaMaterials materials;
  v1::AlphaMaterial& leaf = *materials.add_materials();
  leaf.set_mode(v1::ALPHA_MODE_MASK);
  leaf.set_cutoff(0.5f);
  leaf.set_factor(0.75f);
  leaf.set_texture(0);
  leaf.set_wrap_u(v1::WRAP_MODE_REPEAT);
  leaf.set_wrap_v(v1::WRAP_MODE_MIRROR);
  writer.addMessage("geometry", "alpha_material", materials);
  writer.add("geometry", "alpha_texture_0", std::vector<uint8_t>{0, 50, 100, 150, 200, 250}, {2, 3});
  v1::AtlasHeader atlas;
  atlas.set_width(3);
  atlas.set_height(2);
  atlas.set_covered_texels(4);
  atlas.set_charts(1);
  atlas.set_unwrapped(true);
  writer.addSection("atlas");
  writer.addMessage("atlas", "header", atlas);
  writer.add("atlas", "source", std::vector<uint32_t>{0, 1, 1, 3, 4, 0xffffffffu}, {2, 3});
  writer.add("atlas", "coverage", std::vector<uint8_t>{1, 1, 0, 1, 1, 0}, {2, 3});
  writer.add("atlas", "albedo", std::vector<uint8_t>(18, 200), {2, 3, 3});
  std::vector<uint32_t> emission(6, 0);
  emission[4] = format::packRgb9e5({1, 2, 4});
  writer.add("atlas", "emission", emission, {2, 3}, format::ElementType::rgb9e5);
  return writer.bytes();
}

template <class T>
std::vector<T> decode(const lw_container* container, lw_array array, uint64_t elements, uint32_t components) {
  lw_array_info info{};
  EXPECT_EQ(lw_get_array_info(container, array, &info), LW_OK);
  EXPECT_EQ(info.elements, elements);
  EXPECT_EQ(info.components, components);
  EXPECT_EQ(info.component_bytes, sizeof(T));
  std::vector<T> values(info.bytes / sizeof(T));
  EXPECT_EQ(lw_decode_array(container, array, values.data(), info.bytes), LW_OK);
  EXPECT_EQ(lw_decode_array(container, array, values.data(), info.bytes - 1), LW_INVALID_ARGUMENT);
  return values;
}

TEST(Container, TellsWhatIsInside) {
  const auto bytes = quadContainer();
  const Container container = openMemory(bytes);
  lw_scene_info scene{};
  ASSERT_EQ(lw_get_scene_info(container.get(), &scene), LW_OK);
  EXPECT_EQ(scene.origin_m[0], 1e6);
  EXPECT_EQ(scene.bounds_min_m[2], -1);
  EXPECT_EQ(scene.light_count, 2u);
  lw_light light{};
  ASSERT_EQ(lw_get_light(container.get(), 1, &light), LW_OK);
  EXPECT_EQ(light.type, uint32_t(LW_LIGHT_SPOT));
  EXPECT_THAT(light.position_m, testing::ElementsAre(0.5f, 2.0f, 1.0f));
  EXPECT_THAT(light.intensity_rgb, testing::ElementsAre(10, 20, 30));
  EXPECT_EQ(light.range_m, 7);
  EXPECT_EQ(lw_get_light(container.get(), 2, &light), LW_NOT_FOUND);
  lw_atlas_info atlas{};
  ASSERT_EQ(lw_get_atlas_info(container.get(), &atlas), LW_OK);
  EXPECT_EQ(atlas.width, 3u);
  EXPECT_EQ(atlas.height, 2u);
  EXPECT_EQ(atlas.covered_texels, 4u);
  EXPECT_EQ(atlas.unwrapped, 1u);
  EXPECT_EQ(lw_has_section(container.get(), "geometry"), 1);
  EXPECT_EQ(lw_has_section(container.get(), "prm"), 0);
  lw_prm* prm = nullptr;
  EXPECT_EQ(lw_prm_load(container.get(), &prm), LW_NOT_FOUND);
}

TEST(Container, DecodesEveryArray) {
  const auto bytes = quadContainer();
  const Container container = openMemory(bytes);
  const lw_container* c = container.get();
  EXPECT_EQ(decode<float>(c, LW_ARRAY_POSITION, 4, 3)[8], -1.0f);
  const auto normal = decode<float>(c, LW_ARRAY_NORMAL, 4, 3);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(normal[i * 3 + 1], 1.0f, 1e-6f);
  EXPECT_EQ(decode<float>(c, LW_ARRAY_LIGHTMAP_UV, 4, 2)[5], 1.0f);
  EXPECT_THAT(decode<uint32_t>(c, LW_ARRAY_INDEX, 2, 3), testing::ElementsAre(0, 1, 2, 0, 2, 3));
  EXPECT_THAT(decode<uint8_t>(c, LW_ARRAY_TRIANGLE_FLAGS, 2, 1), testing::ElementsAre(1, 3));
  EXPECT_EQ(decode<float>(c, LW_ARRAY_ALPHA_UV, 4, 2)[2], 2.0f);
  EXPECT_THAT(decode<uint16_t>(c, LW_ARRAY_TRIANGLE_ALPHA, 2, 1), testing::ElementsAre(0xffff, 0));
  EXPECT_THAT(decode<uint32_t>(c, LW_ARRAY_ATLAS_SOURCE, 6, 1), testing::ElementsAre(0, 1, 1, 3, 4, 0xffffffffu));
  EXPECT_THAT(decode<uint8_t>(c, LW_ARRAY_ATLAS_COVERAGE, 6, 1), testing::ElementsAre(1, 1, 0, 1, 1, 0));
  EXPECT_EQ(decode<uint8_t>(c, LW_ARRAY_ATLAS_ALBEDO, 6, 3)[17], 200);
  const auto emission = decode<float>(c, LW_ARRAY_ATLAS_EMISSION, 6, 3);
  EXPECT_THAT(std::vector<float>(emission.begin() + 12, emission.begin() + 15), testing::ElementsAre(1, 2, 4));
  EXPECT_EQ(emission[0], 0.0f);

  lw_alpha_material leaf{};
  ASSERT_EQ(lw_get_alpha_material(c, 0, &leaf), LW_OK);
  EXPECT_EQ(leaf.mode, uint32_t(LW_ALPHA_MASK));
  EXPECT_EQ(leaf.factor, 0.75f);
  EXPECT_EQ(leaf.wrap_v, uint32_t(LW_WRAP_MIRROR));
  EXPECT_EQ(leaf.texture_width, 3u);
  EXPECT_EQ(leaf.texture_height, 2u);
  uint8_t alpha[6] = {};
  ASSERT_EQ(lw_decode_alpha_texture(c, uint32_t(leaf.texture), alpha, sizeof alpha), LW_OK);
  EXPECT_EQ(alpha[5], 250);
  EXPECT_EQ(lw_get_alpha_material(c, 1, &leaf), LW_NOT_FOUND);
  lw_alpha_material all[2];
  ASSERT_EQ(lw_get_alpha_materials(c, 1, all), LW_OK);
  EXPECT_EQ(std::memcmp(all, &leaf, sizeof leaf), 0);
  EXPECT_EQ(lw_get_alpha_materials(c, 0, nullptr), LW_OK);
  EXPECT_EQ(lw_get_alpha_materials(c, 2, all), LW_NOT_FOUND);
  EXPECT_EQ(lw_decode_alpha_texture(c, 1, alpha, sizeof alpha), LW_NOT_FOUND);
}

TEST(Container, OpensFromFileAndCallbacks) {
  const auto bytes = quadContainer();
  const auto file = std::filesystem::path(testing::TempDir()) / "lightwell_runtime_container.lwc";
  std::ofstream(file, std::ios::binary).write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
  lw_container* container = nullptr;
  ASSERT_EQ(lw_open_file(file.c_str(), nullptr, &container), LW_OK);
  EXPECT_EQ(decode<uint32_t>(container, LW_ARRAY_INDEX, 2, 3)[5], 3u);
  lw_close(container);
  std::filesystem::remove(file);
  Host host;
  const lw_config config = host.config();
  EXPECT_EQ(lw_open_file(file.c_str(), &config, &container), LW_IO_ERROR);
  EXPECT_THAT(host.message, testing::HasSubstr("lightwell_runtime_container.lwc"));

  struct Memory {
    const std::vector<uint8_t>* bytes;
    int reads_left;
  } memory{&bytes, 1000};
  lw_reader reader{};
  reader.read = [](void* user, uint64_t offset, void* destination, size_t count) {
    auto& m = *static_cast<Memory*>(user);
    if (m.reads_left-- <= 0 || offset > m.bytes->size() || count > m.bytes->size() - offset) return 1;
    std::memcpy(destination, m.bytes->data() + offset, count);
    return 0;
  };
  reader.user = &memory;
  reader.file_bytes = bytes.size();
  ASSERT_EQ(lw_open_reader(&reader, nullptr, &container), LW_OK);
  EXPECT_EQ(decode<uint32_t>(container, LW_ARRAY_INDEX, 2, 3)[5], 3u);
  memory.reads_left = 0;
  uint32_t index[6];
  EXPECT_EQ(lw_decode_array(container, LW_ARRAY_INDEX, index, sizeof index), LW_IO_ERROR);
  lw_close(container);
  EXPECT_EQ(lw_open_reader(&reader, nullptr, &container), LW_IO_ERROR);
}

/// A file of 100,000 lamps is read and parsed once, not once for each.
TEST(Container, ALightCostsNothingButItself) {
  v1::SceneHeader scene;
  for (int i = 0; i < 3; ++i) scene.add_origin(0), scene.add_bounds_min(0), scene.add_bounds_max(1);
  for (int n = 0; n < 100'000; ++n) {
    v1::Light& light = *scene.add_lights();
    light.set_type(v1::LIGHT_TYPE_POINT);
    for (int i = 0; i < 3; ++i) light.add_position(float(n)), light.add_direction(0), light.add_intensity(1);
  }
  format::Writer writer;
  writer.addSection("scene");
  writer.addMessage("scene", "header", scene);
  const std::vector<uint8_t> bytes = writer.bytes();
  struct Memory {
    const std::vector<uint8_t>* bytes;
    size_t reads;
  } memory{&bytes, 0};
  lw_reader reader{};
  reader.read = [](void* user, uint64_t offset, void* destination, size_t count) {
    auto& m = *static_cast<Memory*>(user);
    ++m.reads;
    std::memcpy(destination, m.bytes->data() + offset, count);
    return 0;
  };
  reader.user = &memory;
  reader.file_bytes = bytes.size();
  Host host;
  const lw_config config = host.config();
  lw_container* container = nullptr;
  ASSERT_EQ(lw_open_reader(&reader, &config, &container), LW_OK);
  const size_t reads = memory.reads, allocations = host.allocations;
  lw_scene_info info{};
  ASSERT_EQ(lw_get_scene_info(container, &info), LW_OK);
  ASSERT_EQ(info.light_count, 100'000u);
  for (uint32_t n = 0; n < info.light_count; ++n) {
    lw_light light{};
    ASSERT_EQ(lw_get_light(container, n, &light), LW_OK);
    ASSERT_EQ(light.position_m[0], float(n));
  }
  EXPECT_EQ(memory.reads, reads);
  EXPECT_EQ(host.allocations, allocations);
  lw_close(container);
  EXPECT_EQ(host.live, 0u);
}

TEST(Container, ReturnsAllMemoryAndSurvivesItsLack) {
  SyntheticOptions options;
  options.layout = Layout::local_bases;
  const auto bytes = makeSyntheticPrm(options).container;
  size_t needed = 0;
  for (size_t fail_at = SIZE_MAX;; fail_at = fail_at == SIZE_MAX ? 0 : fail_at + 1) {
    Host host;
    host.fail_at = fail_at;
    const lw_config config = host.config();
    lw_container* container = nullptr;
    lw_prm* prm = nullptr;
    lw_result result = lw_open_memory(bytes.data(), bytes.size(), &config, &container);
    if (!result) result = lw_prm_load(container, &prm);
    lw_close(container);  // before the maps: they stay valid
    lw_prm_info info{};
    EXPECT_EQ(lw_prm_get_info(prm, &info), prm ? LW_OK : LW_INVALID_ARGUMENT);
    lw_prm_release(prm);
    EXPECT_EQ(host.live, 0u);
    EXPECT_EQ(result, fail_at < needed ? LW_OUT_OF_MEMORY : LW_OK) << fail_at;
    if (fail_at == SIZE_MAX) needed = host.allocations;
    else if (fail_at >= needed) break;
  }
  EXPECT_GT(needed, 10u);
}

TEST(Container, HoldsItsLimits) {
  const auto bytes = makeSyntheticPrm({}).container;
  lw_config config = LW_CONFIG_INIT;
  lw_container* container = nullptr;
  config.max_file_bytes = bytes.size() - 1;
  EXPECT_EQ(lw_open_memory(bytes.data(), bytes.size(), &config, &container), LW_LIMIT_EXCEEDED);
  config.max_file_bytes = 0;
  config.max_decoded_bytes = 1000;
  EXPECT_EQ(lw_open_memory(bytes.data(), bytes.size(), &config, &container), LW_LIMIT_EXCEEDED);
  EXPECT_EQ(container, nullptr);
}

TEST(Container, RejectsWrongArguments) {
  const auto bytes = quadContainer();
  lw_container* container = nullptr;
  EXPECT_EQ(lw_open_memory(nullptr, 10, nullptr, &container), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_open_memory(bytes.data(), bytes.size(), nullptr, nullptr), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_open_file(nullptr, nullptr, &container), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_open_reader(nullptr, nullptr, &container), LW_INVALID_ARGUMENT);
  lw_config config = LW_CONFIG_INIT;
  config.size = 4;
  EXPECT_EQ(lw_open_memory(bytes.data(), bytes.size(), &config, &container), LW_INVALID_ARGUMENT);
  config = LW_CONFIG_INIT;
  config.allocate = [](void*, size_t n) { return std::malloc(n); };  // without release
  EXPECT_EQ(lw_open_memory(bytes.data(), bytes.size(), &config, &container), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_get_scene_info(nullptr, nullptr), LW_INVALID_ARGUMENT);
  lw_array_info info{};
  const Container good = openMemory(bytes);
  EXPECT_EQ(lw_get_array_info(good.get(), lw_array(99), &info), LW_INVALID_ARGUMENT);
  lw_close(nullptr);
  lw_prm_release(nullptr);
  EXPECT_STREQ(lw_result_name(LW_BAD_CHUNK), "LW_BAD_CHUNK");
  EXPECT_STREQ(lw_result_name(12345), "LW_UNKNOWN");
  EXPECT_EQ(lw_version(), uint32_t(LW_VERSION));
}

/// Whatever a byte becomes, opening and loading end in a result, and a changed value never passes.
TEST(Container, FindsEveryDamagedByte) {
  SyntheticOptions options;
  options.width = options.height = 6;
  options.clusters = 4;
  for (const Layout layout : {Layout::panes_rgb9e5, Layout::local_bases}) {
    options.layout = layout;
    options.blocks = 3;
    const auto sound = makeSyntheticPrm(options).container;
    int passed = 0;
    for (size_t i = 0; i < sound.size(); ++i) {
      auto bytes = sound;
      bytes[i] ^= 0x10;
      lw_container* container = nullptr;
      lw_prm* prm = nullptr;
      if (!lw_open_memory(bytes.data(), bytes.size(), nullptr, &container)) lw_prm_load(container, &prm);
      // Coverage and albedo are not read here; everything else is.
      if (prm) ++passed;
      lw_prm_release(prm);
      lw_close(container);
    }
    EXPECT_LT(passed, 200);
    for (size_t length = 0; length < sound.size(); length += 7) {
      lw_container* container = nullptr;
      EXPECT_NE(lw_open_memory(sound.data(), length, nullptr, &container), LW_OK);
    }
  }
}

/// Values that no bake writes, under right checksums: each is found when loading, before anything relies on it.
TEST(Container, FindsValuesThatCannotBe) {
  struct Case {
    Layout layout;
    const char* chunk;
    std::function<void(std::vector<uint32_t>&)> damage;
  };
  const uint32_t none = 0xffffffffu;
  const std::vector<Case> cases = {
      {Layout::panes_half, "texel", [](auto& v) { v[3] = 24 * 20; }},
      {Layout::panes_half, "texel", [](auto& v) { v[3] = v[4]; }},
      {Layout::panes_half, "source", [&](auto& v) { *std::find_if(v.begin(), v.end(), [&](uint32_t s) { return s != none; }) = 24 * 20; }},
      {Layout::panes_half, "source", [&](auto& v) { v[0] = 1, v[1] = 2, v[2] = 2; }},  // a source that shows another
      {Layout::panes_half, "cluster_first_entry", [](auto& v) { v[0] = 1; }},
      {Layout::panes_half, "cluster_first_entry", [](auto& v) { v[5] = v[6]; }},
      {Layout::panes_half, "cluster_first_entry", [](auto& v) { v.back() += 1; }},
      {Layout::panes_half, "cluster_first_entry", [](auto& v) { v[5] = 0x7fffffff; }},
      {Layout::local_bases, "block_first_texel", [](auto& v) { v[3] = 0x7fffffff; }},
      {Layout::local_bases, "block_first_texel", [](auto& v) { std::swap(v[3], v[4]); }},
      {Layout::local_bases, "block_first_link", [](auto& v) { v[3] = 0x7fffffff; }},
      {Layout::local_bases, "block_first_link", [](auto& v) { v[0] = 1; }},
      {Layout::local_bases, "link_wavelet", [](auto& v) { v.back() = 3 * 40 - 2; }},
      {Layout::local_bases, "link_wavelet", [](auto& v) { v[0] = 3 * 40 - 3; }},  // falls to the second
      {Layout::local_bases, "tree_first_leaves", [](auto& v) { v[0] = 0; }},
      {Layout::local_bases, "tree_first_leaves", [](auto& v) { v[0] = 40; }},
      {Layout::local_bases, "tree_first_leaves", [](auto& v) { v.back() = 0xffffffff; }},
      {Layout::local_bases, "tree_first_share", [](auto& v) { v[38] = 0; }},
      {Layout::local_bases, "wavelet_unit", [](auto& v) { v.push_back(160); }},
  };
  for (size_t i = 0; i < cases.size(); ++i) {
    SyntheticOptions options;
    options.layout = cases[i].layout;
    bool damaged = false;
    options.edit_u32 = [&](std::string_view chunk, std::vector<uint32_t>& values) {
      if (chunk == cases[i].chunk) cases[i].damage(values), damaged = true;
    };
    Host host;
    const lw_config config = host.config();
    const auto bytes = makeSyntheticPrm(options).container;
    EXPECT_TRUE(damaged);
    const Container container = openMemory(bytes, &config);
    lw_prm* prm = nullptr;
    EXPECT_EQ(lw_prm_load(container.get(), &prm), LW_BAD_SECTION) << i;
    EXPECT_THAT(host.message, testing::HasSubstr(cases[i].chunk)) << i;
  }
  for (const char* chunk : {"entry_position", "entry_weight", "entry_rectangle", "coefficient_scale"}) {
    SyntheticOptions options;
    options.layout = Layout::local_bases;
    options.edit_f32 = [&](std::string_view name, std::vector<float>& values) {
      if (name == chunk) values[2] = NAN;
    };
    const auto bytes = makeSyntheticPrm(options).container;
    const Container container = openMemory(bytes);
    lw_prm* prm = nullptr;
    EXPECT_EQ(lw_prm_load(container.get(), &prm), LW_BAD_SECTION) << chunk;
  }
}

TEST(Container, ResultsAreTheFormatsStatuses) {
  EXPECT_EQ(int32_t(format::Status::io_error), LW_IO_ERROR);
  EXPECT_EQ(int32_t(format::Status::truncated), LW_TRUNCATED);
  EXPECT_EQ(int32_t(format::Status::bad_magic), LW_BAD_MAGIC);
  EXPECT_EQ(int32_t(format::Status::too_new), LW_TOO_NEW);
  EXPECT_EQ(int32_t(format::Status::bad_header), LW_BAD_HEADER);
  EXPECT_EQ(int32_t(format::Status::bad_checksum), LW_BAD_CHECKSUM);
  EXPECT_EQ(int32_t(format::Status::bad_directory), LW_BAD_DIRECTORY);
  EXPECT_EQ(int32_t(format::Status::bad_chunk), LW_BAD_CHUNK);
  EXPECT_EQ(int32_t(format::Status::bad_section), LW_BAD_SECTION);
  EXPECT_EQ(int32_t(format::Status::trailing_bytes), LW_TRAILING_BYTES);
  EXPECT_EQ(int32_t(format::Status::limit_exceeded), LW_LIMIT_EXCEEDED);
  EXPECT_EQ(int32_t(format::Status::out_of_memory), LW_OUT_OF_MEMORY);
  EXPECT_EQ(int32_t(format::Status::not_found), LW_NOT_FOUND);
  EXPECT_EQ(int32_t(format::Status::invalid_argument), LW_INVALID_ARGUMENT);
}

TEST(Container, SectionsThatAreNotThereAreNotFound) {
  const std::vector<uint8_t> bytes = format::Writer().bytes();
  const Container container = openMemory(bytes);
  lw_scene_info scene;
  lw_light light;
  lw_atlas_info atlas;
  lw_prm* prm;
  lw_radiosity* radiosity;
  lw_lightmap* lightmap;
  lw_virtual_lights* lights;
  lw_points* points;
  lw_environment* environment;
  EXPECT_EQ(lw_get_scene_info(container.get(), &scene), LW_NOT_FOUND);
  EXPECT_EQ(lw_get_light(container.get(), 0, &light), LW_NOT_FOUND);
  EXPECT_EQ(lw_get_atlas_info(container.get(), &atlas), LW_NOT_FOUND);
  EXPECT_EQ(lw_prm_load(container.get(), &prm), LW_NOT_FOUND);
  EXPECT_EQ(lw_radiosity_load(container.get(), &radiosity), LW_NOT_FOUND);
  EXPECT_EQ(lw_lightmap_load(container.get(), &lightmap), LW_NOT_FOUND);
  EXPECT_EQ(lw_virtual_lights_load(container.get(), &lights), LW_NOT_FOUND);
  EXPECT_EQ(lw_points_load(container.get(), &points), LW_NOT_FOUND);
  EXPECT_EQ(lw_environment_load(container.get(), &environment), LW_NOT_FOUND);
}

TEST(Container, LightsThatCannotShineAreDamage) {
  for (const float bad : {-1.0f, NAN, INFINITY}) {
    v1::SceneHeader scene;
    for (int i = 0; i < 3; ++i) scene.add_origin(0), scene.add_bounds_min(0), scene.add_bounds_max(1);
    for (const float intensity : {1.0f, bad}) {
      v1::Light& light = *scene.add_lights();
      light.set_type(v1::LIGHT_TYPE_POINT);
      for (int i = 0; i < 3; ++i) light.add_position(0), light.add_direction(0), light.add_intensity(intensity);
    }
    format::Writer writer;
    writer.addSection("scene");
    writer.addMessage("scene", "header", scene);
    const std::vector<uint8_t> bytes = writer.bytes();
    const Container container = openMemory(bytes);
    lw_light light;
    EXPECT_EQ(lw_get_light(container.get(), 0, &light), LW_OK);
    EXPECT_EQ(lw_get_light(container.get(), 1, &light), LW_BAD_SECTION) << bad;
  }
}

}  // namespace
}  // namespace lightwell::test
