#include "precompute/transport/lightmap/bake_lightmap.h"

#include <algorithm>

#include "precompute/transport/exposure.h"
#include "precompute/transport/lightmap/irradiance_cache.h"
#include "precompute/transport/lightmap/share.h"
#include "precompute/transport/measured_texels.h"
#include "precompute/transport/radiosity/patch_bytes.h"
#include "precompute/transport/reference/path_batch.h"
#include "precompute/transport/stage_bytes.h"

namespace lightwell::transport {
namespace {

constexpr double kMostRaysForBrightness = 16;
constexpr uint32_t kMeasuredTexels = 768;
constexpr uint64_t kRetracedSeed = 0x6d6f7265ull;
constexpr uint64_t kReferenceSeed = 0x6c696768746d6170ull;  // apart from the seeds of people's own references

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

void write(ByteWriter& writer, const GatheredPair& pair) {
  writer.array(pair.a_rgb);
  writer.array(pair.b_rgb);
  writer.array(pair.gradient);
}

Bytes bytesOf(const GatheredPair& pair) {
  ByteWriter writer;
  write(writer, pair);
  return writer.take();
}

void appendPair(ByteReader& reader, GatheredPair& pair) {
  append(pair.a_rgb, reader.array<Rgb>());
  append(pair.b_rgb, reader.array<Rgb>());
  const auto gradient = reader.array<Vec3>();
  pair.gradient.insert(pair.gradient.end(), gradient.begin(), gradient.end());
}

void requirePair(const GatheredPair& pair, size_t count, bool directional) {
  require(pair.a_rgb.size() == count && pair.b_rgb.size() == count && pair.gradient.size() == (directional ? count : 0));
}

Rgb meanOf(const GatheredPair& pair, size_t i) { return (pair.a_rgb[i] + pair.b_rgb[i]) * 0.5f; }

/// Per side. Without light that is soft, `soft` is empty.
struct DirectLight {
  GatheredPair hard, soft;
  Rgb mean(size_t side) const { return meanOf(hard, side) + (soft.a_rgb.empty() ? Rgb(0.0f) : meanOf(soft, side)); }
};

DirectLight readDirect(std::span<const ByteView> parts, size_t count, bool has_soft, bool directional) {
  DirectLight light;
  for (const ByteView bytes : parts) {
    ByteReader reader(bytes);
    appendPair(reader, light.hard);
    appendPair(reader, light.soft);
  }
  requirePair(light.hard, count, directional);
  requirePair(light.soft, has_soft ? count : 0, directional);
  return light;
}

GatheredPair readGathered(std::span<const ByteView> parts, size_t count, bool directional) {
  GatheredPair pair;
  for (const ByteView bytes : parts) {
    ByteReader reader(bytes);
    appendPair(reader, pair);
  }
  requirePair(pair, count, directional);
  return pair;
}

void resize(GatheredPair& pair, size_t count) {
  pair.a_rgb.resize(count);
  pair.b_rgb.resize(count);
  if (!pair.gradient.empty()) pair.gradient.resize(count);
}

/// Adds what is shared to the light of a map.
void add(const SharedLight& shared, std::vector<Rgb>& irradiance_rgb, std::vector<Vec3>& gradient) {
  irradiance_rgb.resize(shared.irradiance_rgb.size(), Rgb(0.0f));
  for (size_t i = 0; i < irradiance_rgb.size(); ++i) irradiance_rgb[i] += shared.irradiance_rgb[i];
  gradient.resize(shared.gradient.size(), Vec3(0.0f));
  for (size_t i = 0; i < gradient.size(); ++i) gradient[i] += shared.gradient[i];
}

/// From irradiance times change to change.
void normalise(const std::vector<Rgb>& irradiance_rgb, std::vector<Vec3>& gradient) {
  for (size_t i = 0; i < gradient.size(); ++i) {
    const float irradiance = luminance(irradiance_rgb[i]);
    gradient[i] = irradiance > 0.0f ? gradient[i] / irradiance : Vec3(0.0f);
  }
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
  PlainEmitters plain_emitters;
  PunctualLights punctual;
  TiltKernel tilt_kernel = {};
  const scene::Scene nothing = {};
  const Emitters no_emitters{nothing};
  const PunctualLights no_lamps{nothing.lights};
  ExposedPatches exposed_patches = {};

  const Patches& patches() const { return exposed_patches.patches; }
  const std::vector<float>& exposed() const { return exposed_patches.exposed; }
  const TiltKernel* tilt() const { return settings.directional ? &tilt_kernel : nullptr; }
  DirectSampler::Context hardLights(const CancelFlag& cancel) const {
    return {scene, atlas, tracer, sides, punctual, plain_emitters, tilt(), &cancel, settings.seed};
  }
  /// Emitters are sampled one way or the other.
  const Emitters& softEmitters() const { return plain_emitters.empty() ? emitters : no_emitters; }
  PathContext softLights(const CancelFlag& cancel) const { return {scene, atlas, tracer, softEmitters(), no_lamps, sky, Component::direct, &cancel}; }
  bool hasSoftLights() const { return sky || !softEmitters().empty(); }
  struct Refined {
    std::vector<Rgb> radiosity_rgb, direct_radiosity_rgb;  // per side
    std::vector<uint8_t> uneven;                           // per slot
    std::vector<uint32_t> rays;                            // likewise
  };
  Refined readRefined(ByteView bytes) const {
    ByteReader reader(bytes);
    Refined refined;
    refined.radiosity_rgb = reader.array<Rgb>();
    refined.direct_radiosity_rgb = reader.array<Rgb>();
    refined.uneven = reader.array<uint8_t>();
    refined.rays = reader.array<uint32_t>();
    require(refined.radiosity_rgb.size() == sides.slot.size() && refined.direct_radiosity_rgb.size() == sides.slot.size());
    require(refined.uneven.size() == sides.front_count && refined.rays.size() == sides.front_count);
    for (const uint32_t count : refined.rays) require(count >= 2 && count <= settings.gather_rays * kMostRaysForBrightness);
    return refined;
  }
  /// Of all sides or of the fronts; shared on the fronts.
  SharedLight share(GatheredPair pair, int threads, const CancelFlag& cancel) const {
    resize(pair, sides.front_count);
    return shareIrradiance(atlas, std::span(exposed()).first(sides.front_count), pair, threads, &cancel);
  }
  /// Independent maps of slots; `times`: as many paths as usual.
  std::vector<std::vector<Rgb>> traceReferences(std::span<const uint32_t> slots, uint64_t of, uint32_t times, const CancelFlag& cancel) const {
    const PathContext context{scene, atlas, tracer, emitters, punctual, sky, Component::total, &cancel};
    PathBatch batch(context);
    const uint32_t paths = times * measuringPaths(atlas);
    std::vector<std::vector<Rgb>> maps_rgb(kMeasuringReferences);
    std::vector<Rgb> path_rgb;
    std::vector<PathStart> starts;
    for (uint64_t k = 0; k < kMeasuringReferences; ++k)
      for (const uint32_t slot : slots) {
        const uint64_t seed = combineKeys(combineKeys(settings.seed, of), k);
        starts.clear();
        const uint32_t texel = atlas.slots[slot].texel;
        for (uint32_t i = 0; i < paths; ++i) starts.push_back({slot, i, Sampler(seed, texel), combineKeys(combineKeys(seed, texel), i)});
        batch.trace(starts, path_rgb);
        Vec3d sum(0.0);
        for (const Rgb& value : path_rgb) sum += Vec3d(value);
        maps_rgb[k].emplace_back(sum / double(paths));
      }
    return maps_rgb;
  }
  DirectOptions direct() const {
    DirectOptions options = settings.direct;
    options.seed = settings.seed;
    options.tilt = tilt();
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
    : impl_(new Impl{scene, atlas, tracer, sky, settings, surfaceSides(atlas), Emitters(scene), PlainEmitters(scene), PunctualLights(lights)}) {
  impl_->exposed_patches = readPatches(patches, impl_->sides.slot.size());
  colorPatches(atlas, impl_->sides, impl_->exposed(), impl_->exposed_patches.patches);
}

LightmapBaker::~LightmapBaker() = default;

uint32_t LightmapBaker::sideCount() const { return uint32_t(impl_->sides.slot.size()); }
uint32_t LightmapBaker::patchCount() const { return impl_->patches().count(); }
uint32_t LightmapBaker::slotCount() const { return impl_->sides.front_count; }

Bytes LightmapBaker::firstLight(uint32_t first, uint32_t end, const CancelFlag& cancel) const {
  return bytesOf(firstDirectLight(impl_->hardLights(cancel), impl_->direct(), first, end));
}

Bytes LightmapBaker::directLight(uint32_t first, uint32_t end, std::span<const ByteView> first_light, const CancelFlag& cancel) const {
  ByteWriter writer;
  write(writer, transport::directLight(impl_->hardLights(cancel), impl_->direct(), joined(first_light, sideCount()), first, end));
  write(writer, impl_->hasSoftLights() ? softLight(impl_->softLights(cancel), impl_->sides, impl_->direct(), first, end) : GatheredPair{});
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
  const DirectLight light = readDirect(direct, sideCount(), impl_->hasSoftLights(), impl_->settings.directional);
  std::vector<Rgb> direct_rgb(sideCount());
  for (size_t side = 0; side < direct_rgb.size(); ++side) direct_rgb[side] = light.mean(side);
  return bytesOf(sideRadiosity(impl_->atlas, impl_->tracer, impl_->sides, impl_->patches(), parts, impl_->settings.cache_rays, impl_->exposed(), direct_rgb, &cancel));
}

Bytes LightmapBaker::firstGather(uint32_t first, uint32_t end, ByteView radiosity, const CancelFlag& cancel) const {
  const auto radiosity_rgb = joined(std::span(&radiosity, 1), sideCount());
  const std::vector<uint32_t> rays(end - first, impl_->settings.first_gather_rays);
  return bytesOf(gatherSlots(impl_->scene, impl_->atlas, impl_->tracer, impl_->sides, {.radiosity_rgb = radiosity_rgb}, {.rays = rays, .seed = impl_->settings.seed}, first,
                             end, &cancel));
}

Bytes LightmapBaker::refine(std::span<const ByteView> direct, ByteView radiosity, std::span<const ByteView> first_gathered, int threads, const CancelFlag& cancel) const {
  const atlas::Atlas& atlas = impl_->atlas;
  auto radiosity_rgb = joined(std::span(&radiosity, 1), sideCount());
  const DirectLight light = readDirect(direct, sideCount(), impl_->hasSoftLights(), impl_->settings.directional);
  const auto indirect_rgb = impl_->share(readGathered(first_gathered, slotCount(), false), threads, cancel).irradiance_rgb;
  std::vector<Rgb> direct_radiosity_rgb(sideCount(), Rgb(0.0f));
  for (uint32_t side = 0; side < sideCount(); ++side) {
    const float exposed = impl_->exposed()[side];
    if (!(exposed > 0.0f)) continue;
    // Rays end on what is in the open.
    const Rgb albedo_rgb = atlas.slots[impl_->sides.slot[side]].albedo_rgb / exposed;
    direct_radiosity_rgb[side] = albedo_rgb * meanOf(light.hard, side);
    if (side < slotCount()) radiosity_rgb[side] = albedo_rgb * (light.mean(side) + indirect_rgb[side]);
  }
  std::vector<Rgb> hard_rgb(slotCount());
  for (uint32_t slot = 0; slot < slotCount(); ++slot) hard_rgb[slot] = meanOf(light.hard, slot);
  // Where it is brighter than on the mean, an error counts for more.
  double sum = 0, area = 0;
  for (uint32_t slot = 0; slot < slotCount(); ++slot) sum += luminance(indirect_rgb[slot]) * double(atlas.slots[slot].area), area += atlas.slots[slot].area;
  const double mean = sum / std::max(area, 1e-30);
  std::vector<uint32_t> rays;
  for (uint32_t slot = 0; slot < slotCount(); ++slot) {
    const double brightness = mean > 0 ? std::clamp(luminance(indirect_rgb[slot]) / mean, 1.0, kMostRaysForBrightness) : 1.0;
    rays.push_back(uint32_t(impl_->settings.gather_rays * brightness) & ~1u);
  }
  ByteWriter writer;
  writer.array(radiosity_rgb);
  writer.array(direct_radiosity_rgb);
  writer.array(unevenSlots(impl_->scene.mesh, atlas, impl_->punctual, hard_rgb));
  writer.array(rays);
  return writer.take();
}

Bytes LightmapBaker::gather(uint32_t first, uint32_t end, ByteView refined, const CancelFlag& cancel) const {
  const auto [radiosity_rgb, direct_radiosity_rgb, uneven, rays] = impl_->readRefined(refined);
  DirectSampler::Context lights = impl_->hardLights(cancel);
  lights.tilt = nullptr;
  DirectSampler direct(lights);
  return bytesOf(gatherSlots(impl_->scene, impl_->atlas, impl_->tracer, impl_->sides,
                             {.radiosity_rgb = radiosity_rgb, .direct_radiosity_rgb = direct_radiosity_rgb, .uneven = uneven, .direct = &direct},
                             {.rays = std::span(rays).subspan(first, end - first), .round = 1, .tilt = impl_->tilt(), .seed = impl_->settings.seed}, first, end, &cancel));
}

uint32_t LightmapBaker::referenceCount() const { return std::min(slotCount(), kMeasuredTexels); }

Bytes LightmapBaker::references(uint32_t first, uint32_t end, ByteView refined, const CancelFlag& cancel) const {
  const auto chosen = chooseTexels(impl_->readRefined(refined).rays, kMeasuredTexels, impl_->settings.seed);
  const auto count = uint32_t(chosen.slot.size());  // fewer than asked for when one was chosen twice
  const auto slots = std::span(chosen.slot).subspan(std::min(first, count), std::min(end, count) - std::min(first, count));
  ByteWriter writer;
  for (const auto& map_rgb : impl_->traceReferences(slots, kReferenceSeed, 1, cancel)) writer.array(map_rgb);
  return writer.take();
}

PooledError LightmapBaker::measure(const Lightmap& map, ByteView refined, std::span<const ByteView> references, const CancelFlag& cancel) const {
  const auto chosen = chooseTexels(impl_->readRefined(refined).rays, kMeasuredTexels, impl_->settings.seed);
  std::vector<std::vector<Rgb>> reference_rgb(kMeasuringReferences);
  for (const ByteView part : references) {
    ByteReader reader(part);
    for (auto& values : reference_rgb) append(values, reader.array<Rgb>());
  }
  for (const auto& values : reference_rgb) require(values.size() == chosen.slot.size());
  std::vector<Rgb> candidate_rgb;
  for (const uint32_t slot : chosen.slot) candidate_rgb.push_back(map.direct_rgb[slot] + map.indirect_rgb[slot]);
  return compareWithReferences(reference_rgb, candidate_rgb, chosen.weight, [&](std::span<const uint32_t> some) {
    std::vector<uint32_t> slots;
    for (const uint32_t texel : some) slots.push_back(chosen.slot[texel]);
    return impl_->traceReferences(slots, kRetracedSeed, kRetracedPaths, cancel);
  });
}

Lightmap LightmapBaker::assemble(std::span<const ByteView> direct, std::span<const ByteView> gathered, int threads, const CancelFlag& cancel) const {
  Lightmap map;
  const auto share = [&](GatheredPair pair) { return impl_->share(std::move(pair), threads, cancel); };
  const DirectLight light = readDirect(direct, sideCount(), impl_->hasSoftLights(), impl_->settings.directional);
  add(share(light.hard), map.direct_rgb, map.direct_gradient);
  if (impl_->hasSoftLights()) add(share(light.soft), map.direct_rgb, map.direct_gradient);
  add(share(readGathered(gathered, slotCount(), impl_->settings.directional)), map.indirect_rgb, map.indirect_gradient);
  normalise(map.direct_rgb, map.direct_gradient);
  normalise(map.indirect_rgb, map.indirect_gradient);
  return map;
}

}  // namespace lightwell::transport
