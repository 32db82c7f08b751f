#include "cli/report/ladder.h"

#include <algorithm>
#include <stdexcept>

namespace lightwell::report {
namespace {

using plan::Quality;
using plan::Technique;

constexpr uint32_t kPaperEntries = 4096, kPaperClusters = 256, kPaperPanes = 32;  // Szecsi and Szirmay-Kalos, "On Making Light Maps Dynamic"

double costOf(Quality quality) { return quality == Quality::draft ? 1 : quality == Quality::preview ? 4 : 12; }

Rung rungOf(const plan::Settings& base, Technique technique, std::string series) {
  Rung rung;
  rung.series = std::move(series);
  rung.settings = base;
  rung.settings.techniques = {technique};
  return rung;
}

Rung ofQuality(const plan::Settings& base, Technique technique, std::string series, Quality quality) {
  Rung rung = rungOf(base, technique, std::move(series));
  rung.setting = plan::name(quality);
  rung.settings.quality = quality;
  rung.options = "--quality " + rung.setting;
  rung.cost = costOf(quality);
  return rung;
}

Rung paperPanes(const plan::Settings& base, Quality quality) {
  Rung rung = ofQuality(base, Technique::prm, "prm-paper", quality);
  rung.settings.prm_layout = plan::PrmLayout::panes;
  rung.settings.prm_estimator = plan::PrmEstimator::walks;
  rung.settings.prm_entries = kPaperEntries, rung.settings.prm_clusters = kPaperClusters;
  rung.options += " --prm-layout panes --prm-estimator walks --prm-entries " + std::to_string(kPaperEntries) + " --prm-clusters " + std::to_string(kPaperClusters);
  rung.cost *= 1.5;
  rung.brightest = {kPaperPanes};
  if (quality == Quality::production) rung.brightest = {kPaperPanes, 8, 64, 0};
  return rung;
}

Rung uniformPatches(const plan::Settings& base, uint32_t texels) {
  Rung rung = rungOf(base, Technique::radiosity, "radiosity-uniform");
  rung.setting = std::to_string(texels) + " texels wide";
  rung.settings.quality = Quality::production;
  rung.settings.radiosity_density = 1.0f / float(texels);
  rung.options = "--quality production --radiosity-density " + std::string(texels == 2 ? "0.5" : texels == 4 ? "0.25" : texels == 8 ? "0.125" : "0.0625");
  rung.cost = 64.0 / texels;
  return rung;
}

Rung virtualLights(const plan::Settings& base, bool points, uint32_t count) {
  Rung rung = rungOf(base, Technique::vpl, points ? "vpl-points" : "vpl");
  rung.setting = std::to_string(count) + (points ? " points" : " lights");
  rung.settings.quality = Quality::production;
  rung.settings.virtual_lights = count;
  if (points) rung.settings.virtual_light = plan::VirtualLightShape::point;
  rung.options = std::string("--quality production ") + (points ? "--virtual-light point " : "") + "--virtual-lights " + std::to_string(count);
  rung.cost = 2 + double(count) / 100;
  return rung;
}

}  // namespace

const std::vector<Series>& allSeries() {
  static const std::vector<Series> all{
      {"prm", "radiance maps", "#0068b0", false, "lamps that move, recolour and switch; surfaces and doors stay"},
      {"prm-paper", "radiance maps, paper's panes", "#5aa7d8", true, "the setting of Szécsi and Szirmay-Kalos, “On Making Light Maps Dynamic”: 4,096 entry points, 256 panes, the 32 brightest summed"},
      {"radiosity", "radiosity", "#00845f", false, "lamps, albedo, emission and doors that change; bounces build up over frames"},
      {"radiosity-uniform", "radiosity, uniform patches", "#57b894", true, "patches of one size, and every form factor of theirs stored: 8 bytes for each pair of patches that see each other"},
      {"vpl", "virtual lights", "#c24e00", false, "lamps that stay; a few kilobytes from which a game draws its light map while it loads"},
      {"vpl-points", "virtual point lights", "#e79a5b", true, "Keller's instant radiosity: the same light by points, clamped and restored"},
      {"lightmap", "light map", "#8a3c8f", false, "lamps that stay; nothing to do in a frame"},
      {"given", "given containers", "#202020", false, "containers named with --against"}};
  return all;
}

const Series& seriesNamed(std::string_view name) {
  for (const Series& series : allSeries())
    if (series.name == name) return series;
  throw std::logic_error("no series " + std::string(name));
}

std::string Rung::fileName() const {
  std::string name = series + "_" + setting;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_' && c != '-') c = '_';
  return name;
}

std::vector<Rung> ladderOf(const plan::Settings& base, const plan::SceneFacts& facts, std::vector<Skipped>& skipped) {
  const auto usable = [&](Technique technique) {
    plan::Settings settings = base;
    settings.techniques = {technique};
    const plan::Plan plan = plan::makePlan(facts, settings);
    for (const plan::Omitted& omitted : plan.omitted)
      if (omitted.type == plan::name(technique)) {
        skipped.push_back({std::string(plan::name(technique)), omitted.reason});
        return false;
      }
    return true;
  };
  const bool prm = usable(Technique::prm), lightmap = usable(Technique::lightmap), vpl = usable(Technique::vpl);
  bool radiosity = usable(Technique::radiosity);
  if (radiosity && facts.has_sky_light) {
    skipped.push_back({"radiosity", "it does not hold the light of a sky"});
    radiosity = false;
  }
  std::vector<Rung> rungs;
  const auto ofQualities = [&](Quality quality) {
    if (prm) rungs.push_back(ofQuality(base, Technique::prm, "prm", quality));
    if (lightmap) rungs.push_back(ofQuality(base, Technique::lightmap, "lightmap", quality));
    if (radiosity) rungs.push_back(ofQuality(base, Technique::radiosity, "radiosity", quality));
    if (radiosity && quality == Quality::production) rungs.back().sweeps = true;
  };
  ofQualities(Quality::draft);
  if (vpl) rungs.push_back(virtualLights(base, false, 200));
  ofQualities(Quality::production);
  if (prm) rungs.push_back(paperPanes(base, Quality::production));
  if (vpl) rungs.push_back(virtualLights(base, true, 200));
  if (radiosity) rungs.push_back(uniformPatches(base, 8));
  ofQualities(Quality::preview);
  if (prm)
    for (const Quality quality : {Quality::draft, Quality::preview}) rungs.push_back(paperPanes(base, quality));
  for (const uint32_t count : {50u, 800u})
    for (const bool points : {false, true})
      if (vpl) rungs.push_back(virtualLights(base, points, count));
  if (radiosity)
    for (const uint32_t texels : {16u, 4u, 2u}) rungs.push_back(uniformPatches(base, texels));
  return rungs;
}

}  // namespace lightwell::report
