#include "precompute/bake/bake.h"

#include "format/encode/writer.h"
#include "precompute/bake/prm_error.h"
#include "precompute/bake/prm_tasks.h"
#include "precompute/bake/sections.h"

namespace lightwell::bake {
namespace {

constexpr int kZstdLevel = 9;

v1::MetaHeader metaOf(const BakeContext& context, const std::vector<plan::Omitted>& omitted, const GraphOptions& options) {
  v1::MetaHeader header;
  v1::Provenance& provenance = *header.mutable_provenance();
  provenance.set_tool_version(productVersion());
  const std::filesystem::path file = context.scene().file;
  provenance.set_scene_name(file.filename().string());
  KeyHasher hasher;
  provenance.set_scene_hash(hasher.add(context.surfaceKey()).add(context.lightKey()).finish().low);
  provenance.set_settings_json(plan::canonicalJson(options.settings));
  provenance.set_time_limited(options.time_limited);
  for (const auto& warning : options.warnings) {
    // Where the scene lay on the machine that baked it is no property of the container.
    const std::string place = warning.place == file ? file.filename().string() : warning.place;
    provenance.add_warnings((place.empty() ? "" : place + ": ") + warning.message);
  }
  for (const auto& [type, reason] : omitted) {
    v1::Omitted* out = header.add_omitted();
    out->set_type(type);
    out->set_reason(reason);
  }
  return header;
}

/// The container's bytes from the fitted blocks, the emitters' light and the references, in this order.
Bytes encodeContainer(const BakeContext& context, const plan::Plan& plan, const PrmTasks& tasks, v1::MetaHeader meta,
                      const TaskInputs& in) {
  std::optional<transport::PrmResult> prm;
  if (plan.prm) {
    const size_t blocks = tasks.blocks.size(), emitter = tasks.emitter.size();
    prm = assemblePrm(tasks, in.inputs.first(blocks), in.inputs.subspan(blocks, emitter), in.inputs[blocks + emitter]);
    in.cancel.check();
    if (const auto measured = measurePrm(context, *prm, in.inputs.subspan(blocks + emitter + 1))) {
      v1::MeasuredError* error = meta.add_errors();
      error->set_section("prm");
      error->set_relrmse(measured->relrmse);
      error->set_texrel(measured->texrel);
      error->set_bias(measured->bias);
      error->set_against(measured->against);
    }
    in.cancel.check();
  }
  format::Writer writer({.zstd_level = kZstdLevel});
  addMetaSection(writer, meta);
  addSceneSection(writer, context.scene());
  if (plan.surface_sections) {
    addGeometrySection(writer, context.scene(), context.atlas());
    addAtlasSection(writer, context.atlas());
  }
  in.cancel.check();
  if (prm) addPrmSection(writer, *prm, context.scene().metres_per_unit);
  in.cancel.check();
  return writer.bytes();
}

}  // namespace

const char* productVersion() { return LIGHTWELL_VERSION; }

BakeGraph makeBakeGraph(const BakeContext& context, const GraphOptions& options) {
  BakeGraph result{TaskGraph(productVersion()), 0, {}};
  plan::Plan plan = plan::makePlan(context.facts(), options.settings);
  const transport::PrmSettings prm_settings = prmSettings(options.settings);
  std::shared_ptr<const transport::PrmBaker> baker;
  if (plan.prm) {
    baker = std::make_shared<transport::PrmBaker>(context.scene(), context.atlas(), *context.tracer(), prm_settings);
    if (baker->blockCount() == 0 || baker->groupCount() == 0) {
      plan.prm = false;
      plan.omitted.push_back({"prm", "every texel lies inside or behind other surfaces"});
    }
  }
  PrmTasks prm;
  std::vector<TaskIndex> references;
  if (plan.prm) {
    prm = addPrmTasks(result.graph, context, prm_settings, baker);
    references = addReferenceTasks(result.graph, context, options.test_lights);
  }

  const v1::MetaHeader meta = metaOf(context, plan.omitted, options);
  std::vector<TaskIndex> inputs = prm.blocks;
  inputs.insert(inputs.end(), prm.emitter.begin(), prm.emitter.end());
  if (plan.prm) inputs.push_back(prm.solved);
  inputs.insert(inputs.end(), references.begin(), references.end());
  const std::string parameters = context.surfaceKey().hex() + context.lightKey().hex() + meta.SerializeAsString();
  const double texels = double(context.settings().lightmap_size) * context.settings().lightmap_size;
  result.container =
      result.graph.add({"container", "container", "container", parameters, inputs, texels + 1,
                        [&context, plan, prm, meta](const TaskInputs& in) { return encodeContainer(context, plan, prm, meta, in); }});
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
