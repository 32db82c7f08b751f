// Decoding form factors. Everything that evaluation relies on is checked here once.
#include <cmath>
#include <cstring>
#include <string_view>

#include "format/decode/pixel.h"
#include "runtime/src/radiosity.h"
#include "runtime/src/section_loader.h"

namespace lightwell::runtime {
namespace {

using format::ElementType;

constexpr uint32_t kMostMaterials = 65536, kMostGates = 32768;

/// Decodes the section "radiosity" chunk by chunk; the first failure stays in `result`.
class Loader : SectionLoader {
 public:
  Loader(const lw_container& container, lw_radiosity& radiosity) : SectionLoader(container, "radiosity"), r_(radiosity) {}

  lw_result load() {
    loadHeader();
    loadAtlas();
    loadPatches();
    makeNodes();
    loadGateSets();
    loadLinks();
    loadTexels();
    return result_;
  }

 private:
  void loadHeader() {
    const format::ChunkInfo* chunk = nullptr;
    if ((result_ = findChunk(container_, "radiosity", "header", chunk))) return;
    if (chunk->element != ElementType::bytes) return void(bad("header", "it is not a message"));
    Array<uint8_t> message;
    if ((result_ = decodeChunk(container_, *chunk, message))) return;
    format::RadiosityHeader& h = r_.header;
    if (!format::parseRadiosityHeader(message.data(), message.size(), h, nullptr, 0, nullptr, 0)) return void(bad("header", "it is not a valid message"));
    if (!h.patches || !h.texels || !h.material_count || h.material_count > kMostMaterials || h.portal_count > kMostGates)
      return void(bad("header", "its counts cannot be"));
    Array<std::string_view> names;
    Array<format::RadiosityPortal> portals;
    if (!allocate(names, h.material_count) || !allocate(portals, h.portal_count) || !allocate(r_.material_name, h.material_count) ||
        !allocate(r_.portal, h.portal_count))
      return;
    format::parseRadiosityHeader(message.data(), message.size(), h, names.data(), names.size(), portals.data(), portals.size());
    size_t bytes = names.size() + portals.size();
    for (const std::string_view name : names) bytes += name.size();
    for (const auto& portal : portals) bytes += portal.name.size();
    if (!allocate(r_.names, bytes)) return;
    uint32_t at = 0;
    const auto keep = [&](std::string_view name) {
      const uint32_t begin = at;
      if (!name.empty()) std::memcpy(&r_.names[at], name.data(), name.size());
      at += uint32_t(name.size());
      r_.names[at++] = '\0';
      return begin;
    };
    for (size_t i = 0; i < names.size(); ++i) r_.material_name[i] = keep(names[i]);
    for (size_t i = 0; i < portals.size(); ++i) {
      if (portals[i].first_gate != r_.gates || !portals[i].strips || portals[i].strips > kMostGates - r_.gates)
        return void(bad("header", "the gates of its portals cannot be"));
      const float* axis = portals[i].axis_per_m;
      if (!allFinite(axis, 3) || !std::isfinite(portals[i].offset)) return void(bad("header", "the axis of a portal is not finite"));
      r_.portal[i] = {keep(portals[i].name), portals[i].first_gate, portals[i].strips, portals[i].first_triangle, portals[i].triangles,
                      {axis[0], axis[1], axis[2]}, portals[i].offset};
      r_.gates += portals[i].strips;
    }
  }

  void loadAtlas() {
    format::AtlasHeader atlas;
    if (result_ || (result_ = readAtlasHeader(container_, atlas))) return;
    r_.width = atlas.width;
    r_.height = atlas.height;
    const uint64_t texels = uint64_t(atlas.width) * atlas.height;
    if ((result_ = decodeChunk(container_, "atlas", "source", ElementType::u32, texels, r_.source))) return;
    if (!isSourceMap(r_.source.data(), texels)) result_ = container_.host.fail(LW_BAD_SECTION, "atlas/source: a texel's source is not its own source");
  }

