// Materials, textures and what a surface shows at a point.
#include <gmock/gmock.h>
#include <webp/encode.h>

#include <cmath>
#include <cstdlib>

#include "tests/scene/gltf_builder.h"

#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>

namespace lightwell::scene {
namespace {

using testing::HasSubstr;
using Materials = SceneTest;

double toLinear(double code) { return code <= 0.04045 * 255 ? code / 255 / 12.92 : std::pow((code / 255 + 0.055) / 1.055, 2.4); }

/// 2 × 2: red, green / blue, white at half alpha.
const std::vector<uint8_t> kPixels = {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 188, 188, 188, 128};

void append(void* context, void* data, int size) {
  auto& bytes = *static_cast<std::vector<uint8_t>*>(context);
  bytes.insert(bytes.end(), static_cast<uint8_t*>(data), static_cast<uint8_t*>(data) + size);
}
std::vector<uint8_t> png() {
  std::vector<uint8_t> bytes;
  stbi_write_png_to_func(append, &bytes, 2, 2, 4, kPixels.data(), 8);
  return bytes;
}
std::vector<uint8_t> jpeg(uint8_t grey) {
  std::vector<uint8_t> bytes, pixels(16 * 16 * 3, grey);
  stbi_write_jpg_to_func(append, &bytes, 16, 16, 3, pixels.data(), 95);
  return bytes;
}
std::vector<uint8_t> webp() {
  uint8_t* encoded = nullptr;
  const size_t size = WebPEncodeLosslessRGBA(kPixels.data(), 2, 2, 8, &encoded);
  std::vector<uint8_t> bytes(encoded, encoded + size);
  WebPFree(encoded);
  return bytes;
}

/// A triangle with the material, whose texture coordinates are all (u, v).
GltfBuilder surfaceAt(Json material, float u, float v, const std::vector<uint8_t>& picture = {}) {
  GltfBuilder b;
  Json primitive = b.triangle();
  primitive["attributes"]["TEXCOORD_0"] = b.accessor<float>({u, v, u, v, u, v}, "VEC2", 2);
  primitive["material"] = b.add("materials", std::move(material));
  b.show(primitive);
  if (!picture.empty()) {
    b.add("images", {{"bufferView", b.view(picture)}, {"mimeType", "image/png"}});
    b.add("textures", {{"source", 0}});
  }
  return b;
}

const Json kTextured = {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}, {"alphaMode", "BLEND"}};

void expectRgb(const Rgb& value, double r, double g, double b, double tolerance = 1e-4) {
  EXPECT_NEAR(value.x, r, tolerance);
  EXPECT_NEAR(value.y, g, tolerance);
  EXPECT_NEAR(value.z, b, tolerance);
}

TEST_F(Materials, TexelCentresAreExactAndRowZeroIsVZero) {
  for (const auto& picture : {png(), webp()}) {
    expectRgb(surfaceColor(load(surfaceAt(kTextured, 0.25f, 0.25f, picture)), 0, 0.3f, 0.3f).albedo_rgb, 0.999, 0, 0);
    expectRgb(surfaceColor(load(surfaceAt(kTextured, 0.75f, 0.25f, picture)), 0, 0.3f, 0.3f).albedo_rgb, 0, 0.999, 0);
    expectRgb(surfaceColor(load(surfaceAt(kTextured, 0.25f, 0.75f, picture)), 0, 0.3f, 0.3f).albedo_rgb, 0, 0, 0.999);
    const Scene scene = load(surfaceAt(kTextured, 0.75f, 0.75f, picture));
    const SurfaceColor color = surfaceColor(scene, 0, 0.3f, 0.3f);
    expectRgb(color.albedo_rgb, toLinear(188), toLinear(188), toLinear(188));
    EXPECT_NEAR(color.alpha, 128.0 / 255, 1e-5);
    EXPECT_EQ(surfaceAlpha(scene, 0, 0.3f, 0.3f), color.alpha);
  }
}

TEST_F(Materials, BilinearLookupMixesLinearLight) {
  // Half way between red and green, decoded before they are mixed.
  expectRgb(surfaceColor(load(surfaceAt(kTextured, 0.5f, 0.25f, png())), 0, 0.3f, 0.3f).albedo_rgb, 0.5, 0.5, 0);
}

TEST_F(Materials, WrapModesRepeatClampAndMirror) {
  const auto red_at = [&](int mode, float u) {
    GltfBuilder b = surfaceAt(kTextured, u, 0.25f, png());
    b.json["samplers"] = {{{"wrapS", mode}, {"wrapT", mode}}};
    b.json["textures"][0]["sampler"] = 0;
    return surfaceColor(load(b), 0, 0.3f, 0.3f).albedo_rgb.x;
  };
  EXPECT_NEAR(red_at(10497, 1.25f), 0.999, 1e-4);  // repeat: red again
  EXPECT_NEAR(red_at(10497, -0.25f), 0, 1e-4);     // the green on the other side
  EXPECT_NEAR(red_at(33071, 1.25f), 0, 1e-4);      // clamp: green
  EXPECT_NEAR(red_at(33071, -5.0f), 0.999, 1e-4);
  EXPECT_NEAR(red_at(33648, 1.25f), 0, 1e-4);      // mirror: green, then red
  EXPECT_NEAR(red_at(33648, 1.75f), 0.999, 1e-4);
  EXPECT_NEAR(red_at(33648, -0.25f), 0.999, 1e-4);
}

TEST_F(Materials, JpegIsRead) {
  const Scene scene = load(surfaceAt(kTextured, 0.5f, 0.5f, jpeg(100)));
  expectRgb(surfaceColor(scene, 0, 0.3f, 0.3f).albedo_rgb, toLinear(100), toLinear(100), toLinear(100), 5e-3);
}

TEST_F(Materials, WebpExtensionReplacesTheFallback) {
  GltfBuilder b = surfaceAt(kTextured, 0.25f, 0.25f, jpeg(100));
  b.add("images", {{"bufferView", b.view(webp())}, {"mimeType", "image/webp"}});
  b.json["textures"][0]["extensions"]["EXT_texture_webp"]["source"] = 1;
  b.useExtension("EXT_texture_webp", true);
  expectRgb(surfaceColor(load(b), 0, 0.3f, 0.3f).albedo_rgb, 0.999, 0, 0);
}

TEST_F(Materials, TextureTransformScalesThenRotatesThenMoves) {
  Json material = kTextured;
  auto& extension = material["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]["KHR_texture_transform"];
  extension = {{"offset", {0, 1}}, {"rotation", 1.57079632679}, {"scale", {0.5, 0.5}}};
  // The extension's example: the unit square maps to the lower left quadrant.
  Scene scene = load(surfaceAt(material, 0.5f, 0.5f, png()));
  EXPECT_NEAR(scene.mesh.base_uv[0].x, 0.25, 1e-6);
  EXPECT_NEAR(scene.mesh.base_uv[0].y, 0.75, 1e-6);
  expectRgb(surfaceColor(scene, 0, 0.3f, 0.3f).albedo_rgb, 0, 0, 0.999);
  scene = load(surfaceAt(material, 1, 0, png()));
  EXPECT_NEAR(scene.mesh.base_uv[0].x, 0, 1e-6);
  EXPECT_NEAR(scene.mesh.base_uv[0].y, 0.5, 1e-6);
}

TEST_F(Materials, FactorsTexturesAndVertexColoursMultiply) {
  Json material = kTextured;
  material["pbrMetallicRoughness"]["baseColorFactor"] = {0.5, 0.5, 0.5, 0.5};
  GltfBuilder b = surfaceAt(material, 0.75f, 0.75f, png());
  b.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] =
      b.accessor<uint8_t>({255, 51, 0, 51, 255, 51, 0, 51, 255, 51, 0, 51}, "VEC4", 4, true);
  const SurfaceColor color = surfaceColor(load(b), 0, 0.2f, 0.7f);
  expectRgb(color.albedo_rgb, 0.5 * toLinear(188), 0.5 * 0.2 * toLinear(188), 0);
  EXPECT_NEAR(color.alpha, 0.5 * 0.2 * 128 / 255, 1e-5);
}

TEST_F(Materials, VertexColoursAreInterpolated) {
  GltfBuilder b;
  Json primitive = b.triangle();
  primitive["attributes"]["COLOR_0"] = b.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3);
  b.show(primitive);
  expectRgb(surfaceColor(load(b), 0, 0.25f, 0.5f).albedo_rgb, 0.25, 0.5, 0);
}

