#include "precompute/transport/radiosity/bake_probes.h"

namespace lightwell::transport {
namespace {

void require(bool condition) {
  if (!condition) throw std::runtime_error("a task result is damaged");
}

template <class Index>
void requireRows(const std::vector<Index>& first, size_t entries) {
  require(!first.empty() && first.front() == 0 && first.back() == entries);
  for (size_t i = 1; i < first.size(); ++i) require(first[i - 1] <= first[i]);
}

}  // namespace

Bytes makeProbeBytes(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const RadiosityBaker& radiosity, const ProbeSettings& settings,
                     int threads, const CancelFlag* cancel) {
  ProbeOptions options = settings.places;
  options.threads = threads;
  options.cancel = cancel;
  const Probes probes = placeProbes(scene, atlas, tracer, radiosity.sides(), radiosity.patches(), options);
  ByteWriter writer;
  writer.array(std::vector<ProbeLattice>{probes.lattice});
  writer.array(probes.lattice_point);
  writer.array(probes.offset);
  writer.array(probes.nearness);
  writer.array(probes.position);
  writer.array(std::vector<uint32_t>{probes.moved, probes.inside, probes.sealed});
  return writer.take();
}

ProbeBaker::ProbeBaker(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const RadiosityBaker& radiosity,
                       const ProbeSettings& settings, ByteView places)
    : scene_(scene), atlas_(atlas), tracer_(tracer), radiosity_(radiosity), settings_(settings) {
  ByteReader reader(places);
  const auto lattice = reader.array<ProbeLattice>();
  require(lattice.size() == 1);
  probes_.lattice = lattice[0];
  probes_.lattice_point = reader.array<uint32_t>();
  probes_.offset = reader.array<std::array<int8_t, 3>>();
  probes_.nearness = reader.array<float>();
  probes_.position = reader.array<Vec3>();
  const auto fates = reader.array<uint32_t>();
  const size_t on_lattice = probes_.lattice_point.size();
  require(fates.size() == 3 && probes_.offset.size() == on_lattice && probes_.nearness.size() == on_lattice * kNearnessNodes && probes_.position.size() >= on_lattice);
  probes_.moved = fates[0], probes_.inside = fates[1], probes_.sealed = fates[2];
}

Bytes ProbeBaker::hits(uint32_t first, uint32_t end) const {
  const ProbeHits hits = countProbeHits(scene_, atlas_, tracer_, radiosity_.sides(), radiosity_.patches(), probes_, settings_.links.rays, settings_.places.seed, first, end);
  ByteWriter writer;
  writer.array(hits.first);
  writer.array(hits.patch);
  writer.array(hits.count);
  writer.array(hits.direction);
  writer.array(hits.moments);
  return writer.take();
}

Bytes ProbeBaker::links(uint32_t first, ByteView bytes, ByteView trained) const {
  ByteReader reader(bytes);
  ProbeHits hits;
  hits.first = reader.array<uint64_t>();
  hits.patch = reader.array<uint32_t>();
  hits.count = reader.array<uint32_t>();
  hits.direction = reader.array<Vec3>();
  hits.moments = reader.array<std::array<float, 9>>();
  requireRows(hits.first, hits.patch.size());
  require(hits.count.size() == hits.patch.size() && hits.direction.size() == hits.patch.size() && hits.moments.size() + 1 == hits.first.size());
  for (const uint32_t patch : hits.patch) require(patch < radiosity_.patchCount());
  require(first + hits.first.size() - 1 <= probes_.count());
  const auto [factors, training] = radiosity_.readTrained(trained);
  const PatchTree& tree = radiosity_.tree();
  const ProbeSurroundings surroundings{tree, nodePositions(radiosity_.patches(), tree), nodesThatSeeTheSame(factors, tree)};
  const ProbeLinkValues links = makeProbeLinks(hits, std::span(probes_.position).subspan(first, hits.first.size() - 1), surroundings, training, settings_.links);
  ByteWriter writer;
  writer.array(links.first);
  writer.array(links.node);
  writer.array(links.value);
  return writer.take();
}

ProbeResult ProbeBaker::assemble(std::span<const ByteView> links) const {
  ProbeLinkValues values;
  for (const ByteView bytes : links) {
    ByteReader reader(bytes);
    ProbeLinkValues part;
    part.first = reader.array<uint32_t>();
    part.node = reader.array<uint32_t>();
    part.value = reader.array<float>();
    requireRows(part.first, part.node.size());
    require(part.value.size() == part.node.size());
    for (const uint32_t node : part.node) require(node < radiosity_.tree().nodeCount());
    values.append(part);
  }
  require(values.probes() == probes_.count());
  return {probes_, quantiseProbeLinks(values)};
}

}  // namespace lightwell::transport
