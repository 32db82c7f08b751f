#include "precompute/transport/prm/bake_prm.h"

#include <algorithm>
#include <mutex>

#include "precompute/core/random.h"
#include "precompute/transport/prm/entry_irradiance.h"
#include "precompute/transport/prm/panes.h"
#include "precompute/transport/prm/probe_basis.h"
#include "precompute/transport/reference/reference.h"

namespace lightwell::transport {
namespace {

// Normals within one block of texels span at most this chord along each axis, as in entry clusters: what faces elsewhere sees another light.
constexpr float kBlockNormalExtent = 0.5f;
// An object is lit by a probe or two: no neighbours' errors even theirs out, as texels' do.
constexpr float kProbeRankShare = 0.25f, kProbeStepShare = 0.5f;
constexpr uint64_t kTrainingSeed = 0x7ea1717e5ull, kReachSeed = 0x4eac4ull;  // apart from the seeds that errors are measured with
constexpr uint32_t kReachLights = 512;

void writeMatrix(ByteWriter& writer, const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>& matrix) {
  writer.array(std::span<const float>(matrix.data(), size_t(matrix.size())));
}

Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> readMatrix(ByteReader& reader, Eigen::Index rows, Eigen::Index columns) {
  const auto values = reader.array<float>();
  if (values.size() != size_t(rows * columns)) throw std::runtime_error("a task result is damaged");
  return Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(values.data(), rows, columns);
}

void writeRows(ByteWriter& writer, const ClusterRows& rows) {
  writer.array(rows.first);
  writer.array(rows.cluster);
  writer.array(rows.transfer_rgb);
}

ClusterRows readRows(ByteReader& reader) {
  ClusterRows rows;
  rows.first = reader.array<uint32_t>();
  rows.cluster = reader.array<uint32_t>();
  rows.transfer_rgb = reader.array<Rgb>();
  if (rows.first.empty() || rows.first.back() != rows.cluster.size() || rows.cluster.size() != rows.transfer_rgb.size())
    throw std::runtime_error("a task result is damaged");
  return rows;
}

void writeBlock(ByteWriter& writer, const BasisBlock& block) {
  const uint32_t rank = block.rank;
  writer.array(std::span<const uint32_t>(&rank, 1));
  writer.array(block.basis);
  writer.array(block.scale);
  writer.array(block.link_wavelet);
  writer.array(block.coefficient);
}

void readBlock(ByteReader& reader, PrmBlocks& blocks) {
  const auto append = [&](auto& values) {
    const auto more = reader.array<typename std::decay_t<decltype(values)>::value_type>();
    values.insert(values.end(), more.begin(), more.end());
  };
  blocks.block_rank.push_back(uint8_t(reader.array<uint32_t>().at(0)));
  append(blocks.basis);
  append(blocks.scale);
  append(blocks.link_wavelet);
  append(blocks.coefficient);
  blocks.block_first_link.push_back(uint32_t(blocks.link_wavelet.size()));
}

/// The entries of clusters [first, end).
PrmEntries entriesOf(const PrmEntries& all, uint32_t first, uint32_t end) {
  const uint32_t begin_entry = all.cluster_first_entry[first], end_entry = all.cluster_first_entry[end];
  const auto part = [&](const auto& values) { return std::decay_t<decltype(values)>(values.begin() + begin_entry, values.begin() + end_entry); };
  PrmEntries result{part(all.position), part(all.normal), part(all.half_u), part(all.half_v), part(all.weight), {}};
  for (uint32_t c = first; c <= end; ++c) result.cluster_first_entry.push_back(all.cluster_first_entry[c] - begin_entry);
  return result;
}

/// What `solve` hands to `fit`.
struct Solved {
  MultiBounce multi_bounce;
  TrainingLights training;
  EmitterLight emitters;
  std::vector<Rgb> group_emitted_rgb;  // direct; panes only
};

}  // namespace

struct PrmBaker::Impl {
  const scene::Scene& scene;
  const atlas::Atlas& atlas;
  const trace::Tracer& tracer;
  PrmSettings settings;
  Sides sides;
  EntryClusters clusters;
  Gatherer gatherer;
  Partition blocks;  // of the atlas's slots
  WaveletIndex wavelets;
  std::vector<PriorLight> training_lights;
  bool has_emitters = false, grey = true;