  void loadPatches() {
    const size_t patches = r_.header.patches;
    decode("patch_area", ElementType::f32, patches, r_.patch_area_m2);
    decode("patch_position", ElementType::f32, patches * 3, r_.patch_position_m);
    decode("patch_material", ElementType::u16, patches, r_.patch_material);
    decode("patch_albedo", ElementType::f32, patches * 3, r_.patch_albedo_rgb);
    Array<int16_t> oct;
    if (!decode("patch_normal", ElementType::i16, patches * 2, oct) || !allocate(r_.patch_normal, patches * 3) || !allocate(r_.patch_emission_rgb, patches * 3))
      return;
    Array<uint32_t> emission;
    if (r_.header.has_emission && !decode("patch_emission", ElementType::rgb9e5, patches, emission)) return;
    bool good = true;
    for (size_t i = 0; i < patches; ++i) {
      const format::Float3 n = format::unpackOct({oct[i * 2], oct[i * 2 + 1]});
      std::memcpy(&r_.patch_normal[i * 3], &n, sizeof n);
      const format::Float3 e = r_.header.has_emission ? format::unpackRgb9e5(emission[i]) : format::Float3{};
      std::memcpy(&r_.patch_emission_rgb[i * 3], &e, sizeof e);
      good &= r_.patch_area_m2[i] > 0 && std::isfinite(r_.patch_area_m2[i]) && r_.patch_material[i] < r_.header.material_count;
    }
    for (const float a : r_.patch_albedo_rgb) good &= a >= 0 && a <= kMostAlbedo;
    require(good && allFinite(r_.patch_position_m.data(), patches * 3), "patch_area", "an area, a position, an albedo or a material of a patch is out of range");
  }

  void makeNodes() {
    if (result_) return;
    uint64_t nodes = r_.header.patches, level = nodes;
    r_.levels = 1;
    r_.level_first[1] = r_.header.patches;
    if (nodes > kMostLinkNodes) return void(bad("header", "more than 2^24 patches and nodes"));
    while (level > kRadiosityBranching) {
      level = (level + kRadiosityBranching - 1) / kRadiosityBranching;
      nodes += level;
      if (nodes > kMostLinkNodes || r_.levels == kMostRadiosityLevels) return void(bad("header", "more than 2^24 patches and nodes"));
      r_.level_first[++r_.levels] = uint32_t(nodes);
    }
    // Areas first, then each one's share of its parent's.
    if (!allocate(r_.node_share, nodes)) return;
    Array<float>& share = r_.node_share;
    std::memcpy(share.data(), r_.patch_area_m2.data(), r_.patch_area_m2.bytes());
    for (uint32_t k = 1; k < r_.levels; ++k)
      for (uint32_t i = r_.level_first[k]; i < r_.level_first[k + 1]; ++i) {
        double area = 0;
        const uint32_t begin = r_.level_first[k - 1] + (i - r_.level_first[k]) * kRadiosityBranching;
        const uint32_t end = begin + kRadiosityBranching < r_.level_first[k] ? begin + kRadiosityBranching : r_.level_first[k];
        for (uint32_t c = begin; c < end; ++c) area += double(share[c]);
        for (uint32_t c = begin; c < end; ++c) share[c] = float(double(share[c]) / area);
        share[i] = float(area < 1e38 ? area : 1e38);
      }
  }

  void loadGateSets() {
    if (r_.gates) SectionLoader::loadGateSets(r_.gates, r_.gate_sets, r_.gate_set_first, r_.gate_set);
  }

  void loadLinks() {
    const size_t patches = r_.header.patches, links = size_t(elementsOf("link_node"));
    Array<uint32_t> first;
    Array<uint8_t> code;
    Array<uint16_t> gates;
    decode("link_first", ElementType::u32, patches + 1, first);
    decode("link_node", ElementType::u32, links, r_.link);
    decode("row_scale", ElementType::f32, patches, r_.row_scale);
    if (r_.gates) decode("link_gates", ElementType::u16, links, gates);
    if (!decode("link_code", ElementType::u8, links, code)) return;
    require(areOffsets(first, links), "link_first", "it does not split the links");
    bool good = true;
    for (const float s : r_.row_scale) good &= s >= 0 && s <= 1.001f / 16;  // of a row with a single link of the least weight
    require(good, "row_scale", "a value is out of range");
    const uint32_t nodes = r_.level_first[r_.levels];
    for (const uint32_t node : r_.link) good &= node < nodes;
    require(good, "link_node", "a link is to no patch or node");
    for (const uint16_t set : gates) good &= set < r_.gate_sets;
    require(good, "link_gates", "a value is no gate set");
    if (result_) return;
    for (size_t l = 0; l < links; ++l) r_.link[l] = r_.link[l] << 8 | code[l];

    size_t runs = 0;
    const auto walk = [&](auto add) {
      for (size_t row = 0; row < patches; ++row)
        for (uint32_t l = first[row], end = first[row + 1], begin = l; l < end; begin = l) {
          while (l < end && (!r_.gates || gates[l] == gates[begin])) ++l;
          add(row, LinkRun{l, r_.gates ? gates[begin] : 0u});
        }
    };
    walk([&](size_t, LinkRun) { ++runs; });
    if (!allocate(r_.run, runs) || !allocate(r_.row_first_run, patches + 1)) return;
    std::memset(r_.row_first_run.data(), 0, r_.row_first_run.bytes());
    runs = 0;
    walk([&](size_t row, LinkRun run) {
      r_.run[runs++] = run;
      r_.row_first_run[row + 1] = uint32_t(runs);
    });
    for (size_t row = 0; row < patches; ++row)
      if (r_.row_first_run[row + 1] < r_.row_first_run[row]) r_.row_first_run[row + 1] = r_.row_first_run[row];
  }

