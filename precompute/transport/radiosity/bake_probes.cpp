#include "precompute/transport/radiosity/bake_probes.h"

#include "precompute/transport/stage_bytes.h"

#include <string>

#include "precompute/core/error.h"

namespace lightwell::transport {
Bytes makeProbeBytes(const scene::Scene& scene, const trace::Tracer& tracer, const RadiosityBaker& radiosity, const ProbeSettings& settings, int threads,
                     const CancelFlag* cancel) {
  ProbeOptions options = settings.places;
  options.threads = threads;
  options.cancel = cancel;
  const Probes probes = placeProbes(scene, tracer, radiosity.tracer(), radiosity.patchCount(), options);
  ByteWriter writer;
  writer.array(std::vector<ProbeLattice>{probes.lattice});
  writer.array(probes.lattice_point);
  writer.array(probes.offset);
  writer.array(probes.nearness);
  writer.array(probes.position);
  writer.array(std::vector<uint32_t>{probes.moved, probes.inside, probes.sealed});
  return writer.take();
}

ProbeBaker::ProbeBaker(const RadiosityBaker& radiosity, const ProbeSettings& settings, ByteView places) : radiosity_(radiosity), settings_(settings) {
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
  const ProbeHits hits = countProbeHits(radiosity_.tracer(), probes_, settings_.links.rays, settings_.places.seed, first, end);
  ByteWriter writer;
  writer.array(hits.first);
  writer.array(hits.set);
  writer.array(hits.group_first);
  writer.array(hits.sets.first());
  writer.array(hits.sets.entries());
  writer.array(hits.patch);
  writer.array(hits.count);
  writer.array(hits.direction);
  writer.array(hits.moments);
  return writer.take();
}

Bytes ProbeBaker::links(uint32_t first, ByteView bytes, ByteView trained) const {
  ByteReader reader(bytes);
  ProbeHits hits;
  hits.first = reader.array<uint32_t>();
  hits.set = reader.array<uint32_t>();
  hits.group_first = reader.array<uint64_t>();
  const auto sets_first = reader.array<uint32_t>();
  require(hits.sets.assign(sets_first, reader.array<GateEntry>()));
  hits.patch = reader.array<uint32_t>();
  hits.count = reader.array<uint32_t>();
  hits.direction = reader.array<Vec3>();
  hits.moments = reader.array<std::array<float, 9>>();
  requireRows(hits.first, hits.set.size());
  requireRows(hits.group_first, hits.patch.size());
  require(hits.group_first.size() == hits.set.size() + 1 && hits.moments.size() == hits.set.size());
  for (const uint32_t set : hits.set) require(set < hits.sets.count());
  require(hits.count.size() == hits.patch.size() && hits.direction.size() == hits.patch.size());
  for (const uint32_t patch : hits.patch) require(patch < radiosity_.patchCount());
  require(first + hits.probes() <= probes_.count());
  const auto [factors, training] = radiosity_.readTrained(trained);
  const PatchTree& tree = radiosity_.tree();
  const ProbeSurroundings surroundings{tree, nodePositions(radiosity_.patches(), tree), nodesThatSeeTheSame(factors, tree)};
  const ProbeLinkValues links = makeProbeLinks(hits, std::span(probes_.position).subspan(first, hits.probes()), surroundings, training, settings_.links);
  ByteWriter writer;
  writer.array(links.first);
  writer.array(links.set);
  writer.array(links.sets.first());
  writer.array(links.sets.entries());
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
    part.set = reader.array<uint32_t>();
    const auto sets_first = reader.array<uint32_t>();
    require(part.sets.assign(sets_first, reader.array<GateEntry>()));
    part.node = reader.array<uint32_t>();
    part.value = reader.array<float>();
    requireRows(part.first, part.node.size());
    require(part.value.size() == part.node.size() && part.set.size() == part.node.size());
    for (const uint32_t set : part.set) require(set < part.sets.count());
    for (const uint32_t node : part.node) require(node < radiosity_.tree().nodeCount());
    values.append(part);
  }
  require(values.probes() == probes_.count());
  ProbeResult result{probes_, quantiseProbeLinks(values)};
  if (result.links.sets.count() > kMostGateSets)
    throw UsageError("probes see each other through " + std::to_string(result.links.sets.count()) + " combinations of portals' strips, more than " +
                     std::to_string(kMostGateSets) + ": give portals fewer strips");
  return result;
}

}  // namespace lightwell::transport
