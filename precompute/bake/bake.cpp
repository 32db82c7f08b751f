#include "precompute/bake/bake.h"

#include "format/encode/writer.h"
#include "precompute/bake/environment_tasks.h"
#include "precompute/bake/lightmap_tasks.h"
#include "precompute/bake/measured_error.h"
#include "precompute/bake/stage_tasks.h"
#include "precompute/bake/prm_tasks.h"
#include "precompute/bake/probe_tasks.h"
#include "precompute/bake/radiosity_tasks.h"
#include "precompute/bake/sections.h"
#include "precompute/bake/sky_tasks.h"
#include "precompute/bake/vpl_tasks.h"
#include "precompute/transport/prm/merge_unlinked.h"

namespace lightwell::bake {
namespace {

constexpr int kZstdLevel = 9;
constexpr uint64_t kBytesPerCluster = 39;  // decoded: its entry point, its place in the tree, the units of three wavelets

v1::MetaHeader metaOf(const BakeContext& context, const std::vector<plan::Omitted>& omitted, const GraphOptions& options) {
  v1::MetaHeader header;
  v1::Provenance& provenance = *header.mutable_provenance();
  provenance.set_tool_version(productVersion());
  const std::filesystem::path file = context.scene().file;
  if (context.skyGrid()) {
    provenance.set_environment_name(context.environmentName());
    provenance.set_environment_hash(context.skyKey().low);
  }
  provenance.set_scene_name(file.filename().string());
  KeyHasher hasher;
  if (context.facts().has_scene) provenance.set_scene_hash(hasher.add(context.keys().surfaces).add(context.keys().lights).finish().low);
  provenance.set_settings_json(plan::canonicalJson(options.settings));
  provenance.set_time_limited(options.time_limited);
  for (const auto& warning : options.warnings) {
    // Where the scene lay on the machine that baked it is no property of the container.
    const std::string place = warning.place == file ? file.filename().string() : warning.place;
    provenance.add_warnings((place.empty() ? "" : place + ": ") + warning.message);
  }
  for (const auto& o : omitted) {
    v1::Omitted* out = header.add_omitted();
    out->set_type(o.type);
    out->set_reason(o.reason);
    out->set_decoded_bytes(o.decoded_bytes);
    out->set_rays(o.rays);
  }
  return header;
}

/// What the sections that were left out would have had and cost, where that is known without baking them.
void addSavings(std::vector<plan::Omitted>& omitted, const BakeContext& context, const plan::Settings& settings) {
  constexpr uint64_t kBytesPerVertex = 24, kBytesPerTriangle = 13, kBytesPerTexel = 8;  // decoded; panes: direct and indirect
  constexpr uint64_t kBytesPerEnvironmentSample = 44, kBytesPerSkyCell = 6;
  const scene::Mesh& mesh = context.scene().mesh;
  const uint64_t sky_cells = 6ull * settings.sky_face_cells * settings.sky_face_cells;
  for (auto& o : omitted) {
    if (o.type == "geometry") o.decoded_bytes = mesh.positions.size() * kBytesPerVertex + mesh.triangles.size() * kBytesPerTriangle;
    if (o.type == "environment" && context.facts().has_environment)
      o.decoded_bytes = settings.environment_samples * kBytesPerEnvironmentSample + sky_cells * kBytesPerSkyCell;
    if (o.type == "prm.sky" && context.facts().has_sky_light) {
      o.decoded_bytes = context.atlas().slots.size() * kBytesPerTexel;
      o.rays = skyRays(context, settings);
    }
  }
}

/// Some of the container task's inputs.
struct InputRange {
  size_t first = 0, count = 0;
  std::span<const Blob> of(const TaskInputs& in) const { return in.inputs.subspan(first, count); }
};

/// What the container is made of, beside the context.
struct ContainerParts {
  PrmTasks prm;
  InputRange blocks, emitter;                      // empty without a PRM
  InputRange prm_probes;                           // empty without points for it
  InputRange sky;                                  // empty without a sky on its texels
  std::shared_ptr<const transport::RadiosityBaker> radiosity;
  InputRange radiosity_links;                      // empty without radiosity
  ProbesToBake probes;
  InputRange probe_links;                          // empty without probes
  std::shared_ptr<const transport::LightmapBaker> lightmap;
  InputRange lightmap_direct, lightmap_gathered;   // empty without a light map
  InputRange lightmap_measured;                    // empty unless its error is wanted
  InputRange vpl;                                  // empty without virtual lights
  InputRange vpl_references, vpl_irradiance;       // empty unless their error is wanted
  InputRange references;                           // of indirect light, for whatever gives it
  InputRange environment, environment_errors;      // at most one each
};

Bytes encodeContainer(const BakeContext& context, const plan::Plan& plan, const plan::Settings& settings, const ContainerParts& parts,
                      v1::MetaHeader meta, const TaskInputs& in) {
  std::optional<transport::PrmResult> prm;
  SkyPanes sky;
  if (plan.prm) {
    prm = assemblePrm(parts.prm, parts.blocks.of(in), parts.emitter.of(in), parts.prm_probes.of(in));
    if (const uint32_t merged = settings.keep_all ? 0 : transport::mergeUnlinkedClusters(*context.tracer(), *prm); merged > 0) {
      v1::Omitted* out = meta.add_omitted();
      out->set_type("prm.unlinked");
      out->set_reason("what tells " + std::to_string(merged) + " of " + std::to_string(prm->entries.clusterCount() + merged) +
                      " entry points from their neighbours changes no texel by a step, and one stands for them");
      out->set_decoded_bytes(merged * kBytesPerCluster);
    }
    in.cancel.check();
    if (const auto measured = measurePrm(context, *prm, parts.references.of(in), in.cancel)) addMeasuredError(meta, "prm", *measured);
    in.cancel.check();
    if (plan.prm_sky) sky = makeSkyPanes(context, settings, *prm, parts.sky.of(in), in.cancel);
  }
  std::optional<transport::RadiosityResult> radiosity;
  if (plan.radiosity) {
    radiosity = parts.radiosity->assemble(viewsOf(parts.radiosity_links.of(in)), context.threads(), &in.cancel);
    if (const auto measured = measureRadiosity(context, *radiosity, parts.references.of(in), in.cancel)) addMeasuredError(meta, "radiosity", *measured);
    in.cancel.check();
  }
  std::optional<transport::ProbeResult> probes;
  if (plan.probes) probes = parts.probes.baker->assemble(viewsOf(parts.probe_links.of(in)));
  in.cancel.check();
  std::optional<transport::Lightmap> lightmap;
  if (plan.lightmap)
    lightmap = parts.lightmap->assemble(viewsOf(parts.lightmap_direct.of(in)), viewsOf(parts.lightmap_gathered.of(in)), context.threads(), in.cancel);
  if (const auto measured = viewsOf(parts.lightmap_measured.of(in)); lightmap && !measured.empty()) {
    const auto error = parts.lightmap->measure(*lightmap, measured[0], std::span(measured).subspan(1), in.cancel);
    addMeasuredError(meta, "lightmap", {error, "all light, path-traced at " + std::to_string(error.texels) + " texels"});
  }
  in.cancel.check();
  VplResult vpl;
  for (const Blob& result : parts.vpl.of(in)) vpl = readVplResult(*result);
  if (!vpl.lights.empty() && parts.vpl_references.count > 0)
    addMeasuredError(meta, "vpl", measureVpl(context, vplSettings(settings), parts.vpl_references.of(in), parts.vpl_irradiance.of(in), in.cancel));
  if (plan.vpl && vpl.lights.empty()) {
    v1::Omitted* out = meta.add_omitted();
    out->set_type("vpl");
    out->set_reason("no light of a lamp or emitter meets a surface that reflects it");
  }
  for (const Blob& errors : parts.environment_errors.of(in))
    for (const EnvironmentError& e : readEnvironmentErrors(errors))
      addMeasuredError(meta, "environment",
                       {e.error, (e.shininess == 1 ? "irradiance" : "Phong lobes of shininess " + std::to_string(int(e.shininess))) + ", unoccluded, in " +
                                     std::to_string(e.error.texels) + " directions, quadrature over the map"});
  format::Writer writer({.zstd_level = kZstdLevel});
  addMetaSection(writer, meta);
  if (context.facts().has_scene) addSceneSection(writer, context.scene());
  if (plan.geometry) addGeometrySection(writer, context.scene(), context.atlas());
  if (plan.atlas) addAtlasSection(writer, context.atlas());
  in.cancel.check();
  if (prm) addPrmSection(writer, *prm, sky, context.scene().metres_per_unit);
  if (prm && !prm->probes.position.empty()) addPrmProbesSection(writer, prm->probes, context.scene().metres_per_unit);
  in.cancel.check();
  if (lightmap) addLightmapSection(writer, *lightmap, context.atlas());
  if (!vpl.lights.empty()) addVplSection(writer, vpl, context.scene());
  if (plan.points)
    if (const auto surface = transport::spreadPoints(context.scene(), context.atlas(), settings.points, settings.seed); !surface.points.empty())
      addPointsSection(writer, surface, context.scene());
  if (radiosity) addRadiositySection(writer, *radiosity, context.scene());
  if (probes) addProbesSection(writer, *probes, context.scene().metres_per_unit);
  in.cancel.check();
  for (const Blob& environment : parts.environment.of(in)) addEnvironmentSection(writer, readEnvironment(environment), settings.environment);
  return writer.bytes();
}

}  // namespace

const char* productVersion() { return LIGHTWELL_VERSION; }

BakeGraph makeBakeGraph(const BakeContext& context, const GraphOptions& options, TaskRunner& tasks) {
  BakeGraph result{TaskGraph(productVersion()), 0, {}};
  plan::Plan plan = plan::makePlan(context.facts(), options.settings);
  const transport::PrmSettings prm_settings = prmSettings(options.settings, context.scene());
  std::shared_ptr<const transport::PrmBaker> baker;
  if (plan.prm) {
    checkPrior(context, prm_settings.prior);
    baker = makePrmBaker(context, prm_settings, tasks);
    if (baker->blockCount() == 0 || baker->groupCount() == 0) {
      plan.prm = plan.prm_sky = plan.prm_probes = false;
      plan.omitted.push_back({"prm", "every texel lies inside or behind other surfaces"});
    } else if (const transport::EntryClusters& entries = baker->clusters(); entries.merged_clusters > 0) {
      plan.omitted.push_back({"prm.unreached", "none of the lights that --moving-lights names reaches " + std::to_string(entries.merged_clusters) + " of " +
                                                   std::to_string(entries.cluster_count + entries.merged_clusters) + " entry points, for which their neighbours stand",
                              entries.merged_clusters * kBytesPerCluster});
    }
  }
  const transport::RadiositySettings radiosity_settings = radiositySettings(options.settings);
  ContainerParts parts;
  if (plan.radiosity) {
    parts.radiosity = makeRadiosityBaker(context, radiosity_settings, tasks);
    if (parts.radiosity->patchCount() == 0) {
      plan.radiosity = plan.probes = false;
      plan.omitted.push_back({"radiosity", "every texel lies inside or behind other surfaces"});
    }
  }
  if (plan.probes) {
    parts.probes = makeProbeBaker(context, options.settings, parts.radiosity, tasks);
    if (parts.probes.baker->probes().count() == 0) {
      plan.probes = false;
      plan.omitted.push_back({"probes", "every point of the lattice lies inside of things"});
    }
  }
  const transport::LightmapSettings lightmap_settings = lightmapSettings(options.settings);
  if (plan.lightmap) parts.lightmap = makeLightmapBaker(context, lightmap_settings, tasks);
  std::vector<TaskIndex> inputs;
  const auto take = [&](const std::vector<TaskIndex>& tasks) {
    const InputRange range{inputs.size(), tasks.size()};
    inputs.insert(inputs.end(), tasks.begin(), tasks.end());
    return range;
  };
  if (plan.prm) {
    parts.prm = addPrmTasks(result.graph, context, prm_settings, baker);
    parts.blocks = take(parts.prm.blocks);
    parts.emitter = take(parts.prm.emitter);
    parts.prm_probes = take(parts.prm.probes);
    if (plan.prm_sky) parts.sky = take(addSkyTasks(result.graph, context, options.settings));
  }
  if (plan.prm || plan.radiosity) parts.references = take(addReferenceTasks(result.graph, context, options.test_lights));
  if (plan.radiosity) {
    const RadiosityTasks radiosity = addRadiosityTasks(result.graph, context, radiosity_settings, parts.radiosity);
    parts.radiosity_links = take(radiosity.links);
    if (plan.probes) parts.probe_links = take(addProbeTasks(result.graph, context, parts.probes, radiosity_settings, radiosity));
  }
  if (plan.lightmap) {
    const LightmapTasks lightmap = addLightmapTasks(result.graph, context, lightmap_settings, parts.lightmap, options.test_lights > 0);
    parts.lightmap_direct = take(lightmap.direct);
    parts.lightmap_gathered = take(lightmap.gathered);
    parts.lightmap_measured = take(lightmap.measured);
  }
  if (plan.vpl) {
    const VplTasks vpl = addVplTasks(result.graph, context, vplSettings(options.settings), options.test_lights > 0);
    parts.vpl = take({vpl.lights});
    parts.vpl_references = take(vpl.references);
    parts.vpl_irradiance = take(vpl.irradiance);
  }
  if (plan.environment) {
    const EnvironmentTasks tasks = addEnvironmentTasks(result.graph, context, options.settings, options.test_lights > 0);
    parts.environment = take({tasks.baked});
    if (tasks.measured) parts.environment_errors = take({*tasks.measured});
  }

  addSavings(plan.omitted, context, options.settings);
  const v1::MetaHeader meta = metaOf(context, plan.omitted, options);
  const std::string parameters =
      context.keys().surfaces.hex() + context.keys().lights.hex() + context.keys().portals.hex() + context.skyKey().hex() + meta.SerializeAsString();
  const double texels = double(context.settings().lightmap_size) * context.settings().lightmap_size;
  result.container = result.graph.add(
      {"container", "container", "container", parameters, inputs, texels + 1,
       [&context, plan, settings = options.settings, parts, meta](const TaskInputs& in) {
         return encodeContainer(context, plan, settings, parts, meta, in);
       }});
  result.omitted = plan.omitted;
  return result;
}

std::vector<SectionSize> sectionSizes(const format::Reader& reader) {
  std::vector<SectionSize> sizes;
  for (const auto& section : reader.view().sections()) sizes.push_back({std::string(section.type)});
  for (const auto& chunk : reader.view().chunks()) {
    sizes[chunk.section_index].stored_bytes += chunk.stored_bytes;
    sizes[chunk.section_index].raw_bytes += chunk.raw_bytes;
  }
  return sizes;
}

}  // namespace lightwell::bake