  void loadTexels() {
    const uint64_t texels = r_.header.texels;
    decode("texel", ElementType::u32, texels, r_.texel);
    decode("texel_patch", ElementType::u32, texels * 4, r_.texel_patch);
    decode("texel_weight", ElementType::u8, texels * 4, r_.texel_weight);
    decode("texel_exposed", ElementType::u8, texels, r_.texel_exposed);
    if (r_.header.has_backs) decode("texel_back_patch", ElementType::u32, texels, r_.texel_back_patch);
    if (result_) return;
    bool ascending = true, patches_good = true;
    for (size_t i = 0; i < texels; ++i) {
      ascending &= r_.texel[i] < r_.source.size() && (i == 0 || r_.texel[i] > r_.texel[i - 1]);
      patches_good &= r_.texel_patch[i * 4] != kNone;
    }
    for (const uint32_t p : r_.texel_patch) patches_good &= p < r_.header.patches || p == kNone;
    for (const uint32_t p : r_.texel_back_patch) patches_good &= p < r_.header.patches || p == kNone;
    require(ascending, "texel", "a texel is outside the atlas, or they do not ascend");
    require(patches_good, "texel_patch", "a texel belongs to no patch");
  }

  lw_radiosity& r_;
};

}  // namespace
}  // namespace lightwell::runtime

using namespace lightwell::runtime;

lw_result lw_radiosity_load(const lw_container* container, lw_radiosity** out) {
  if (!container || !out) return LW_INVALID_ARGUMENT;
  lw_radiosity* radiosity = createHandle<lw_radiosity>(container->host);
  if (!radiosity) return container->host.fail(LW_OUT_OF_MEMORY, "no memory for the handle of the form factors");
  if (const lw_result result = Loader(*container, *radiosity).load()) {
    destroyHandle(radiosity);
    return result;
  }
  *out = radiosity;
  return LW_OK;
}

void lw_radiosity_release(lw_radiosity* radiosity) { destroyHandle(radiosity); }

lw_result lw_radiosity_get_info(const lw_radiosity* radiosity, lw_radiosity_info* info) {
  if (!radiosity || !info) return LW_INVALID_ARGUMENT;
  const auto& h = radiosity->header;
  *info = {h.patches, radiosity->nodes(), uint32_t(radiosity->link.size()), h.texels, h.material_count, h.portal_count, radiosity->gates,
           h.has_emission ? 1u : 0u, h.has_backs ? 1u : 0u, radiosity->width, radiosity->height};
  return LW_OK;
}

lw_result lw_radiosity_get_patches(const lw_radiosity* radiosity, lw_radiosity_patches* patches) {
  if (!radiosity || !patches) return LW_INVALID_ARGUMENT;
  *patches = {radiosity->patch_area_m2.data(), radiosity->patch_position_m.data(), radiosity->patch_normal.data(), radiosity->patch_albedo_rgb.data(),
              radiosity->patch_emission_rgb.data(), radiosity->patch_material.data()};
  return LW_OK;
}

lw_result lw_radiosity_get_texels(const lw_radiosity* radiosity, lw_radiosity_texels* texels) {
  if (!radiosity || !texels) return LW_INVALID_ARGUMENT;
  *texels = {radiosity->texel.data(), radiosity->texel_patch.data(), radiosity->texel_weight.data(), radiosity->texel_exposed.data(),
             radiosity->texel_back_patch.empty() ? nullptr : radiosity->texel_back_patch.data()};
  return LW_OK;
}

const char* lw_radiosity_material_name(const lw_radiosity* radiosity, uint32_t material) {
  return radiosity && material < radiosity->header.material_count ? &radiosity->names[radiosity->material_name[material]] : nullptr;
}

lw_result lw_radiosity_get_portal(const lw_radiosity* radiosity, uint32_t index, lw_radiosity_portal* portal) {
  if (!radiosity || !portal) return LW_INVALID_ARGUMENT;
  if (index >= radiosity->portal.size()) return radiosity->host.fail(LW_NOT_FOUND, "the container has no portal %u", index);
  const auto& p = radiosity->portal[index];
  *portal = {&radiosity->names[p.name], p.first_gate, p.strips, p.first_triangle, p.triangles, {p.axis_per_m[0], p.axis_per_m[1], p.axis_per_m[2]}, p.offset};
  return LW_OK;
}
