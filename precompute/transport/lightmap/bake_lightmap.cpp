#include "precompute/transport/lightmap/bake_lightmap.h"

#include "precompute/transport/exposure.h"
#include "precompute/transport/lightmap/irradiance_cache.h"
#include "precompute/transport/lightmap/share.h"
#include "precompute/transport/radiosity/patch_bytes.h"
#include "precompute/transport/stage_bytes.h"

namespace lightwell::transport {
namespace {

void append(std::vector<Rgb>& to, const std::vector<Rgb>& values) { to.insert(to.end(), values.begin(), values.end()); }

std::vector<Rgb> joined(std::span<const ByteView> parts, size_t count) {
  std::vector<Rgb> values;
  for (const ByteView part : parts) append(values, ByteReader(part).array<Rgb>());
  require(values.size() == count);
  return values;
}

template <class T>
Bytes bytesOf(const std::vector<T>& values) {
  ByteWriter writer;
  writer.array(values);
  return writer.take();
}

/// Per side. Without emitters and a sky, nothing is soft.
struct DirectLight {
  std::vector<Rgb> lamps_rgb;
  GatheredPair soft;
};

DirectLight readDirect(std::span<const ByteView> parts, size_t count, bool has_soft) {
  DirectLight light;
  for (const ByteView bytes : parts) {
    ByteReader reader(bytes);
    append(light.lamps_rgb, reader.array<Rgb>());
    append(light.soft.a_rgb, reader.array<Rgb>());
    append(light.soft.b_rgb, reader.array<Rgb>());
  }
  require(light.lamps_rgb.size() == count && light.soft.a_rgb.size() == (has_soft ? count : 0) && light.soft.b_rgb.size() == light.soft.a_rgb.size());
  return light;
}

}  // namespace

struct LightmapBaker::Impl {
  const scene::Scene& scene;
  const atlas::Atlas& atlas;
  const trace::Tracer& tracer;
  const SkyLight* sky;
  LightmapSettings settings;
  Sides sides;
  Emitters emitters;
  PunctualLights punctual;
  const scene::Scene nothing = {};
  const Emitters no_emitters{nothing};
  const PunctualLights no_lamps{nothing.lights};
  ExposedPatches exposed_patches = {};

