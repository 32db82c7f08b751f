// The checks of sections meta, scene, geometry and atlas. docs/format.md has the tables that they hold.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "format/encode/verify_context.h"
#include "lightwell/v1/container.pb.h"

namespace lightwell::format {
namespace {

constexpr uint32_t kNoTexel = 0xffffffffu;
constexpr uint16_t kOpaque = 0xffff;
constexpr uint8_t kMask = 2, kBlend = 4, kFlags = 7;
constexpr uint64_t kMaxImageSide = 16384;

template <class Range>
bool allFinite(const Range& values) {
  return std::all_of(values.begin(), values.end(), [](auto v) { return std::isfinite(v); });
}

/// Empty, or what is wrong with the light.
std::string lightFault(const v1::Light& light) {
  if (light.type() < v1::LIGHT_TYPE_POINT || light.type() > v1::LIGHT_TYPE_DIRECTIONAL) return "is of no known type";
  if (light.position_size() != 3 || light.direction_size() != 3 || light.intensity_size() != 3) return "has not three numbers per vector";
  if (!allFinite(light.position()) || !allFinite(light.direction()) || !allFinite(light.intensity())) return "is not finite";
  if (std::any_of(light.intensity().begin(), light.intensity().end(), [](float v) { return v < 0; })) return "has a negative intensity";
  if (light.type() != v1::LIGHT_TYPE_POINT) {
    double squared = 0;
    for (const float v : light.direction()) squared += double(v) * v;
    if (std::abs(squared - 1) > 1e-3) return "has a direction that is not a unit vector";
  }
  if (light.type() == v1::LIGHT_TYPE_SPOT &&
      !(light.inner_cone_angle() >= 0 && light.inner_cone_angle() < light.outer_cone_angle() &&
        light.outer_cone_angle() <= float(std::numbers::pi / 2)))
    return "has cone angles out of order";
  if (!(light.range() >= 0) || !std::isfinite(light.range())) return "has a range that is negative or not finite";
  return {};
}

/// Empty, or what is wrong with the material.
std::string alphaFault(const v1::AlphaMaterial& material) {
  if (material.mode() != v1::ALPHA_MODE_MASK && material.mode() != v1::ALPHA_MODE_BLEND) return "is of no known mode";
  if (!(material.factor() >= 0 && material.factor() <= 1)) return "has a factor outside 0 to 1";
  if (!(material.cutoff() >= 0) || !std::isfinite(material.cutoff())) return "has a cutoff that is negative or not finite";
  const auto wraps = [](v1::WrapMode mode) { return mode >= v1::WRAP_MODE_REPEAT && mode <= v1::WRAP_MODE_MIRROR; };
  if (material.has_texture() && (!wraps(material.wrap_u()) || !wraps(material.wrap_v()))) return "has no known wrap mode";
  return {};
}

void verifyAlpha(VerifyContext& context, uint64_t vertices, const std::vector<uint8_t>& flags) {
  constexpr const char* kSection = "geometry";
  if (const auto uv = context.load<float>(kSection, "alpha_uv", {vertices, 2})) context.checkFinite(*uv, kSection, "alpha_uv");
  const auto of_triangle = context.load<uint16_t>(kSection, "triangle_alpha", {flags.size()});
  v1::AlphaMaterials alpha;
  if (!context.loadMessage(kSection, "alpha_material", alpha)) return;
  const auto& materials = alpha.materials();

  for (int i = 0; i < materials.size(); ++i) {
    if (const std::string fault = alphaFault(materials[i]); !fault.empty())
      context.report(IssueId::header_value, kSection, "alpha_material", "material " + std::to_string(i) + " " + fault);
    if (!materials[i].has_texture()) continue;
    const std::string texture = "alpha_texture_" + std::to_string(materials[i].texture());
    const ChunkInfo* chunk = context.find(kSection, texture);
    if (chunk && std::any_of(chunk->shape, chunk->shape + chunk->rank, [](uint64_t side) { return side == 0 || side > kMaxImageSide; }))
      context.report(IssueId::chunk_shape, kSection, texture, "is empty or larger than 16384");
    context.load<uint8_t>(kSection, texture, {kAnyExtent, kAnyExtent});
  }
  if (!of_triangle) return;
  for (size_t t = 0; t < flags.size(); ++t) {
    const uint16_t index = (*of_triangle)[t];
    const uint8_t mode = flags[t] & (kMask | kBlend);
    const bool in_range = index == kOpaque || index < materials.size();
    const uint8_t wanted = index == kOpaque || !in_range ? 0 : materials[index].mode() == v1::ALPHA_MODE_MASK ? kMask : kBlend;
    if (in_range && mode == wanted) continue;
    context.report(in_range ? IssueId::value_range : IssueId::index_range, kSection, "triangle_alpha",
                   "triangle " + std::to_string(t) + (in_range ? " contradicts triangle_flags" : " names no material"));
    return;
  }
}

}  // namespace

void verifyMeta(VerifyContext& context) {
  v1::MetaHeader meta;
  if (!context.loadMessage("meta", "header", meta)) return;
  for (const v1::MeasuredError& error : meta.errors())
    if (!std::isfinite(error.relrmse()) || error.relrmse() < 0 || !std::isfinite(error.texrel()) || error.texrel() < 0 ||
        !std::isfinite(error.bias()) || !std::isfinite(error.maximum()) || error.maximum() < 0 || !std::isfinite(error.seconds()) || error.seconds() < 0)
      context.report(IssueId::header_value, "meta", "header",
                     "the measured error of \"" + error.section() + "\" is negative or not finite");
  for (const v1::MeasuredError& error : meta.errors())
    for (const auto& [least, low, high] : {std::tuple{0.0, error.relrmse_low(), error.relrmse_high()}, std::tuple{0.0, error.texrel_low(), error.texrel_high()},
                                           std::tuple{-1.0, error.bias_low(), error.bias_high()}, std::tuple{0.0, error.maximum_low(), error.maximum_high()}})
      if (!std::isfinite(high) || !(low >= least && low <= high))
        context.report(IssueId::header_value, "meta", "header", "an interval of the measured error of \"" + error.section() + "\" is upside down or not finite");
  for (const v1::Omitted& omitted : meta.omitted())
    if (omitted.type().empty() || omitted.reason().empty())
      context.report(IssueId::header_value, "meta", "header", "an omitted section has no type or no reason");
}

void verifyScene(VerifyContext& context) {
  v1::SceneHeader scene;
  if (!context.loadMessage("scene", "header", scene)) return;
  const auto wrong = [&](std::string message) { context.report(IssueId::header_value, "scene", "header", std::move(message)); };
  if (scene.origin_size() != 3 || scene.bounds_min_size() != 3 || scene.bounds_max_size() != 3)
    wrong("origin and bounds have not three numbers each");
  else if (!allFinite(scene.origin()) || !allFinite(scene.bounds_min()) || !allFinite(scene.bounds_max()))
    wrong("origin or bounds are not finite");
  else
    for (int axis = 0; axis < 3; ++axis)
      if (scene.bounds_min(axis) > scene.bounds_max(axis)) wrong("bounds are inside out");
  for (int i = 0; i < scene.lights_size(); ++i)
    if (const std::string fault = lightFault(scene.lights(i)); !fault.empty()) wrong("light " + std::to_string(i) + " " + fault);
}

void verifyGeometry(VerifyContext& context) {
  constexpr const char* kSection = "geometry";
  for (const char* needed : {"scene", "atlas"})
    if (!context.has(needed)) context.report(IssueId::section_missing, kSection, "", std::string("needs section ") + needed);

  const ChunkInfo* position_chunk = context.find(kSection, "position");
  const uint64_t vertices = position_chunk && position_chunk->rank == 2 ? position_chunk->shape[0] : kAnyExtent;
  if (const auto position = context.load<float>(kSection, "position", {kAnyExtent, 3}))
    context.checkFinite(*position, kSection, "position");
  if (const auto normal = context.load<int16_t>(kSection, "normal", {vertices, 2}))
    context.checkEach(*normal, IssueId::value_range, kSection, "normal", "are -32768", [](int16_t v) { return v == INT16_MIN; });
  if (const auto uv = context.load<float>(kSection, "lightmap_uv", {vertices, 2}))
    context.checkEach(*uv, IssueId::value_range, kSection, "lightmap_uv", "are outside 0 to 1 (by more than 1e-5) or not numbers",
                      [](float v) { return !(v >= -1e-5f && v <= 1.00001f); });

  const auto index = context.load<uint32_t>(kSection, "index", {kAnyExtent, 3});
  if (index && vertices != kAnyExtent)
    context.checkEach(*index, IssueId::index_range, kSection, "index", "name no vertex", [&](uint32_t v) { return v >= vertices; });
  const auto flags = context.load<uint8_t>(kSection, "triangle_flags", {index ? index->size() / 3 : kAnyExtent});
  if (!flags) return;
  context.checkEach(*flags, IssueId::reserved_bits, kSection, "triangle_flags", "have reserved bits, or are cut-out and blended at once",
                    [](uint8_t v) { return (v & ~kFlags) != 0 || (v & (kMask | kBlend)) == (kMask | kBlend); });
  const bool alpha = std::any_of(flags->begin(), flags->end(), [](uint8_t v) { return (v & (kMask | kBlend)) != 0; });
  if (alpha || context.find(kSection, "triangle_alpha")) verifyAlpha(context, vertices, *flags);
}

void verifyAtlas(VerifyContext& context) {
  constexpr const char* kSection = "atlas";
  v1::AtlasHeader atlas;
  if (!context.loadMessage(kSection, "header", atlas)) return;
  const uint64_t width = atlas.width(), height = atlas.height(), texels = width * height;
  if (width == 0 || height == 0 || width > kMaxImageSide || height > kMaxImageSide) {
    context.report(IssueId::header_value, kSection, "header", "the size is not between 1 and 16384");
    return;
  }
  const auto source = context.load<uint32_t>(kSection, "source", {height, width});
  auto coverage = context.load<uint8_t>(kSection, "coverage", {height, width});
  const auto albedo = context.load<uint8_t>(kSection, "albedo", {height, width, 3});
  std::optional<std::vector<uint32_t>> emission;
  if (context.find(kSection, "emission")) emission = context.load<uint32_t>(kSection, "emission", ElementType::rgb9e5, {height, width});

  if (coverage && !context.checkEach(*coverage, IssueId::value_range, kSection, "coverage", "are neither 0 nor 1",
                                     [](uint8_t v) { return v > 1; }))
    coverage.reset();
  if (coverage) {
    const auto covered = uint64_t(std::count(coverage->begin(), coverage->end(), 1));
    if (covered != atlas.covered_texels())
      context.report(IssueId::header_value, kSection, "header", "covered_texels is " + std::to_string(atlas.covered_texels()) +
                                                                    " but coverage has " + std::to_string(covered));
  }
  if (!source) return;
  if (!context.checkEach(*source, IssueId::index_range, kSection, "source", "name no texel",
                         [&](uint32_t v) { return v != kNoTexel && v >= texels; }))
    return;
  const auto firstTexel = [&](auto wrong) {
    for (size_t i = 0; i < texels; ++i)
      if (wrong(i)) return i;
    return size_t(texels);
  };
  const auto reportTexel = [&](size_t i, IssueId id, const char* name, const char* what) {
    if (i < texels) context.report(id, kSection, name, "texel " + std::to_string(i) + " " + what);
  };
  reportTexel(firstTexel([&](size_t i) { return (*source)[i] != kNoTexel && (*source)[(*source)[i]] != (*source)[i]; }), IssueId::order,
              "source", "shows a texel that does not show itself");
  if (coverage) {
    reportTexel(firstTexel([&](size_t i) { return (*source)[i] != kNoTexel && !(*coverage)[(*source)[i]]; }), IssueId::index_range,
                "source", "shows a texel that is not covered");
    reportTexel(firstTexel([&](size_t i) { return (*coverage)[i] && (*source)[i] == kNoTexel; }), IssueId::value_range, "source",
                "is covered but shows nothing");
  }
  if (albedo)
    reportTexel(firstTexel([&](size_t i) {
                  return (*source)[i] == kNoTexel && ((*albedo)[3 * i] || (*albedo)[3 * i + 1] || (*albedo)[3 * i + 2]);
                }), IssueId::value_range, "albedo", "shows nothing but is not zero");
  if (emission)
    reportTexel(firstTexel([&](size_t i) { return (*source)[i] == kNoTexel && (*emission)[i] != 0; }), IssueId::value_range, "emission",
                "shows nothing but is not zero");
}

}  // namespace lightwell::format
