// Error of precomputed radiance maps by the hundred-lights protocol: see bench/README.md.
//   prm_accuracy SCENE.glb --container A.lwc [--container B.lwc …] [--brightest 32] [--json] > table.csv
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "cli/console.h"
#include "cli/prm_evaluator.h"
#include "format/encode/reader.h"
#include "precompute/bake/context.h"
#include "precompute/core/random.h"
#include "precompute/transport/pooled_error.h"
#include "precompute/transport/prm/light_prior.h"
#include "precompute/transport/reference/reference.h"

using namespace lightwell;
using nlohmann::json;

namespace {

constexpr uint64_t kReferences = 4;                                               // independent path-traced maps; see pooled_error.h
constexpr uint64_t kLightKey = 0x68756e64726564ull, kTexelKey = 0x746578656cull;  // apart from the keys of any bake

struct Options {
  std::filesystem::path scene;
  std::vector<std::filesystem::path> containers;
  std::vector<uint32_t> brightest;
  uint32_t lights = 100, samples = 128, texels = 1024;
  uint64_t seed = 1;
  int threads = 0;
  bool json = false;
};

/// One way of evaluating one container, and its errors: one per light.
struct Candidate {
  std::string container, variant;
  size_t evaluator;
  uint32_t brightest = 0, keep_energy = 1;
  std::vector<transport::PooledError> errors;
};

struct TestLight {
  transport::PriorLight prior;
  float surface_distance_m = 0;  // to the nearest surface, whichever way it faces
  double mean_irradiance = 0;  // indirect, over the texels compared
  bool sealed = false;
};

struct Band {
  const char* name;
  float from_m, to_m;
};
constexpr float kFar = std::numeric_limits<float>::infinity();
constexpr Band kBands[] = {{"< 0.1 m", 0, 0.1f}, {"0.1-0.5 m", 0.1f, 0.5f}, {">= 0.5 m", 0.5f, kFar}, {"all", 0, kFar}};

/// The value below which the share `q` lies, linear between neighbours; NaN (JSON: null) of nothing.
double quantile(std::vector<double> values, double q) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const double place = q * double(values.size() - 1);
  const size_t below = size_t(place), above = std::min(below + 1, values.size() - 1);
  return values[below] + (place - double(below)) * (values[above] - values[below]);
}

/// The squared distance of a point to the triangle of three corners.
float distance2(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 corner[3] = {a, b, c}, normal = (b - a).cross(c - a);
  bool inside = normal.length2() > 0;
  for (int i = 0; i < 3; ++i) inside = inside && normal.cross(corner[(i + 1) % 3] - corner[i]).dot(p - corner[i]) >= 0;
  if (inside) return (p - a).dot(normal) * (p - a).dot(normal) / normal.length2();
  float nearest = kFar;
  for (int i = 0; i < 3; ++i) {
    const Vec3 edge = corner[(i + 1) % 3] - corner[i], offset = p - corner[i];
    const float along = edge.length2() > 0 ? std::clamp(offset.dot(edge) / edge.length2(), 0.0f, 1.0f) : 0.0f;
    nearest = std::min(nearest, (offset - edge * along).length2());
  }
  return nearest;
}

float surfaceDistance(const scene::Scene& scene, const Vec3& point) {
  float nearest = kFar;
  const auto& at = scene.mesh.positions;
  for (const auto& t : scene.mesh.triangles) nearest = std::min(nearest, distance2(point, at[t[0]], at[t[1]], at[t[2]]));
  return std::sqrt(nearest) * float(scene.metres_per_unit);
}