  Impl(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const PrmSettings& settings,
       EntryClusters entry_clusters)
      : scene(scene), atlas(atlas), tracer(tracer), settings(settings), sides(surfaceSides(atlas)),
        clusters(std::move(entry_clusters)), gatherer(scene, atlas, tracer, sides, clusters, settings.seed), wavelets(clusters) {
    std::vector<SurfaceElement> elements;
    for (const auto& slot : atlas.slots) elements.push_back({slot.position, slot.normal});
    const size_t aim = std::max<size_t>(1, elements.size() / std::max(1u, settings.bases.block_texels));
    blocks = partitionByCount(elements, aim, kBlockNormalExtent, 3 * size_t(settings.bases.block_texels) / 2);
    for (const auto& slot : atlas.slots) grey = grey && slot.albedo_rgb.x == slot.albedo_rgb.y && slot.albedo_rgb.y == slot.albedo_rgb.z;
    if (settings.layout == PrmLayoutKind::local_bases)
      training_lights = samplePriorLights(scene, atlas, tracer, settings.prior, settings.training_lights, combineKeys(settings.seed, kTrainingSeed));
    has_emitters = std::any_of(atlas.slots.begin(), atlas.slots.end(), [](const auto& slot) { return maxComponent(slot.emitted_radiance_rgb) > 0; });
  }

  std::vector<uint32_t> slotsOf(uint32_t block) const {
    std::vector<uint32_t> slots;
    for (uint32_t i = blocks.first[block]; i < blocks.first[block + 1]; ++i) slots.push_back(blocks.order[i]);
    std::sort(slots.begin(), slots.end());
    return slots;
  }

  std::vector<Rgb> emitterOnClusters(std::span<const ByteView> emitter) const {
    std::vector<Rgb> side_rgb;
    for (const auto& part : emitter) {
      ByteReader reader(part);
      const auto values = reader.array<Rgb>();
      side_rgb.insert(side_rgb.end(), values.begin(), values.end());
    }
    std::vector<Rgb> result(clusters.cluster_count + clusters.group_count, Rgb(0.0f));
    for (uint32_t c = 0; c < clusters.cluster_count; ++c) {
      for (uint32_t i = clusters.cluster_first_side[c]; i < clusters.cluster_first_side[c + 1]; ++i) {
        const uint32_t side = clusters.cluster_side[i];
        result[c] += side_rgb[side] * atlas.slots[sides.slot[side]].area;
      }
      result[clusters.cluster_count + clusters.group_of_cluster[c]] += result[c];
      result[c] /= clusters.area[c];
    }
    for (uint32_t g = 0; g < clusters.group_count; ++g) result[clusters.cluster_count + g] /= clusters.area[clusters.cluster_count + g];
    return result;
  }

  /// Reads what is as large as all the rest together, once for all tasks that come with the same bytes. May be called on any thread.
  std::shared_ptr<const Solved> solvedFrom(const std::shared_ptr<const Bytes>& bytes) const {
    const std::lock_guard lock(solved_mutex);
    if (solved_bytes != bytes) {
      solved = std::make_shared<const Solved>(readSolved(*bytes));
      solved_bytes = bytes;
    }
    return solved;
  }

  mutable std::mutex solved_mutex;
  mutable std::shared_ptr<const Bytes> solved_bytes;
  mutable std::shared_ptr<const Solved> solved;