TEST_F(Materials, EmissionIsFactorTimesStrengthTimesTexture) {
  const Json material = {{"emissiveFactor", {1, 0.5, 0.25}},
                         {"emissiveTexture", {{"index", 0}}},
                         {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 17}}}}}};
  expectRgb(surfaceColor(load(surfaceAt(material, 0.75f, 0.75f, png())), 0, 0.3f, 0.3f).emitted_radiance_rgb, 17 * toLinear(188),
            8.5 * toLinear(188), 4.25 * toLinear(188), 1e-3);
}

TEST_F(Materials, UnlitReflectsButDoesNotEmit) {
  const Json material = {{"emissiveFactor", {1, 1, 1}},
                         {"pbrMetallicRoughness", {{"baseColorFactor", {0.3, 0.4, 0.5, 1}}}},
                         {"extensions", {{"KHR_materials_unlit", Json::object()}}}};
  const Scene scene = load(surfaceAt(material, 0, 0));
  EXPECT_TRUE(scene.materials[0].unlit);
  expectRgb(surfaceColor(scene, 0, 0.3f, 0.3f).albedo_rgb, 0.3, 0.4, 0.5);
  expectRgb(surfaceColor(scene, 0, 0.3f, 0.3f).emitted_radiance_rgb, 0, 0, 0);
}