/// `count` of the atlas's slots, each equally likely, ascending; all when there are no more.
std::vector<uint32_t> sampleSlots(size_t slots, uint32_t count, uint64_t seed) {
  std::vector<uint32_t> chosen(slots);
  std::iota(chosen.begin(), chosen.end(), 0u);
  if (count == 0 || count >= slots) return chosen;
  for (uint32_t i = 0; i < count; ++i)
    std::swap(chosen[i], chosen[i + mixBits(combineKeys(combineKeys(seed, kTexelKey), i)) % (slots - i)]);
  chosen.resize(count);
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

/// The settings that the container was baked with; its texels are those of the scene's atlas under the same settings.
plan::Settings settingsOf(const std::filesystem::path& file) {
  const format::Reader reader(file);
  if (!reader.has("prm")) throw UsageError(file.string() + " has no section prm");
  return plan::settingsFromJson(reader.meta().provenance().settings_json());
}

void addCandidates(const std::filesystem::path& file, size_t evaluator, const cli::CpuPrm& prm, std::span<const uint32_t> brightest,
                   std::vector<Candidate>& candidates) {
  const std::string name = file.filename().string();
  if (prm.info().layout != LW_PRM_PANES) {
    candidates.push_back({name, "local bases", evaluator});
    return;
  }
  candidates.push_back({name, std::to_string(prm.info().clusters) + " panes", evaluator});
  for (const uint32_t k : brightest)
    for (const uint32_t keep_energy : {0u, 1u})
      candidates.push_back(
          {name, "brightest " + std::to_string(k) + (keep_energy ? ", energy kept" : ", rest dropped"), evaluator, k, keep_energy});
}

/// Errors of the lights of one band as one row of the table.
json rowOf(const Candidate& candidate, std::span<const TestLight> lights, const Band& band) {
  std::vector<double> relrmse, texrel, bias;
  for (size_t i = 0; i < lights.size(); ++i) {
    const float distance_m = lights[i].surface_distance_m;
    if (lights[i].sealed || distance_m < band.from_m || distance_m >= band.to_m) continue;
    relrmse.push_back(candidate.errors[i].relrmse);
    texrel.push_back(candidate.errors[i].texrel);
    bias.push_back(candidate.errors[i].bias);
  }
  return {{"container", candidate.container},
          {"variant", candidate.variant},
          {"distance", band.name},
          {"lights", relrmse.size()},
          {"relrmse_median", quantile(relrmse, 0.5)},
          {"relrmse_p90", quantile(relrmse, 0.9)},
          {"texrel_median", quantile(texrel, 0.5)},
          {"texrel_p90", quantile(texrel, 0.9)},
          {"bias_median", quantile(bias, 0.5)},
          {"bias_p90", quantile(bias, 0.9)}};
}

void printCsv(const json& rows) {
  constexpr const char* kColumns[] = {"container",   "variant",       "distance",   "lights",      "relrmse_median",
                                      "relrmse_p90", "texrel_median", "texrel_p90", "bias_median", "bias_p90"};
  for (const char* column : kColumns) std::printf("%s%s", column == kColumns[0] ? "" : ",", column);
  for (const auto& row : rows) {
    std::printf("\n\"%s\",\"%s\",\"%s\",%d", row["container"].get_ref<const std::string&>().c_str(),
                row["variant"].get_ref<const std::string&>().c_str(), row["distance"].get_ref<const std::string&>().c_str(),
                row["lights"].get<int>());
    for (size_t i = 4; i < std::size(kColumns); ++i) {
      const double value = row[kColumns[i]];
      std::printf(std::isfinite(value) ? ",%.4f" : ",", value);
    }
  }
  std::printf("\n");
}

json lightsJson(std::span<const TestLight> lights, std::span<const Candidate> candidates) {
  json list = json::array();
  for (size_t i = 0; i < lights.size(); ++i) {
    json errors = json::array();
    for (const auto& c : candidates)
      errors.push_back({{"container", c.container},
                        {"variant", c.variant},
                        {"relrmse", c.errors[i].relrmse},
                        {"texrel", c.errors[i].texrel},
                        {"bias", c.errors[i].bias}});
    list.push_back({{"surface_distance_m", lights[i].surface_distance_m},
                    {"mean_irradiance", lights[i].mean_irradiance},
                    {"sealed", lights[i].sealed},
                    {"errors", errors}});
  }
  return list;
}

void run(const Options& options) {
  cli::Console console;
  plan::Settings settings = settingsOf(options.containers[0]);
  for (const auto& file : options.containers)
    if (settingsOf(file).lightmap_size != settings.lightmap_size) throw UsageError("the containers differ in --lightmap-size");
  Diagnostics diagnostics;
  const CancelFlag cancel;
  const bake::BakeContext context({options.scene, {}}, settings, options.threads, diagnostics, cancel,
                                  [&](const std::string& stage) { console.progress(stage, stage + " …"); });
  if (!context.tracer()) throw UsageError(options.scene.string() + " has no surfaces");
  const trace::Tracer& tracer = *context.tracer();
  const atlas::Atlas& atlas = context.atlas();
  scene::Scene dark = context.scene();  // the error is that of moving light alone
  for (auto& material : dark.materials) material.emissive = Rgb(0.0f);

  std::vector<std::unique_ptr<cli::RuntimeContainer>> containers;
  std::vector<cli::CpuPrm> evaluators;
  std::vector<Candidate> candidates;
  for (const auto& file : options.containers) {
    containers.push_back(std::make_unique<cli::RuntimeContainer>(file));
    evaluators.emplace_back(*containers.back());
    addCandidates(file, evaluators.size() - 1, evaluators.back(), options.brightest, candidates);
  }

  const auto slots = sampleSlots(atlas.slots.size(), options.texels, options.seed);
  std::vector<TestLight> lights;
  for (const auto& prior :
       transport::samplePriorLights(context.scene(), atlas, tracer, options.lights, combineKeys(options.seed, kLightKey)))
    lights.push_back({prior, surfaceDistance(context.scene(), prior.light.position)});
  for (size_t i = 0; i < lights.size(); ++i) {
    console.progress("lights", "light " + std::to_string(i + 1) + " of " + std::to_string(lights.size()));
    const std::vector<scene::Light> light{lights[i].prior.light};
    std::vector<std::vector<Rgb>> references_rgb;
    for (uint64_t k = 0; k < kReferences; ++k) {
      transport::ReferenceOptions reference{.samples = options.samples, .threads = options.threads};
      reference.seed = combineKeys(combineKeys(options.seed, kLightKey), k);
      references_rgb.push_back(
          transport::referenceIrradianceOf(slots, dark, atlas, tracer, light, transport::Component::indirect, reference).irradiance_rgb);
      for (const auto& value : references_rgb[k]) lights[i].mean_irradiance += luminance(value) / (kReferences * double(slots.size()));
    }
    std::vector<std::vector<float>> cluster_rgb;
    for (const auto& evaluator : evaluators) cluster_rgb.push_back(evaluator.clusterIrradiance(context.scene(), tracer, light));
    for (auto& candidate : candidates) {
      lw_prm_options prm = LW_PRM_OPTIONS_INIT;
      prm.brightest = candidate.brightest, prm.keep_energy = candidate.keep_energy, prm.emitters = LW_EMITTERS_OFF, prm.fill = 0;
      const auto atlas_rgba = evaluators[candidate.evaluator].evaluate(cluster_rgb[candidate.evaluator], prm);
      std::vector<Rgb> values;
      for (const uint32_t slot : slots) {  // a texel without a value is as dark as the runtime shows it
        const float* value = &atlas_rgba[size_t(atlas.slots[slot].texel) * 4];
        values.emplace_back(value[0], value[1], value[2]);
      }
      candidate.errors.push_back(transport::compareWithReferences(references_rgb, values));
    }
  }

  std::vector<double> means;
  for (const auto& light : lights) means.push_back(light.mean_irradiance);
  const double enough = 0.1 * quantile(means, 0.5);
  for (auto& light : lights) light.sealed = light.mean_irradiance < enough;
  json rows = json::array();
  for (const auto& candidate : candidates)
    for (const auto& band : kBands) rows.push_back(rowOf(candidate, lights, band));
  console.line(std::to_string(std::count_if(lights.begin(), lights.end(), [](const auto& l) { return l.sealed; })) + " of " +
               std::to_string(lights.size()) + " lights are in sealed pockets and left out; " + std::to_string(slots.size()) + " of " +
               std::to_string(atlas.slots.size()) + " texels, " + std::to_string(kReferences) + " x " + std::to_string(options.samples) +
               " paths each");
  if (!options.json) return printCsv(rows);
  std::printf("%s\n", json{{"texels", slots.size()},
                           {"samples", options.samples},
                           {"seed", options.seed},
                           {"rows", rows},
                           {"lights", lightsJson(lights, candidates)}}
                          .dump(1)
                          .c_str());
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Errors of containers against path tracing, for many lights that no bake has seen: CSV or JSON on stdout.", "prm_accuracy");
  app.add_option("scene", options.scene, "The scene that the containers were baked from")->required();
  app.add_option("--container", options.containers, "Container to measure; may be given several times")->required();
  app.add_option("--brightest", options.brightest, "Panes: also with the K brightest clusters only; may be given several times")
      ->check(CLI::Range(1u, 1u << 20));
  app.add_option("--lights", options.lights, "Test lights")->check(CLI::Range(1u, 100000u))->capture_default_str();
  app.add_option("--samples", options.samples, "Paths per texel in each of the four references")
      ->check(CLI::Range(1u, 1u << 20))
      ->capture_default_str();
  app.add_option("--texels", options.texels, "Texels compared, chosen at random; 0: all")->capture_default_str();
  app.add_option("--seed", options.seed, "Of lights, texels and references")->capture_default_str();
  app.add_option("--threads", options.threads, "0: all")->capture_default_str();
  app.add_flag("--json", options.json, "JSON with the errors of every light instead of CSV");
  CLI11_PARSE(app, argc, argv);
  try {
    run(options);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "prm_accuracy: %s\n", error.what());
    return 1;
  }
}
