#include "precompute/plan/plan.h"

#include <algorithm>

namespace lightwell::plan {
namespace {

constexpr Technique kBakers[] = {Technique::prm};

bool hasBaker(Technique technique) { return std::find(std::begin(kBakers), std::end(kBakers), technique) != std::end(kBakers); }

}  // namespace

void checkTechniques(const Settings& settings) {
  for (const Technique technique : settings.techniques)
    if (!hasBaker(technique))
      throw UsageError("--techniques: this version cannot bake \"" + std::string(name(technique)) + "\" yet; it bakes prm");
}

void checkPrm(const Settings& settings) {
  const bool panes = settings.prm_layout == PrmLayout::panes;
  if (settings.prm_estimator == PrmEstimator::walks && !panes)
    throw UsageError("--prm-estimator walks: only --prm-layout panes can be estimated by walks");
  if (panes && settings.prm_clusters > kMostPrmPanes)
    throw UsageError("--prm-clusters: at most " + std::to_string(kMostPrmPanes) + " clusters can have a pane each");
  if (settings.prm_entries && settings.prm_entries < settings.prm_clusters)
    throw UsageError("--prm-entries: " + std::to_string(settings.prm_entries) + " entry points are too few for " +
                     std::to_string(settings.prm_clusters) + " clusters");
}

Plan makePlan(const SceneFacts& facts, const Settings& settings) {
  checkTechniques(settings);
  checkPrm(settings);
  const bool automatic = settings.techniques.empty();
  const auto wanted = [&](Technique technique) {
    return std::find(settings.techniques.begin(), settings.techniques.end(), technique) != settings.techniques.end();
  };
  Plan plan;
  plan.surface_sections = facts.has_surfaces;
  if (!facts.has_surfaces)
    for (const char* section : {"geometry", "atlas"}) plan.omitted.push_back({section, "the scene has no surfaces"});
  for (int i = 0; i <= int(Technique::environment); ++i) {
    const auto technique = Technique(i);
    const std::string type(name(technique));
    if (!automatic && !wanted(technique))
      plan.omitted.push_back({type, "not asked for"});
    else if (!hasBaker(technique))
      plan.omitted.push_back({type, "this version cannot bake it"});
    else if (technique == Technique::prm && !facts.has_surfaces)
      plan.omitted.push_back({type, "the scene has no surfaces"});
    else if (technique == Technique::prm && !facts.has_reflection && !facts.has_emitters)
      plan.omitted.push_back({type, "no surface reflects or emits light"});
    else if (technique == Technique::prm)
      plan.prm = true;
  }
  plan.prm_emitter = plan.prm && facts.has_emitters;
  if (plan.prm && !facts.has_emitters) plan.omitted.push_back({"prm.emitter", "no surface emits light"});
  return plan;
}

}  // namespace lightwell::plan
