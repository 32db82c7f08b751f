#include "cli/report/laboratory.h"

#include <chrono>

#include "cli/irradiance_image.h"
#include "cli/lightmap_evaluator.h"
#include "cli/prm_evaluator.h"
#include "cli/radiosity_evaluator.h"
#include "cli/report/frame_cost.h"
#include "cli/slot_values.h"
#include "cli/vpl_evaluator.h"
#include "cli/vpl_evaluator_gl.h"
#include "format/encode/atomic_file.h"
#include "precompute/bake/bake.h"
#include "precompute/bake/container_scene.h"
#include "precompute/core/random.h"
#include "precompute/scene/import.h"
#include "precompute/transport/prm/light_prior.h"

namespace lightwell::report {
namespace {

using Clock = std::chrono::steady_clock;
using plan::Technique;
using transport::Component;

constexpr uint64_t kFirstSeed = 1001, kSecondSeed = 1002;  // apart from what bakes use
constexpr uint32_t kSamples = 64;                           // points of each texel, as `evaluate` has it
constexpr uint32_t kShadowMapSide = 256;                    // likewise
constexpr float kPieces = 8;
constexpr uint32_t kMadeLamps = 3;
constexpr uint64_t kMadeLampsSeed = 17;
constexpr uint64_t kKeyVersion = 1;                         // of what is measured, and how

double secondsSince(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

/// For a POSIX shell, where the name needs it.
std::string quoted(const std::string& text) {
  if (!text.empty() && text.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./+-=:@%,") == std::string::npos) return text;
  std::string quote = "'";
  for (const char c : text) quote += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quote + "'";
}

std::string shortest(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

/// Point lights where lights can be, for a scene in which nothing shines.
void writeLamps(const fs::path& file, const bake::BakeContext& context) {
  nlohmann::json lights = nlohmann::json::array();
  const scene::Scene& scene = context.scene();
  for (const auto& prior : transport::samplePriorLights(scene, context.atlas(), *context.tracer(), kMadeLamps, kMadeLampsSeed)) {
    nlohmann::json position = nlohmann::json::array();
    for (int c = 0; c < 3; ++c) position.push_back(scene.origin_m[c] + double(prior.light.position[c]) * scene.metres_per_unit);
    lights.push_back({{"type", "point"}, {"position", position}, {"intensity", 100}});
  }
  const std::string text = nlohmann::json{{"lights", lights}}.dump(1) + "\n";
  format::writeFileAtomically(file, std::vector<uint8_t>(text.begin(), text.end()));
}

uint64_t raysOf(const trace::Tracer& tracer) {
  const auto counts = tracer.counts();
  return counts.closest + counts.occlusion;
}

}  // namespace

/// A container as the runtime and the tracer have it.
struct Laboratory::Opened {
  Opened(const fs::path& file, const std::optional<fs::path>& lights, int threads) : reader(file), runtime(file) {
    Diagnostics diagnostics;
    scene = bake::loadContainerScene(reader, diagnostics);
    if (lights) scene::replaceLights(scene.scene, *lights, diagnostics);
    tracer.emplace(scene.scene, threads);
  }
  format::Reader reader;
  cli::RuntimeContainer runtime;
  bake::ContainerScene scene;
  std::optional<trace::Tracer> tracer;
  std::string name;      // of its maps
  std::string options;   // of `evaluate`
  std::string file;      // as commands name it
};

Laboratory::Laboratory(const LaboratoryOptions& options, Report& report, Diagnostics& diagnostics, const CancelFlag& cancel, const std::function<void(const std::string&)>& stage)
    : options_(options) {
  const auto import = [&] { context_ = std::make_unique<bake::BakeContext>(options_.source, options_.settings, options_.threads, diagnostics, cancel, stage); };
  import();
  if (!context_->tracer() || context_->atlas().slots.empty()) throw UsageError(options_.source.scene.string() + " has no surfaces: there is no light to measure");
  const plan::SceneFacts& facts = context_->facts();
  if (!options_.source.lights && !facts.has_lamps && !facts.has_emitters && !facts.has_sky_light) {
    report.made_lights = "the scene has no light of its own: " + std::to_string(kMadeLamps) + " point lights of 100 cd were put where lights can be (lights.json)";
    options_.source.lights = options_.folder / "lights.json";
    writeLamps(*options_.source.lights, *context_);
    import();
  }
  for (const char* folder : {"maps", "containers"}) fs::create_directories(options_.folder / folder);
  warnings_ = diagnostics.warnings();
  for (const auto& one : context_->stageTimes()) stage_seconds_ += one.seconds;

  bake::KeyHasher hasher;
  hasher.add(kKeyVersion).add(std::string_view(bake::productVersion())).add(context_->keys().surfaces).add(context_->keys().lights).add(context_->keys().portals).add(context_->skyKey());
  key_ = hasher.add(std::string_view(plan::canonicalJson(options_.settings))).finish().hex();
  report.scene = options_.source.scene.string();
  report.environment = options_.source.environment ? options_.source.environment->string() : "";
  report.lights = options_.source.lights ? options_.source.lights->string() : "";
  report.version = bake::productVersion();
  report.key = key_;
  report.lightmap_size = options_.settings.lightmap_size;
  report.texels = context_->atlas().slots.size();
  report.triangles = context_->scene().mesh.triangles.size();
  report.lamps = context_->scene().lights.size();
  report.stage_seconds = stage_seconds_;
}

std::string Laboratory::keyOf(const Rung& rung) const {
  bake::KeyHasher hasher;
  hasher.add(std::string_view(key_)).add(std::string_view(rung.series)).add(std::string_view(rung.setting)).add(std::string_view(plan::canonicalJson(rung.settings))).add(options_.gl).add(rung.sweeps);
  for (const uint32_t count : rung.brightest) hasher.add(count);
  return hasher.finish().hex();
}

/// Of `bake` and `reference` alike, in the report's folder.
std::string Laboratory::sceneOptions() const {
  const plan::Settings& s = options_.settings;
  std::string text = quoted(fs::absolute(options_.source.scene).string()) + " --lightmap-size " + std::to_string(s.lightmap_size);
  if (s.light_units != scene::LightUnits::spec) text += " --light-units " + std::string(plan::name(s.light_units));
  if (options_.source.lights) text += " --lights " + quoted(fs::absolute(*options_.source.lights).string());
  if (!options_.source.environment) return text;
  text += " --environment " + quoted(fs::absolute(*options_.source.environment).string());
  if (s.environment.rotation_deg != 0) text += " --environment-rotation " + shortest(double(s.environment.rotation_deg));
  if (s.environment.intensity != 1) text += " --environment-intensity " + shortest(double(s.environment.intensity));
  if (const auto& ground = s.environment.ground_radiance_rgb)
    text += " --environment-ground " + shortest(double((*ground)[0])) + " " + shortest(double((*ground)[1])) + " " + shortest(double((*ground)[2]));
  return text;
}

uint32_t Laboratory::samplesWithin(double seconds, const CancelFlag& cancel) const {
  constexpr uint32_t kPilot = 16, kFewest = 16, kMost = 4096, kPilotSlots = 512;
  const auto& slots = context_->atlas().slots;
  std::vector<uint32_t> some;
  for (uint32_t i = 0; i < kPilotSlots; ++i) some.push_back(uint32_t(mixBits(combineKeys(kFirstSeed, i)) % slots.size()));
  const auto begin = Clock::now();
  transport::referenceIrradianceOf(some, context_->scene(), context_->atlas(), *context_->tracer(), context_->scene().lights, Component::indirect,
                                   {.samples = kPilot, .seed = kFirstSeed, .threads = options_.threads, .sky = context_->skyLight(), .cancel = &cancel});
  const double per_sample = secondsSince(begin) / (kPilot * double(kPilotSlots)) * double(slots.size()) * 2;
  uint32_t samples = kFewest;
  while (samples < kMost && 2 * samples * per_sample <= seconds) samples *= 2;
  return samples;
}

Reference Laboratory::traceReferences(uint32_t samples, const CancelFlag& cancel, const std::function<void(double)>& progress) {
  Reference reference{.samples = samples, .first_seed = kFirstSeed, .second_seed = kSecondSeed, .first = "maps/reference_a.exr", .second = "maps/reference_b.exr"};
  const auto begin = Clock::now();
  const auto trace = [&](uint64_t seed, const std::string& file, double already, ImageRgba& image, std::string& command) {
    transport::ReferenceOptions options{.samples = samples, .seed = seed, .threads = options_.threads, .sky = context_->skyLight(), .cancel = &cancel};
    options.progress = [&](double fraction) { progress(already + 0.5 * fraction); };
    const auto map = transport::referenceIrradiance(context_->scene(), context_->atlas(), *context_->tracer(), context_->scene().lights, Component::indirect, options);
    image = cli::imageOfSlots(context_->scene().mesh, context_->atlas(), options_.settings.lightmap_size, map.irradiance_rgb);
    writeExr(options_.folder / file, image);
    command = "lightwell reference " + sceneOptions() + " --component indirect --samples " + std::to_string(samples) + " --seed " + std::to_string(seed) + " -o " + file;
  };
  trace(kFirstSeed, reference.first, 0, truth_.first, reference.first_command);
  trace(kSecondSeed, reference.second, 0.5, truth_.second, reference.second_command);
  reference.seconds = secondsSince(begin);
  describeNoise(truth_, reference);
  return reference;
}

void Laboratory::readReferences(const Reference& reference) {
  truth_.first = readExr(options_.folder / reference.first);
  truth_.second = readExr(options_.folder / reference.second);
  for (const ImageRgba* image : {&truth_.first, &truth_.second})
    if (image->width != options_.settings.lightmap_size || image->height != image->width) throw InputError((options_.folder / reference.first).string(), "", "is of another size");
}

Baked Laboratory::measure(const Rung& rung, const CancelFlag& cancel) {
  Baked baked{.series = rung.series, .setting = rung.setting, .technique = std::string(plan::name(rung.technique())), .file = "containers/" + rung.fileName() + ".lwc", .key = keyOf(rung)};
  baked.command = "lightwell bake " + sceneOptions() + " --techniques " + baked.technique + " " + rung.options + " -o " + baked.file;
  const auto begin = Clock::now();
  const uint64_t rays_before = raysOf(*context_->tracer());
  bake::ThreadExecutor executor(options_.threads);
  bake::NullStore store;
  bake::TaskRunner tasks(executor, store, {.cancel = &cancel});
  const bake::BakeGraph graph = bake::makeBakeGraph(*context_, {.settings = rung.settings, .warnings = warnings_, .test_lights = 0}, tasks);
  for (const plan::Omitted& omitted : graph.omitted)
    if (omitted.type == baked.technique) throw UsageError(omitted.reason);
  const bake::RunResult result = tasks.run(graph.graph, std::array{graph.container}, Clock::time_point::max());
  const double task_seconds = secondsSince(begin);
  baked.seconds = stage_seconds_ + task_seconds;
  baked.rays = raysOf(*context_->tracer()) - rays_before;
  double named = 0;
  for (const auto& one : context_->stageTimes()) baked.phases.push_back({one.name, one.seconds});
  for (const auto& one : result.phases) baked.phases.push_back({one.name, one.seconds}), named += one.seconds;
  if (task_seconds - named > 0.01 * task_seconds) baked.phases.insert(baked.phases.begin() + std::ptrdiff_t(context_->stageTimes().size()), {"prepare", task_seconds - named});
  format::writeFileAtomically(options_.folder / baked.file, *result.goals[0]);

  Opened opened(options_.folder / baked.file, std::nullopt, options_.threads);
  opened.name = rung.fileName(), opened.file = baked.file;
  baked.container_bytes = result.goals[0]->size();
  for (const auto& section : bake::sectionSizes(opened.reader))
    if (section.type == baked.technique) baked.section_bytes = section.stored_bytes;
  if (baked.section_bytes == 0) throw UsageError("no light of a lamp or emitter meets a surface that reflects it");
  if (rung.technique() == Technique::radiosity) baked.uncompressed_bytes = 8 * opened.reader.radiosity().raw_transfers();
  evaluate(opened, rung, baked, cancel);
  return baked;
}

Evaluated Laboratory::compared(const Opened& opened, const std::vector<Rgb>& slot_rgb, const std::string& name) const {
  Evaluated evaluated;
  const ImageRgba image = cli::imageOfSlots(opened.scene.scene.mesh, opened.scene.atlas, opened.scene.atlas.width, slot_rgb);
  evaluated.map = "maps/" + name + ".exr";
  writeExr(options_.folder / evaluated.map, image);
  compareWith(truth_, image, evaluated);
  return evaluated;
}

void Laboratory::evaluate(Opened& opened, const Rung& rung, Baked& baked, const CancelFlag& cancel) {
  const auto add = [&](const std::vector<Rgb>& slot_rgb, const std::string& variant, const std::string& options, bool by_command = true) -> Evaluated& {
    std::string name = opened.name;
    for (const char c : variant) name += c == ' ' ? '_' : c;
    Evaluated evaluated = compared(opened, slot_rgb, name);
    evaluated.variant = variant;
    if (by_command)
      evaluated.command = "lightwell evaluate " + opened.file + " --technique " + baked.technique + " --component indirect" + opened.options + options + " -o " + evaluated.map;
    return baked.evaluated.emplace_back(std::move(evaluated));
  };
  const auto& atlas = opened.scene.atlas;
  FrameSettings frame{.gl = options_.gl};
  switch (rung.technique()) {
    case Technique::prm: {
      const bool panes = opened.reader.prm().layout() == v1::PRM_LAYOUT_PANES;
      for (const uint32_t brightest : rung.brightest.empty() ? std::vector<uint32_t>{0} : rung.brightest) {
        const auto rgba = cli::evaluatePrmOnCpu({.container = opened.runtime, .scene = opened.scene.scene, .tracer = *opened.tracer, .lights = opened.scene.scene.lights,
                                                 .emitters = LW_EMITTERS_INDIRECT | LW_SKY_INDIRECT, .brightest = panes ? std::optional(brightest) : std::nullopt});
        Evaluated& evaluated = add(cli::valuesOfSlots(atlas, rgba), !panes ? "" : brightest ? "brightest " + std::to_string(brightest) : "all panes",
                                   panes ? " --brightest " + std::to_string(brightest) : "");
        frame.brightest = brightest;
        measureFrame(opened.runtime, opened.reader, "prm", frame, evaluated);
        cancel.check();
      }
      break;
    }
    case Technique::radiosity: {
      const cli::RadiosityEvaluation evaluation{.container = opened.runtime, .scene = opened.scene, .tracer = *opened.tracer, .light = LW_RADIOSITY_INDIRECT, .samples = kSamples, .portal_open = {},
                                                .threads = options_.threads, .cancel = &cancel};
      Evaluated& solved = add(cli::valuesOfSlots(atlas, cli::evaluateRadiosityOnCpu(evaluation)), "", "");
      measureFrame(opened.runtime, opened.reader, "radiosity", frame, solved);
      for (const uint32_t sweeps : rung.sweeps ? std::vector<uint32_t>{1, 2, 3, 5, 8} : std::vector<uint32_t>{}) {
        const auto radiosity = opened.runtime.loadRadiosity();
        const auto state = opened.runtime.createState(radiosity.get());
        opened.runtime.check(lw_radiosity_set_direct(state.get(), cli::tracedIrradiance(evaluation, radiosity.get()).data()));
        opened.runtime.check(lw_radiosity_step(state.get(), sweeps));
        lw_radiosity_shading shading = LW_RADIOSITY_SHADING_INIT;
        shading.light = LW_RADIOSITY_INDIRECT;
        shading.fill = 0;
        std::vector<float> rgba(size_t(atlas.width) * size_t(atlas.height) * 4);
        opened.runtime.check(lw_radiosity_shade(state.get(), &shading, rgba.data()));
        Evaluated& evaluated = add(cli::valuesOfSlots(atlas, rgba), std::to_string(sweeps) + (sweeps == 1 ? " sweep" : " sweeps"), "", false);
        frame.sweeps = sweeps;
        measureFrame(opened.runtime, opened.reader, "radiosity", frame, evaluated);
        cancel.check();
      }
      break;
    }
    case Technique::vpl: {
      add(cli::evaluateVplOnCpu({.container = opened.runtime, .scene = opened.scene, .tracer = *opened.tracer, .component = Component::indirect, .samples = kSamples,
                                 .threads = options_.threads, .cancel = &cancel, .progress = [](double) {}})
              .irradiance_rgb,
          "", "");
      if (!options_.gl) break;
      const cli::VplGlResult drawn = cli::evaluateVplOnGl({.container = opened.runtime, .component = Component::indirect, .shadow_map_side = kShadowMapSide, .pieces = kPieces,
                                                           .progress = [&](double) { cancel.check(); }});
      add(cli::valuesOfSlots(atlas, drawn.atlas_rgba), "OpenGL", " --evaluator gl").load_ms = drawn.setup_ms + drawn.draw_ms;
      break;
    }
    case Technique::lightmap:
      measureFrame(opened.runtime, opened.reader, "lightmap", frame, add(cli::valuesOfSlots(atlas, cli::evaluateLightmapOnCpu(opened.runtime, LW_LIGHTMAP_INDIRECT)), "", ""));
      break;
    case Technique::environment: break;
  }
}

std::vector<Baked> Laboratory::measureGiven(const fs::path& container, const CancelFlag& cancel) {
  Opened opened(container, options_.source.lights, options_.threads);
  const atlas::Atlas& ours = context_->atlas();
  if (opened.scene.atlas.width != ours.width || opened.scene.atlas.slots.size() != ours.slots.size())
    throw UsageError(container.string() + " has an atlas of " + std::to_string(opened.scene.atlas.width) + " texels along a side and " + std::to_string(opened.scene.atlas.slots.size()) +
                     " covered ones, the scene " + std::to_string(ours.width) + " and " + std::to_string(ours.slots.size()) + ": give the --lightmap-size that it was baked with");
  opened.file = quoted(fs::absolute(container).string());
  std::vector<Baked> all;
  for (const Technique technique : {Technique::prm, Technique::radiosity, Technique::vpl, Technique::lightmap}) {
    const std::string name(plan::name(technique));
    if (!opened.reader.has(name)) continue;
    const bool moves = technique == Technique::prm || technique == Technique::radiosity;
    opened.options = moves && options_.source.lights ? " --lights " + quoted(fs::absolute(*options_.source.lights).string()) : "";
    opened.name = "given_" + container.stem().string() + "_" + name;
    Baked baked{.series = "given", .setting = container.stem().string() + ", " + name, .technique = name, .file = container.string()};
    baked.container_bytes = fs::file_size(container);
    for (const auto& section : bake::sectionSizes(opened.reader))
      if (section.type == name) baked.section_bytes = section.stored_bytes;
    Rung rung;
    rung.settings.techniques = {technique};
    if (technique == Technique::prm && opened.reader.prm().layout() == v1::PRM_LAYOUT_PANES) rung.brightest = {32, 0};
    evaluate(opened, rung, baked, cancel);
    all.push_back(std::move(baked));
  }
  if (all.empty()) throw UsageError(container.string() + " has no section that gives light to surfaces: prm, radiosity, vpl or lightmap");
  return all;
}

}  // namespace lightwell::report