  const Patches& patches() const { return exposed_patches.patches; }
  const std::vector<float>& exposed() const { return exposed_patches.exposed; }
  PathContext lamps(const CancelFlag& cancel) const { return {scene, atlas, tracer, no_emitters, punctual, nullptr, Component::direct, &cancel}; }
  PathContext softLights(const CancelFlag& cancel) const { return {scene, atlas, tracer, emitters, no_lamps, sky, Component::direct, &cancel}; }
  bool hasSoftLights() const { return sky || !emitters.empty(); }
  DirectOptions direct() const {
    DirectOptions options = settings.direct;
    options.seed = settings.seed;
    return options;
  }
};

Bytes makeLightmapPatchBytes(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const LightmapSettings& settings, int threads,
                             const CancelFlag* cancel) {
  const Sides sides = surfaceSides(atlas);
  const auto exposed = exposedShare(scene, atlas, tracer, sides, settings.seed, threads, cancel);
  PatchOptions options = settings.patches;
  options.seed = settings.seed;
  options.threads = threads;
  options.cancel = cancel;
  return patchBytes({exposed, makePatches(scene, atlas, tracer, sides, exposed, options)});
}

LightmapBaker::LightmapBaker(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const std::vector<scene::Light>& lights,
                             const SkyLight* sky, const LightmapSettings& settings, ByteView patches)
    : impl_(new Impl{scene, atlas, tracer, sky, settings, surfaceSides(atlas), Emitters(scene), PunctualLights(lights)}) {
  impl_->exposed_patches = readPatches(patches, impl_->sides.slot.size());
  colorPatches(atlas, impl_->sides, impl_->exposed(), impl_->exposed_patches.patches);
}

LightmapBaker::~LightmapBaker() = default;

uint32_t LightmapBaker::sideCount() const { return uint32_t(impl_->sides.slot.size()); }
uint32_t LightmapBaker::patchCount() const { return impl_->patches().count(); }
uint32_t LightmapBaker::slotCount() const { return impl_->sides.front_count; }

Bytes LightmapBaker::firstLight(uint32_t first, uint32_t end, const CancelFlag& cancel) const {
  return bytesOf(firstDirectLight(impl_->lamps(cancel), impl_->sides, impl_->direct(), first, end));
}

Bytes LightmapBaker::directLight(uint32_t first, uint32_t end, std::span<const ByteView> first_light, const CancelFlag& cancel) const {
  DirectLight light;
  light.lamps_rgb = transport::directLight(impl_->lamps(cancel), impl_->sides, impl_->direct(), joined(first_light, sideCount()), first, end);
  if (impl_->hasSoftLights()) light.soft = softLight(impl_->softLights(cancel), impl_->sides, impl_->direct(), first, end);
  ByteWriter writer;
  writer.array(light.lamps_rgb);
  writer.array(light.soft.a_rgb);
  writer.array(light.soft.b_rgb);
  return writer.take();
}

Bytes LightmapBaker::rows(uint32_t first, uint32_t end) const {
  const CacheRows rows = cacheRows(impl_->scene, impl_->atlas, impl_->tracer, impl_->sides, impl_->patches(), impl_->settings.cache_rays, impl_->settings.seed, first, end);
  ByteWriter writer;
  writer.array(rows.first);
  writer.array(rows.patch);
  writer.array(rows.count);
  return writer.take();
}

Bytes LightmapBaker::radiosity(std::span<const ByteView> direct, std::span<const ByteView> rows, const CancelFlag& cancel) const {
  std::vector<CacheRows> parts;
  size_t count = 0;
  for (const ByteView bytes : rows) {
    ByteReader reader(bytes);
    CacheRows& part = parts.emplace_back();
    part.first = reader.array<uint32_t>();
    part.patch = reader.array<uint32_t>();
    part.count = reader.array<uint16_t>();
    requireRows(part.first, part.patch.size());
    require(part.count.size() == part.patch.size());
    for (const uint32_t patch : part.patch) require(patch < patchCount());
    count += part.first.size() - 1;
  }
  require(count == patchCount());
  DirectLight light = readDirect(direct, sideCount(), impl_->hasSoftLights());
  for (size_t side = 0; side < light.soft.a_rgb.size(); ++side) light.lamps_rgb[side] += (light.soft.a_rgb[side] + light.soft.b_rgb[side]) * 0.5f;
  return bytesOf(sideRadiosity(impl_->atlas, impl_->tracer, impl_->sides, impl_->patches(), parts, impl_->settings.cache_rays, impl_->exposed(),
                               light.lamps_rgb, &cancel));
}

Bytes LightmapBaker::gather(uint32_t first, uint32_t end, ByteView radiosity, const CancelFlag& cancel) const {
  const auto radiosity_rgb = joined(std::span(&radiosity, 1), sideCount());
  const GatheredPair pair = gatherSlots(impl_->scene, impl_->atlas, impl_->tracer, impl_->sides, radiosity_rgb, impl_->settings.gather_rays, impl_->settings.seed,
                                        first, end, &cancel);
  ByteWriter writer;
  writer.array(pair.a_rgb);
  writer.array(pair.b_rgb);
  return writer.take();
}

Lightmap LightmapBaker::assemble(std::span<const ByteView> direct, std::span<const ByteView> gathered, int threads, const CancelFlag& cancel) const {
  Lightmap map;
  const auto exposed = std::span(impl_->exposed()).first(slotCount());
  DirectLight light = readDirect(direct, sideCount(), impl_->hasSoftLights());
  map.direct_rgb = std::move(light.lamps_rgb);
  map.direct_rgb.resize(slotCount());
  if (impl_->hasSoftLights()) {
    light.soft.a_rgb.resize(slotCount());
    light.soft.b_rgb.resize(slotCount());
    const auto soft_rgb = shareIrradiance(impl_->atlas, exposed, light.soft, threads, &cancel);
    for (uint32_t slot = 0; slot < slotCount(); ++slot) map.direct_rgb[slot] += soft_rgb[slot];
  }
  GatheredPair pair;
  for (const ByteView bytes : gathered) {
    ByteReader reader(bytes);
    const auto a_rgb = reader.array<Rgb>(), b_rgb = reader.array<Rgb>();
    require(a_rgb.size() == b_rgb.size());
    append(pair.a_rgb, a_rgb);
    append(pair.b_rgb, b_rgb);
  }
  require(pair.a_rgb.size() == slotCount());
  map.indirect_rgb = shareIrradiance(impl_->atlas, exposed, pair, threads, &cancel);
  return map;
}

}  // namespace lightwell::transport