TEST_F(Materials, SpecularGlossinessGivesItsDiffuseColour) {
  const Json material = {
      {"pbrMetallicRoughness", {{"baseColorFactor", {1, 0, 0, 1}}}},
      {"extensions", {{"KHR_materials_pbrSpecularGlossiness", {{"diffuseFactor", {0.1, 0.2, 0.3, 1}}, {"diffuseTexture", {{"index", 0}}}}}}}};
  expectRgb(surfaceColor(load(surfaceAt(material, 0.25f, 0.25f, png())), 0, 0.3f, 0.3f).albedo_rgb, 0.1, 0, 0);
}

TEST_F(Materials, AlphaModesDecideWhatAlphaMeans) {
  Json material = {{"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.5, 0.5, 0.4}}}}};
  const auto alpha = [&] { return surfaceColor(load(surfaceAt(material, 0, 0)), 0, 0.3f, 0.3f).alpha; };
  EXPECT_EQ(alpha(), 1);
  material["alphaMode"] = "BLEND";
  EXPECT_FLOAT_EQ(alpha(), 0.4f);
  material["alphaMode"] = "MASK";
  EXPECT_EQ(alpha(), 0);
  material["alphaCutoff"] = 0.3;
  EXPECT_EQ(alpha(), 1);
}

TEST_F(Materials, AlbedoIsKeptBelowOneWithAWarningThatNamesTheMaterial) {
  const Json white = {{"name", "chalk"}, {"pbrMetallicRoughness", {{"baseColorFactor", {1, 0.5, 0.5, 1}}}}};
  const Scene scene = load(surfaceAt(white, 0, 0));
  EXPECT_FLOAT_EQ(surfaceColor(scene, 0, 0.3f, 0.3f).albedo_rgb.x, 0.999f);
  EXPECT_TRUE(warned("materials[0]", "\"chalk\": the albedo reaches 1.0000"));
  const Json grey = {{"name", "slate"}, {"pbrMetallicRoughness", {{"baseColorFactor", {0.9, 0.5, 0.5, 1}}}}};
  load(surfaceAt(grey, 0, 0));
  EXPECT_FALSE(warned("materials[0]", "slate"));
}

TEST_F(Materials, FactorsOutOfRangeAreClampedWithAWarning) {
  const Scene scene = load(surfaceAt({{"pbrMetallicRoughness", {{"baseColorFactor", {2, -1, 0.5, 1}}}}, {"emissiveFactor", {-1, 2, 0}}}, 0, 0));
  EXPECT_EQ(scene.materials[0].base_color, Rgb(1, 0, 0.5f));
  EXPECT_EQ(scene.materials[0].emissive, Rgb(0, 2, 0));
  EXPECT_TRUE(warned("materials[0].pbrMetallicRoughness.baseColorFactor", "clamped"));
  EXPECT_TRUE(warned("materials[0].emissiveFactor", "negative"));
}

TEST_F(Materials, LookupsAreFiniteForAnyCoordinate) {
  const Scene scene = load(surfaceAt(kTextured, 0, 0, png()));
  for (const float u : {1e30f, -1e30f, INFINITY, NAN, 1e-30f})
    for (const float value : sampleTexture(scene.textures[0], {u, -u})) EXPECT_TRUE(std::isfinite(value));
}

TEST_F(Materials, UnusedPicturesAreNeverRead) {
  GltfBuilder b = surfaceAt({{"normalTexture", {{"index", 0}}}}, 0, 0, {'n', 'o', 'n', 'e'});
  EXPECT_TRUE(load(b).textures.empty());
}

TEST_F(Materials, DamagedAndForeignPicturesAreNamed) {
  std::vector<uint8_t> cut = png();
  cut.resize(30);
  EXPECT_THAT(errorOf(surfaceAt(kTextured, 0, 0, cut)), HasSubstr("images[0]: is a damaged picture"));
  EXPECT_THAT(errorOf(surfaceAt(kTextured, 0, 0, {'B', 'M', 0, 0})), HasSubstr("images[0]: is neither PNG nor JPEG nor WebP"));
}

/// A segment of a JPEG file.
std::vector<uint8_t> segment(uint8_t marker, const std::vector<uint8_t>& parameters) {
  std::vector<uint8_t> bytes = {0xFF, marker, uint8_t((parameters.size() + 2) >> 8), uint8_t(parameters.size() + 2)};
  bytes.insert(bytes.end(), parameters.begin(), parameters.end());
  return bytes;
}

/// A segment with one Huffman table of codes of eight and nine bits.
std::vector<uint8_t> huffmanTable(uint8_t eight_bits, uint8_t nine_bits) {
  std::vector<uint8_t> table(size_t(17 + eight_bits + nine_bits));
  table[8] = eight_bits, table[9] = nine_bits;
  return segment(0xC4, table);
}

std::vector<uint8_t> with(std::vector<uint8_t> bytes, std::ptrdiff_t at, const std::vector<uint8_t>& inserted) {
  bytes.insert((at < 0 ? bytes.end() : bytes.begin()) + at, inserted.begin(), inserted.end());
  return bytes;
}

TEST_F(Materials, HuffmanTablesHaveAtMost256Symbols) {
  constexpr std::ptrdiff_t kFirst = 2, kAfterScan = -2;  // behind the start, before the end of the image
  std::vector<uint8_t> behind_an_empty_table(34);
  behind_an_empty_table[18] = 255, behind_an_empty_table[19] = 2;
  for (const std::ptrdiff_t place : {kFirst, kAfterScan})
    for (const auto& table : {huffmanTable(128, 129), segment(0xC4, behind_an_empty_table)})
      EXPECT_THAT(errorOf(surfaceAt(kTextured, 0, 0, with(jpeg(100), place, table))), HasSubstr("images[0]: is a damaged picture: a Huffman table has more than 256 symbols"));
  std::vector<uint8_t> cut = jpeg(100);
  cut.resize(2);
  for (const uint8_t byte : {0xFF, 0xC4, 1, 0, 0, 255, 255}) cut.push_back(byte);
  EXPECT_THAT(errorOf(surfaceAt(kTextured, 0, 0, cut)), HasSubstr("more than 256 symbols")) << "counts that the file ends in";
  const std::vector<uint8_t> no_table = huffmanTable(255, 255);
  EXPECT_EQ(load(surfaceAt(kTextured, 0, 0, with(jpeg(100), kFirst, segment(0xE1, no_table)))).textures.size(), 1u) << "what a camera notes is no table";
  EXPECT_EQ(load(surfaceAt(kTextured, 0, 0, with(jpeg(100), kFirst, huffmanTable(0, 1)))).textures.size(), 1u) << "tables may come twice, the last counts";
  std::vector<uint8_t> film = jpeg(100);
  film.insert(film.end(), no_table.begin(), no_table.end());
  EXPECT_EQ(load(surfaceAt(kTextured, 0, 0, film)).textures.size(), 1u) << "nobody reads behind the end of the image";
}

/// The JPEG file with every segment of the marker made a note that no decoder reads.
std::vector<uint8_t> without(uint8_t marker, std::vector<uint8_t> bytes) {
  for (size_t at = 2; at + 3 < bytes.size() && bytes[at + 1] != 0xDA; at += 2 + (size_t(bytes[at + 2]) << 8 | bytes[at + 3]))
    if (bytes[at + 1] == marker) bytes[at + 1] = 0xFE;
  return bytes;
}

TEST_F(Materials, TablesThatJpegScansNameAreDefined) {
  EXPECT_THAT(errorOf(surfaceAt(kTextured, 0, 0, without(0xC4, jpeg(100)))), HasSubstr("images[0]: is a damaged picture: a scan names a Huffman table that is not defined before it"));
  EXPECT_THAT(errorOf(surfaceAt(kTextured, 0, 0, without(0xDB, jpeg(100)))), HasSubstr("a scan names a quantisation table that is not defined before it"));
}

TEST_F(Materials, ScansOfAProgressiveJpegNeedTheirTablesOnly) {
  // One block of grey: the first coefficient with a Huffman table, a later bit of it without one, and the others with one of their own.
  const std::vector<uint8_t> start = {0xFF, 0xD8}, end = {0xFF, 0xD9}, frame = {8, 0, 8, 0, 8, 1, 1, 0x11, 0};
  std::vector<uint8_t> table(18, 0), ac_table(18, 0);  // one code of one bit: no difference, and the end of the block
  table[1] = 1, ac_table[0] = 0x10, ac_table[1] = 1;
  const std::vector<uint8_t> first = {1, 1, 0x00, 0, 0, 0x01}, later = {1, 1, 0x00, 0, 0, 0x10}, others = {1, 1, 0x00, 1, 63, 0x00}, coded = {0x7F};
  auto file = [&](const std::vector<std::vector<uint8_t>>& parts) {
    std::vector<uint8_t> bytes;
    for (const auto& part : parts) bytes.insert(bytes.end(), part.begin(), part.end());
    return bytes;
  };
  const auto dqt = segment(0xDB, std::vector<uint8_t>(65, 0)), sof = segment(0xC2, frame);
  const auto whole = file({start, dqt, sof, segment(0xC4, table), segment(0xDA, first), coded, segment(0xDA, later), coded, segment(0xC4, ac_table), segment(0xDA, others), coded, end});
  EXPECT_EQ(load(surfaceAt(kTextured, 0, 0, whole)).textures.size(), 1u);
  const auto no_first = file({start, dqt, sof, segment(0xC4, ac_table), segment(0xDA, first), coded, end});
  const auto no_others = file({start, dqt, sof, segment(0xC4, table), segment(0xDA, first), coded, segment(0xDA, others), coded, end});
  for (const auto& bytes : {no_first, no_others}) EXPECT_THAT(errorOf(surfaceAt(kTextured, 0, 0, bytes)), HasSubstr("a scan names a Huffman table"));
}

/// A PNG file of nothing but a header, which claims so many columns and rows.
std::vector<uint8_t> claim(uint32_t columns, uint32_t rows) {
  std::vector<uint8_t> bytes = png();
  for (int i = 0; i < 4; ++i) bytes[size_t(16 + i)] = uint8_t(columns >> (24 - 8 * i)), bytes[size_t(20 + i)] = uint8_t(rows >> (24 - 8 * i));
  bytes.resize(33);
  return bytes;
}

TEST_F(Materials, PicturesHaveALimitBeforeTheyAreDecoded) {
  EXPECT_THAT(errorOf(surfaceAt(kTextured, 0, 0, claim(16384, 16384))), HasSubstr("is a damaged picture")) << "as large as can be, but nothing of it there";
  EXPECT_THAT(errorOf(surfaceAt(kTextured, 0, 0, claim(16385, 1))), HasSubstr("images[0]: has 16385 x 1 pixels; a side may have 16384"));
  EXPECT_THAT(errorOf(surfaceAt(kTextured, 0, 0, claim(0x7FFFFFFF, 2))), HasSubstr("images[0]: "));
  // Together they may have as many as the largest alone.
  Json both = kTextured;
  both["emissiveTexture"] = {{"index", 1}};
  both["emissiveFactor"] = {1, 1, 1};
  GltfBuilder b = surfaceAt(both, 0, 0, png());
  b.add("images", {{"bufferView", b.view(claim(16384, 16384))}, {"mimeType", "image/png"}});
  b.add("textures", {{"source", 1}});
  EXPECT_THAT(errorOf(b), HasSubstr("images[1]: has 16384 x 16384 pixels; a side may have 16384, and all pictures together 268435456, of which 268435452 are left"));
}

}  // namespace
}  // namespace lightwell::scene
