#include "precompute/transport/radiosity/bake_radiosity.h"

#include "precompute/core/random.h"
#include "precompute/transport/exposure.h"
#include "precompute/transport/radiosity/patch_bytes.h"
#include "precompute/transport/radiosity/sealed_rooms.h"
#include "precompute/transport/stage_bytes.h"

namespace lightwell::transport {
namespace {

constexpr uint64_t kTrainingSeed = 0x7ea1717e5ull;  // apart from the seeds that errors are measured with

void write(ByteWriter& writer, const RadiosityTraining::Matrix& matrix) { writer.array(std::span<const float>(matrix.data(), size_t(matrix.size()))); }

RadiosityTraining::Matrix readMatrix(ByteReader& reader, size_t rows) {
  const auto values = reader.array<float>();
  require(rows > 0 && values.size() % rows == 0);
  return Eigen::Map<const RadiosityTraining::Matrix>(values.data(), Eigen::Index(rows), Eigen::Index(values.size() / rows));
}

}  // namespace

struct RadiosityBaker::Impl {
  const scene::Scene& scene;
  const atlas::Atlas& atlas;
  const trace::Tracer& tracer;
  RadiositySettings settings;
  Sides sides;
  std::vector<float> exposed;  // per side
  Patches patches;
  PatchTree tree;
  std::vector<PriorLight> lights;
  std::unique_ptr<trace::Tracer> open_tracer;  // with all portals open; null without portals
  std::unique_ptr<GatedTracer> gated_tracer;
};

namespace {

std::unique_ptr<trace::Tracer> openTracer(const scene::Scene& scene, int threads) {
  return scene.portals.empty() ? nullptr : std::make_unique<trace::Tracer>(scene, threads, std::vector<float>(scene.portals.size(), 1.0f));
}

/// What a shut leaf hides, as a threshold, is in the open for the light that comes when it opens. Leaves themselves are there only while they are shut.
std::vector<float> exposedShareOfGated(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const Sides& sides,
                                       const RadiositySettings& settings, int threads, const CancelFlag* cancel) {
  auto exposed = exposedShare(scene, atlas, tracer, sides, settings.seed, threads, cancel);
  const auto open_tracer = openTracer(scene, threads);
  if (!open_tracer) return exposed;
  const auto exposed_open = exposedShare(scene, atlas, *open_tracer, sides, settings.seed, threads, cancel);
  const auto zones = PortalZones(scene).ofSides(atlas, sides, settings.patches.coarsest);
  for (size_t side = 0; side < exposed.size(); ++side)
    if (zones[side].kind != PortalZone::leaf) exposed[side] = exposed_open[side];
  return exposed;
}

void write(ByteWriter& writer, const GateSets& sets) {
  writer.array(sets.first());
  writer.array(sets.entries());
}

GateSets readSets(ByteReader& reader) {
  const auto first = reader.array<uint32_t>();
  GateSets sets;
  require(sets.assign(first, reader.array<GateEntry>()));
  return sets;
}

/// Per element a set of `sets`, or nothing at all.
std::vector<uint32_t> readSetNumbers(ByteReader& reader, size_t count, const GateSets& sets) {
  auto numbers = reader.array<uint32_t>();
  require(numbers.empty() || numbers.size() == count);
  for (const uint32_t set : numbers) require(set < sets.count());
  return numbers;
}

}  // namespace

Bytes makePatchBytes(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const RadiositySettings& settings, int threads,
                     const CancelFlag* cancel) {
  const Sides sides = surfaceSides(atlas);
  const auto exposed = exposedShareOfGated(scene, atlas, tracer, sides, settings, threads, cancel);
  PatchOptions options = settings.patches;
  options.seed = settings.seed;
  options.threads = threads;
  options.cancel = cancel;
  return patchBytes({exposed, makePatches(scene, atlas, tracer, sides, exposed, options)});
}

RadiosityBaker::RadiosityBaker(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const RadiositySettings& settings,
                               ByteView bytes)
    : impl_(new Impl{scene, atlas, tracer, settings, surfaceSides(atlas), {}, {}, {}, {}, openTracer(scene, 0), {}}) {
  ExposedPatches read = readPatches(bytes, impl_->sides.slot.size());
  impl_->exposed = std::move(read.exposed);
  Patches& patches = impl_->patches = std::move(read.patches);
  colorPatches(atlas, impl_->sides, impl_->exposed, patches);
  zonePatches(scene, atlas, impl_->sides, settings.patches, patches);
  impl_->gated_tracer = std::make_unique<GatedTracer>(scene, atlas, tracer, impl_->open_tracer.get(), impl_->sides, patches);
  impl_->tree = makePatchTree(patches);
  impl_->lights = samplePriorLights(scene, atlas, tracer, settings.training_lights, combineKeys(settings.seed, kTrainingSeed));
}

RadiosityBaker::~RadiosityBaker() = default;

uint32_t RadiosityBaker::patchCount() const { return impl_->patches.count(); }
uint32_t RadiosityBaker::trainingLightCount() const { return uint32_t(impl_->lights.size()); }
const Sides& RadiosityBaker::sides() const { return impl_->sides; }
const Patches& RadiosityBaker::patches() const { return impl_->patches; }
const PatchTree& RadiosityBaker::tree() const { return impl_->tree; }
const GatedTracer& RadiosityBaker::tracer() const { return *impl_->gated_tracer; }

Bytes RadiosityBaker::hits(uint32_t first, uint32_t end) const {
  const HitCounts counts =
      countHits(impl_->scene, impl_->atlas, *impl_->gated_tracer, impl_->sides, impl_->patches, impl_->settings.rays, impl_->settings.seed, first, end);
  ByteWriter writer;
  writer.array(counts.first);
  writer.array(counts.patch);
  writer.array(counts.count);
  write(writer, counts.sets);
  writer.array(counts.set);
  return writer.take();
}

Bytes RadiosityBaker::direct(uint32_t first, uint32_t end) const {
  ByteWriter writer;
  for (uint32_t i = first; i < end; ++i) {
    const trace::Tracer& tracer = impl_->open_tracer && isTrainedOpen(i) ? *impl_->open_tracer : impl_->tracer;
    writer.array(patchIrradiance(impl_->scene, impl_->atlas, tracer, impl_->sides, impl_->patches, impl_->lights[i].light, impl_->settings.seed));
  }
  return writer.take();
}

Bytes RadiosityBaker::train(std::span<const ByteView> hits, std::span<const ByteView> direct) const {
  HitCounts counts;
  for (const ByteView bytes : hits) {
    ByteReader reader(bytes);
    HitCounts part;
    part.first = reader.array<uint64_t>();
    part.patch = reader.array<uint32_t>();
    part.count = reader.array<uint32_t>();
    requireRows(part.first, part.patch.size());
    require(part.count.size() == part.patch.size());
    for (const uint32_t patch : part.patch) require(patch < patchCount());
    part.sets = readSets(reader);
    part.set = readSetNumbers(reader, part.patch.size(), part.sets);
    require(part.set.empty() == (impl_->patches.zone.empty() || part.patch.empty()));
    counts.append(part);
  }
  counts.sort();
  require(counts.first.size() == size_t(patchCount()) + 1);
  std::vector<std::vector<float>> irradiance;
  for (const ByteView bytes : direct)
    for (ByteReader reader(bytes); !reader.empty();) {
      irradiance.push_back(reader.array<float>());
      require(irradiance.back().size() == patchCount());
    }
  const FormFactors factors = makeFormFactors(impl_->gated_tracer->zones(), impl_->patches, counts, impl_->settings.rays);
  const RadiosityTraining training = trainRadiosity(impl_->patches, factors, irradiance);
  ByteWriter writer;
  writer.array(factors.first);
  writer.array(factors.patch);
  writer.array(factors.value);
  write(writer, factors.sets);
  writer.array(factors.set);
  write(writer, training.radiosity);
  write(writer, training.irradiance);
  writer.array(training.open);
  return writer.take();
}

TrainedFactors RadiosityBaker::readTrained(ByteView trained) const {
  ByteReader reader(trained);
  TrainedFactors result;
  FormFactors& factors = result.factors;
  factors.first = reader.array<uint64_t>();
  factors.patch = reader.array<uint32_t>();
  factors.value = reader.array<float>();
  requireRows(factors.first, factors.patch.size());
  require(factors.rows() == patchCount() && factors.value.size() == factors.patch.size());
  factors.sets = readSets(reader);
  factors.set = readSetNumbers(reader, factors.patch.size(), factors.sets);
  factors.own_gate = ownGates(impl_->gated_tracer->zones(), impl_->patches);
  result.training.radiosity = readMatrix(reader, patchCount());
  result.training.irradiance = readMatrix(reader, patchCount());
  result.training.open = reader.array<char>();
  require(result.training.open.size() == (impl_->patches.zone.empty() ? 0 : result.training.lights()));
  return result;
}

Bytes RadiosityBaker::links(uint32_t first, uint32_t end, ByteView trained) const {
  const auto [factors, training] = readTrained(trained);
  LinkOptions options = impl_->settings.links;
  options.rays = impl_->settings.rays;
  const LinkValues links = makeLinks(factors, impl_->tree, training, options, first, end);
  const std::vector<uint64_t> transfers{factors.first[end] - factors.first[first]};
  ByteWriter writer;
  writer.array(links.first);
  writer.array(links.node);
  writer.array(links.value);
  write(writer, links.sets);
  writer.array(links.set);
  writer.array(transfers);
  return writer.take();
}

RadiosityResult RadiosityBaker::assemble(std::span<const ByteView> links, int threads, const CancelFlag* cancel) const {
  RadiosityResult result;
  result.patches = impl_->patches;
  result.tree = impl_->tree;
  LinkValues values;
  for (const ByteView bytes : links) {
    ByteReader reader(bytes);
    LinkValues part;
    part.first = reader.array<uint32_t>();
    part.node = reader.array<uint32_t>();
    part.value = reader.array<float>();
    part.sets = readSets(reader);
    part.set = readSetNumbers(reader, part.node.size(), part.sets);
    const auto transfers = reader.array<uint64_t>();
    requireRows(part.first, part.node.size());
    require(part.value.size() == part.node.size() && transfers.size() == 1);
    for (const uint32_t node : part.node) require(node < impl_->tree.nodeCount());
    values.append(part);
    values.sets = part.sets;
    result.raw_transfers += transfers[0];
  }
  require(values.rows() == patchCount());
  if (!values.set.empty()) values.sets = sortSets(values.sets, values.set);
  if (values.sets.count() > kMostGateSets)
    throw UsageError("the portals of " + impl_->scene.file + " have " + std::to_string(values.sets.count()) + " combinations of strips through which light passes, more than " +
                     std::to_string(kMostGateSets) + ": give them fewer strips");
  result.dark_patches = emptySealedRooms(impl_->scene, impl_->atlas, impl_->tracer, impl_->sides, impl_->patches, impl_->tree, impl_->settings.seed, values);
  balanceLinks(impl_->gated_tracer->zones(), impl_->patches, impl_->tree, values);
  result.links = quantiseLinks(values);
  const TexelWeights weights = makeTexelWeights(impl_->atlas, impl_->tracer, impl_->sides, impl_->patches, impl_->tree, threads, cancel);
  bool has_backs = false;
  for (const uint32_t slot : weights.slot) {
    result.texel.push_back(impl_->atlas.slots[slot].texel);
    result.texel_exposed.push_back(impl_->exposed[slot]);
    const uint32_t back = impl_->sides.back_of_slot[slot];
    result.texel_back_patch.push_back(back != kNone ? impl_->patches.patch_of_side[back] : kNone);
    has_backs |= result.texel_back_patch.back() != kNone;
  }
  if (!has_backs) result.texel_back_patch.clear();
  result.texel_patch = weights.patch;
  result.texel_weight = weights.weight;
  return result;
}

}  // namespace lightwell::transport