  Solved readSolved(ByteView bytes) const {
    Solved solved;
    ByteReader reader(bytes);
    const Eigen::Index groups = clusters.group_count, lights = Eigen::Index(training_lights.size());
    solved.multi_bounce.rows = readRows(reader);
    for (auto& matrix : solved.multi_bounce.solution) matrix = readMatrix(reader, groups, groups);
    solved.training.count = uint32_t(lights);
    solved.training.grey = grey;
    solved.training.total = readMatrix(reader, clusters.cluster_count, lights);
    solved.training.weight = reader.array<float>();
    solved.training.wavelet_unit = reader.array<uint8_t>();
    const auto gains = reader.array<float>();
    if (gains.size() != 4) throw std::runtime_error("a task result is damaged");
    solved.training.mean_unit = gains[0], solved.training.channel_gain = Rgb(gains[1], gains[2], gains[3]);
    solved.emitters.cluster_rgb = reader.array<Rgb>();
    solved.group_emitted_rgb = reader.array<Rgb>();
    return solved;
  }
};

bool mergesUnreached(const PrmSettings& settings) {
  return settings.merge_unreached && settings.layout == PrmLayoutKind::local_bases && settings.prior.places != LightPrior::Places::anywhere;
}

EntryClusters makePrmEntries(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const PrmSettings& settings, int threads,
                             const CancelFlag* cancel) {
  std::vector<PriorLight> lights;
  if (mergesUnreached(settings))
    lights = samplePriorLights(scene, atlas, tracer, settings.prior, std::max(kReachLights, uint32_t(scene.lights.size())), combineKeys(settings.seed, kReachSeed));
  return makeEntries(scene, atlas, tracer, settings.entries, lights, settings.seed, threads, cancel);
}

PrmBaker::PrmBaker(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const PrmSettings& settings)
    : PrmBaker(scene, atlas, tracer, settings, makePrmEntries(scene, atlas, tracer, settings)) {}
PrmBaker::PrmBaker(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const PrmSettings& settings,
                   EntryClusters clusters)
    : impl_(std::make_unique<Impl>(scene, atlas, tracer, settings, std::move(clusters))) {}
PrmBaker::~PrmBaker() = default;

uint32_t PrmBaker::groupCount() const { return impl_->clusters.group_count; }
const EntryClusters& PrmBaker::clusters() const { return impl_->clusters; }
uint32_t PrmBaker::trainingLightCount() const { return uint32_t(impl_->training_lights.size()); }
uint32_t PrmBaker::sideCount() const { return uint32_t(impl_->sides.slot.size()); }
uint32_t PrmBaker::blockCount() const { return impl_->blocks.count(); }
uint32_t PrmBaker::probeCount() const { return uint32_t(impl_->settings.probes.size()); }
bool PrmBaker::hasEmitters() const { return impl_->has_emitters; }

Bytes PrmBaker::oneBounce(uint32_t first, uint32_t end) const {
  const auto& clusters = impl_->clusters;
  ClusterRows rows;
  for (uint32_t c = clusters.group_first_cluster[first]; c < clusters.group_first_cluster[end]; ++c)
    rows.append(impl_->gatherer.mean(clusters.sidesOf(c), impl_->settings.cluster_rays, c));
  ByteWriter writer;
  writeRows(writer, rows);
  return writer.take();
}

Bytes PrmBaker::trainingDirect(uint32_t first, uint32_t end) const {
  ByteWriter writer;
  const PrmEntries entries = entriesOf(impl_->clusters.entries, 0, impl_->clusters.cluster_count);
  for (uint32_t light = first; light < end; ++light) {
    const auto irradiance_rgb = clusterIrradiance(entries, impl_->tracer, impl_->training_lights[light].light);
    std::vector<float> irradiance;
    for (const auto& value : irradiance_rgb) irradiance.push_back(value.x);  // training lights are grey
    writer.array(irradiance);
  }
  return writer.take();
}

Bytes PrmBaker::emitterDirect(uint32_t first, uint32_t end) const {
  const auto& impl = *impl_;
  std::vector<Rgb> irradiance_rgb;
  const uint32_t front_end = std::min(end, impl.sides.front_count);
  if (first < front_end) {
    ReferenceOptions options;
    options.samples = impl.settings.emitter_samples;
    options.seed = impl.settings.seed;
    options.threads = 1;
    irradiance_rgb = referenceIrradianceRange(impl.scene, impl.atlas, impl.tracer, {}, Component::direct, options, first, front_end).irradiance_rgb;
  }
  for (uint32_t side = std::max(first, front_end); side < end; ++side)
    irradiance_rgb.push_back(impl.gatherer.emittedIrradiance(side, impl.settings.bases.rays));
  ByteWriter writer;
  writer.array(irradiance_rgb);
  return writer.take();
}

Bytes PrmBaker::solve(std::span<const ByteView> one_bounce, std::span<const ByteView> training, std::span<const ByteView> emitter) const {
  const auto& clusters = impl_->clusters;
  ClusterRows rows;
  for (const auto& part : one_bounce) {
    ByteReader reader(part);
    rows.append(readRows(reader));
  }
  if (rows.first.size() != size_t(clusters.cluster_count) + 1) throw std::runtime_error("a task result is damaged");
  const MultiBounce multi_bounce = solveMultiBounce(clusters, std::move(rows));
  std::vector<std::vector<float>> direct;
  for (const auto& part : training)
    for (ByteReader reader(part); !reader.empty();) direct.push_back(reader.array<float>());
  const TrainingLights lights = makeTrainingLights(clusters, impl_->wavelets, multi_bounce, impl_->grey, direct);

  EmitterLight emitters;
  std::vector<Rgb> group_emitted_rgb;
  if (impl_->has_emitters) {
    const auto emitted_rgb = impl_->emitterOnClusters(emitter);
    emitters.cluster_rgb.assign(emitted_rgb.begin(), emitted_rgb.begin() + clusters.cluster_count);
    group_emitted_rgb.assign(emitted_rgb.begin() + clusters.cluster_count, emitted_rgb.end());
    for (int channel = 0; channel < 3; ++channel) {
      RowMajorMatrix direct(clusters.cluster_count, 1);
      for (uint32_t c = 0; c < clusters.cluster_count; ++c) direct(c, 0) = emitters.cluster_rgb[c][channel];
      const RowMajorMatrix received = multi_bounce.received(channel, clusters, direct);
      for (uint32_t c = 0; c < clusters.cluster_count; ++c) emitters.cluster_rgb[c][channel] += received(c, 0);
    }
  }
  ByteWriter writer;
  writeRows(writer, multi_bounce.rows);
  for (const auto& matrix : multi_bounce.solution) writeMatrix(writer, matrix);
  writeMatrix(writer, lights.total);
  writer.array(lights.weight);
  writer.array(lights.wavelet_unit);
  const std::array gains{lights.mean_unit, lights.channel_gain.x, lights.channel_gain.y, lights.channel_gain.z};
  writer.array(std::span<const float>(gains));
  writer.array(emitters.cluster_rgb);
  writer.array(group_emitted_rgb);
  return writer.take();
}

Bytes PrmBaker::fit(uint32_t first, uint32_t end, const SharedBytes& solved_bytes) const {
  const auto& impl = *impl_;
  const auto shared = impl.solvedFrom(solved_bytes);
  const Solved& solved = *shared;
  std::vector<WalkVertex> walks;
  if (impl.settings.layout == PrmLayoutKind::panes && impl.settings.estimator == PaneEstimator::walks)
    walks = virtualLightWalks(impl.scene, impl.atlas, impl.tracer, impl.sides, impl.clusters, impl.settings.walks_per_entry, impl.settings.seed);
  ByteWriter writer;
  if (first == 0) writer.array(solved.training.wavelet_unit);  // common to all blocks: the first range carries it
  std::vector<std::vector<BasisBlock>> fitted;
  if (impl.settings.layout == PrmLayoutKind::local_bases) {
    std::vector<std::vector<uint32_t>> slots;
    for (uint32_t index = first; index < end; ++index) slots.push_back(impl.slotsOf(index));
    fitted = fitBlocks(slots, impl.atlas, impl.gatherer, impl.clusters, impl.wavelets, solved.multi_bounce, solved.training, solved.emitters, impl.settings.bases);
  }
  for (uint32_t index = first; index < end; ++index) {
    std::vector<BasisBlock> parts;
    std::vector<Rgb> pane_values;  // [texel][group]
    if (impl.settings.layout == PrmLayoutKind::local_bases) {
      parts = std::move(fitted[index - first]);
    } else {
      const auto slots = impl.slotsOf(index);
      pane_values = impl.settings.estimator == PaneEstimator::walks
                        ? walkPanes(slots, impl.atlas, impl.tracer, impl.clusters, walks)
                        : gatherPanes(slots, impl.gatherer, impl.clusters, solved.multi_bounce, impl.settings.bases.rays);
      BasisBlock& block = parts.emplace_back();
      block.slot = slots;
      if (impl.has_emitters)
        for (size_t t = 0; t < slots.size(); ++t) {
          Rgb sum(0.0f);
          for (uint32_t g = 0; g < impl.clusters.group_count; ++g) sum += pane_values[t * impl.clusters.group_count + g] * solved.group_emitted_rgb[g];
          block.emitter_indirect_rgb.push_back(sum);
        }
    }
    for (const BasisBlock& block : parts) {
      writer.array(block.slot);
      writer.array(pane_values);
      writer.array(block.emitter_indirect_rgb);
      if (impl.settings.layout == PrmLayoutKind::local_bases) writeBlock(writer, block);
    }
  }
  return writer.take();
}

Bytes PrmBaker::fitProbes(uint32_t first, uint32_t end, const SharedBytes& solved_bytes) const {
  const auto& impl = *impl_;
  const auto shared = impl.solvedFrom(solved_bytes);
  const Solved& solved = *shared;
  LocalBasesOptions options = impl.settings.bases;
  options.rays = impl.settings.probe_rays;
  options.most_rank = kProbeValues;
  options.rank_error *= kProbeRankShare;
  options.wavelet_step *= kProbeStepShare;
  ByteWriter writer;
  const std::span<const Vec3> points(impl.settings.probes);
  for (const ProbeBasis& probe : transport::fitProbes(points.subspan(first, end - first), first, impl.gatherer, impl.clusters, impl.wavelets, solved.multi_bounce, solved.training, solved.emitters, options)) {
    writeBlock(writer, probe.block);
    writer.array(std::span<const Rgb>(probe.emitter_radiance_sh));
  }
  return writer.take();
}

PrmProbes PrmBaker::assembleProbes(std::span<const ByteView> parts) const {
  PrmProbes probes;
  probes.position = impl_->settings.probes;
  for (const auto& part : parts)
    for (ByteReader reader(part); !reader.empty();) {
      readBlock(reader, probes);
      const auto emitted = reader.array<Rgb>();
      if (emitted.size() != 9) throw std::runtime_error("a task result is damaged");
      if (impl_->has_emitters) std::copy(emitted.begin(), emitted.end(), probes.emitter_radiance_sh.emplace_back().begin());
    }
  return probes;
}

PrmResult PrmBaker::assemble(std::span<const ByteView> blocks, std::span<const ByteView> emitter) const {
  const auto& impl = *impl_;
  const bool local_bases = impl.settings.layout == PrmLayoutKind::local_bases;
  PrmResult result;
  auto& bases = result.bases;
  std::vector<uint32_t> slots;
  std::vector<Rgb> pane_values;  // [texel][group]
  for (const auto& part : blocks) {
    ByteReader reader(part);
    if (&part == &blocks.front()) bases.wavelet_unit = reader.array<uint8_t>();
    while (!reader.empty()) {
      const auto block_slots = reader.array<uint32_t>();
      const auto block_panes = reader.array<Rgb>();
      const auto emitted = reader.array<Rgb>();
      slots.insert(slots.end(), block_slots.begin(), block_slots.end());
      result.emitter_indirect_rgb.insert(result.emitter_indirect_rgb.end(), emitted.begin(), emitted.end());
      if (!local_bases) {
        pane_values.insert(pane_values.end(), block_panes.begin(), block_panes.end());
        continue;
      }
      bases.block_first_texel.push_back(uint32_t(slots.size()));
      readBlock(reader, bases);
    }
  }
  for (const uint32_t slot : slots) result.texel.push_back(impl.atlas.slots[slot].texel);

  if (impl.has_emitters) {
    std::vector<Rgb> side_rgb;
    for (const auto& part : emitter) {
      ByteReader reader(part);
      const auto values = reader.array<Rgb>();
      side_rgb.insert(side_rgb.end(), values.begin(), values.end());
    }
    for (const uint32_t slot : slots) result.emitter_direct_rgb.push_back(side_rgb.at(slot));
  }

  // Local bases know the fine clusters; panes, of which there is one for each group, the groups. The paper's entries are points.
  const uint32_t fine = impl.clusters.cluster_count, groups = impl.clusters.group_count;
  result.entries = entriesOf(impl.clusters.entries, local_bases ? 0 : fine, local_bases ? fine : fine + groups);
  if (local_bases) {
    bases.tree = impl.clusters.tree;
    return result;
  }
  for (auto* half : {&result.entries.half_u, &result.entries.half_v}) half->assign(half->size(), Vec3(0.0f));
  result.panes.irradiance_rgb.resize(slots.size() * groups);
  for (size_t t = 0; t < slots.size(); ++t)
    for (uint32_t g = 0; g < groups; ++g) result.panes.irradiance_rgb[g * slots.size() + t] = pane_values[t * groups + g];
  return result;
}

}  // namespace lightwell::transport
