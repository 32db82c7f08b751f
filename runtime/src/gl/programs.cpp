#include "runtime/src/gl/programs.h"

#include "lightwell/lightwell_gl.h"
#include "runtime/src/gl/shaders.h"

namespace lightwell::runtime::gl {
namespace {

/// compileProgram, unless it was done before.
lw_result prepare(const lw_gl& context, const char* what, std::initializer_list<const char*> fragment, std::initializer_list<const char*> samplers,
                  std::initializer_list<const char*> uniforms, Program& program, std::initializer_list<const char*> vertex = {glsl::kVertex}) {
  if (program.name) return LW_OK;
  return compileProgram(context, what, fragment, samplers, uniforms, program, vertex);
}

}  // namespace

using namespace glsl;

lw_result prepareEntries(lw_gl& context, uint32_t shadow) {
  constexpr const char* kKind[] = {"#define LW_SHADOW 0\n", "#define LW_SHADOW 1\n", "#define LW_SHADOW 2\n", "#define LW_SHADOW 3\n"};
  static_assert(LW_GL_SHADOW_NONE == 0 && LW_GL_SHADOW_2D == 1 && LW_GL_SHADOW_CUBE == 2 && LW_GL_SHADOW_VISIBILITY == 3, "as kEntries has them");
  return prepare(context, "entry", {kKind[shadow], kAddress, kLight, kEntries},
                 {"u_position", "u_normal", "u_previous", "u_shadow_2d", "u_shadow_cube", "u_visibility", "u_rectangle"},
                 {"u_entries", "u_light_count", "u_accumulate", "u_reversed", "u_light", "u_shadow_numbers", "u_shadow_matrix"}, context.entries[shadow]);
}

lw_result prepareClusters(lw_gl& context) {
  return prepare(context, "cluster", {kAddress, kClusters}, {"u_range", "u_position", "u_entry", "u_pane_sum"}, {"u_clusters"}, context.clusters);
}

lw_result preparePanes(lw_gl& context) {
  lw_result result = prepare(context, "rank", {kAddress, kRank}, {"u_cluster"}, {"u_clusters"}, context.rank);
  if (!result)
    result = prepare(context, "selection", {kAddress, kSelect}, {"u_cluster", "u_rank", "u_pane_sum"}, {"u_clusters", "u_brightest", "u_keep_energy"},
                     context.select);
  if (!result)
    result = prepare(context, "pane", {kAddress, kOwnValue, kPanes}, {"u_texel_map", "u_weight", "u_pane", "u_constant", "u_buried"},
                     {"u_weights", "u_selected", "u_texels", "u_emitters", "u_constants", "u_sky", "u_max", "u_fill", "u_buried_count"}, context.panes);
  return result;
}

lw_result prepareLocalBases(lw_gl& context) {
  return prepare(context, "reconstruction", {kAddress, kLocalBases, kOwnValue, kReconstruct}, {"lw_texel_map", "lw_basis", "lw_amount", "u_constant", "u_buried"},
                 {"lw_quads", "u_emitters", "u_constants", "u_sky", "u_max", "u_fill", "u_buried_count", "u_keep"}, context.reconstruct);
}

lw_result prepareRadiosity(lw_gl& context) {
  lw_result result = prepare(context, "patch radiosity", {kAddress, kRadiosityPatches}, {"u_albedo", "u_emitted", "u_direct", "u_irradiance", "u_kept"},
                             {"u_patches", "u_light"}, context.radiosity_patches);
  if (!result)
    result = prepare(context, "node radiosity", {kAddress, kRadiosityNodes}, {"u_node", "u_share"}, {"u_begin", "u_end", "u_child_begin"}, context.radiosity_nodes);
  if (!result)
    result = prepare(context, "radiosity gathering", {kAddress, kRadiosityGather}, {"u_link", "u_row", "u_run", "u_gate", "u_node", "u_previous"},
                     {"u_patches", "u_omega"}, context.radiosity_gather);
  if (!result)
    result = prepare(context, "radiosity", {kAddress, kRadiosityShade}, {"u_texel_map", "u_texel_patch", "u_texel_weight", "u_irradiance", "u_emitters", "u_direct"},
                     {"u_fill", "u_amounts", "u_max"}, context.radiosity_shade);
  return result;
}

lw_result prepareInjection(lw_gl& context) {
  lw_result result = prepare(context, "view of a light", {kAddress, kAlphaTest, kInjectSee},
                             {"u_corner", "u_triangle", "u_texel_patches", "u_patch", "u_alpha_material", "u_alpha", "u_leaf"},
                             {"u_eye", "u_right", "u_up", "u_forward", "u_range"}, context.inject_see, {kAddress, kLampViewVertex});
  if (!result)
    result = prepare(context, "light injection", {kInjectAdd}, {"u_seen", "u_patch"}, {"u_side", "u_light", "u_cone", "u_spot"}, context.inject_add,
                     {kAddress, kInjectAddVertex});
  return result;
}

lw_result prepareProbes(lw_gl& context) {
  return prepare(context, "probe", {kAddress, kProbes}, {"u_link", "u_probe", "u_run", "u_gate", "u_node"}, {"u_probes", "u_groups"}, context.probes);
}

void deletePrograms(lw_gl& context) {
  for (const Program* program :
       {&context.entries[0], &context.entries[1], &context.entries[2], &context.entries[3], &context.clusters, &context.rank, &context.select, &context.panes,
        &context.reconstruct, &context.radiosity_patches, &context.radiosity_nodes, &context.radiosity_gather, &context.radiosity_shade, &context.inject_see,
        &context.inject_add, &context.probes})
    if (program->name) context.api.DeleteProgram(program->name);
}

}  // namespace lightwell::runtime::gl
