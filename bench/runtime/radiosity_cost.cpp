// What radiosity costs at run time: a sweep for each link on the CPU and on OpenGL, texels, injection, probes (where the container has some), and how many sweeps all bounces take at which albedo.
//   radiosity_cost A.lwc [B.lwc …] [--repeats 9] [--json]
// Wall clock until glFinish returns, medians. No window. Residuals are those of the CPU's float solution in double precision.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/gl_handles.h"
#include "cli/runtime_handles.h"
#include "format/encode/reader.h"
#include "render/egl_context.h"
#include "render/gl_objects.h"

using namespace lightwell;
using nlohmann::json;

namespace {

struct Options {
  std::vector<std::filesystem::path> containers;
  int repeats = 9;
  bool json = false;
};

double medianSeconds(int repeats, const std::function<void()>& work) {
  std::vector<double> seconds;
  for (int i = -1; i < repeats; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    if (i >= 0) seconds.push_back(took.count());
  }
  std::nth_element(seconds.begin(), seconds.begin() + std::ptrdiff_t(seconds.size() / 2), seconds.end());
  return seconds[seconds.size() / 2];
}

/// The links as the container has them, swept in double precision.
class DoubleSweep {
 public:
  explicit DoubleSweep(const format::Reader& reader)
      : area_(reader.read<float>("radiosity", "patch_area")), scale_(reader.read<float>("radiosity", "row_scale")),
        first_(reader.read<uint32_t>("radiosity", "link_first")), node_(reader.read<uint32_t>("radiosity", "link_node")),
        code_(reader.read<uint8_t>("radiosity", "link_code")) {}

  /// One channel, portals open.
  std::vector<double> gather(std::vector<double> radiosity) const {
    std::vector<double> area(area_.begin(), area_.end());
    size_t begin = 0;
    for (size_t end = radiosity.size(); end - begin > 8;) {
      const size_t next = end;
      for (size_t child = begin; child < end; child += 8) {
        double sum = 0, whole = 0;
        for (size_t i = child; i < std::min(child + 8, end); ++i) sum += radiosity[i] * area[i], whole += area[i];
        radiosity.push_back(sum / whole), area.push_back(whole);
      }
      begin = next, end = radiosity.size();
    }
    std::vector<double> irradiance(scale_.size());
    for (size_t row = 0; row < scale_.size(); ++row) {
      double sum = 0;
      for (uint32_t l = first_[row]; l < first_[row + 1]; ++l) sum += double((16u + (code_[l] & 15u)) << (code_[l] >> 4)) * radiosity[node_[l]];
      irradiance[row] = sum * double(scale_[row]);
    }
    return irradiance;
  }

 private:
  std::vector<float> area_, scale_;
  std::vector<uint32_t> first_, node_;
  std::vector<uint8_t> code_;
};

json measureProbes(const Options& options, const cli::RuntimeContainer& container, const lw_radiosity* radiosity, lw_radiosity_state* state, lw_gl_radiosity* gl_radiosity) {
  lw_probes* loaded = nullptr;
  container.check(lw_probes_load(container.get(), radiosity, &loaded));
  const std::unique_ptr<lw_probes, decltype(&lw_probes_release)> probes(loaded, lw_probes_release);
  lw_probes_info info;
  container.check(lw_probes_get_info(loaded, &info));
  std::vector<float> sh(size_t(info.probes) * 27);
  json result{{"probes", info.probes}, {"links", info.links}};
  for (const uint32_t coefficients : {9u, 4u}) {
    lw_probes_evaluation evaluation = LW_PROBES_EVALUATION_INIT;
    evaluation.coefficients = coefficients;
    lw_gl_probes_options gl_options = LW_GL_PROBES_OPTIONS_INIT;
    gl_options.coefficients = coefficients;
    lw_gl_probes* uploaded = nullptr;
    container.check(lw_gl_probes_create(gl_radiosity, loaded, &gl_options, &uploaded));
    const cli::GlProbesHandle gl_probes(uploaded);
    const double cpu = medianSeconds(options.repeats, [&] { container.check(lw_probes_evaluate(loaded, state, &evaluation, sh.data())); });
    const double gl = medianSeconds(options.repeats, [&] { container.check(lw_gl_probes_evaluate(uploaded, evaluation.light)); glFinish(); });
    result["evaluate"].push_back({{"coefficients", coefficients}, {"cpu_ms", 1e3 * cpu}, {"cpu_ns_per_link", 1e9 * cpu / info.links}, {"gl_ms", 1e3 * gl},
                                  {"gl_ns_per_link", 1e9 * gl / info.links}, {"gl_texture_bytes", lw_gl_probes_texture_bytes(uploaded)}});
  }
  constexpr int kLookups = 1000;
  float around[9][3];
  result["sample_us"] = 1e6 / kLookups * medianSeconds(options.repeats, [&] {
    for (int i = 0; i < kLookups; ++i) {
      const float* at = info.position_m + size_t(i) * 7 % info.probes * 3;
      const float position[3] = {at[0] + 0.3f * info.lattice_spacing_m, at[1] + 0.2f * info.lattice_spacing_m, at[2] - 0.4f * info.lattice_spacing_m};
      container.check(lw_probes_sample(loaded, sh.data(), position, around));
    }
  });
  return result;
}

json measure(const Options& options, const std::filesystem::path& file, lw_gl* gl) {
  const cli::RuntimeContainer container(file);
  const format::Reader reader(file);
  const auto radiosity = container.loadRadiosity();
  const auto state = container.createState(radiosity.get());
  lw_radiosity_info info;
  container.check(lw_radiosity_get_info(radiosity.get(), &info));
  std::vector<float> direct(size_t(info.patches) * 3, 0.0f), atlas(size_t(info.width) * info.height * 4);
  for (size_t i = 0; i < direct.size(); ++i) direct[i] = i / 3 % 17 == 0 ? 10.0f : 0.1f;
  container.check(lw_radiosity_set_direct(state.get(), direct.data()));
  const double links = info.links;

  json result{{"container", file.filename().string()}, {"patches", info.patches}, {"links", info.links}, {"texels", info.texels}};
  uint64_t link_bytes = 0;
  for (const char* chunk : {"link_first", "link_node", "link_code", "row_scale"}) link_bytes += reader.chunk("radiosity", chunk).stored_bytes;
  result["stored_bytes_per_link"] = double(link_bytes) / links;
  result["cpu_ns_per_link"] = 1e9 / links * medianSeconds(options.repeats, [&] { container.check(lw_radiosity_step(state.get(), 1)); });
  result["cpu_shade_ms"] = 1e3 * medianSeconds(options.repeats, [&] { container.check(lw_radiosity_shade(state.get(), nullptr, atlas.data())); });

  lw_radiosity_injector* made = nullptr;
  container.check(lw_radiosity_injector_create(container.get(), radiosity.get(), 128, &made));
  const std::unique_ptr<lw_radiosity_injector, decltype(&lw_radiosity_injector_destroy)> injector(made, lw_radiosity_injector_destroy);
  lw_scene_info scene;
  container.check(lw_get_scene_info(container.get(), &scene));
  lw_light lamp{};
  lamp.type = LW_LIGHT_POINT;
  for (int k = 0; k < 3; ++k) lamp.position_m[k] = 0.5f * (scene.bounds_min_m[k] + scene.bounds_max_m[k]), lamp.intensity_rgb[k] = 1;
  result["cpu_inject_128_ms"] = 1e3 * medianSeconds(options.repeats, [&] { container.check(lw_radiosity_inject(injector.get(), &lamp, 1, direct.data())); });

  lw_gl_radiosity* uploaded = nullptr;
  container.check(lw_gl_radiosity_create(gl, radiosity.get(), nullptr, &uploaded));
  const cli::GlRadiosityHandle gl_radiosity(uploaded);
  container.check(lw_gl_radiosity_upload(gl_radiosity.get(), state.get(), LW_GL_RADIOSITY_DIRECT));
  result["gl_ns_per_link"] = 1e9 / links * medianSeconds(options.repeats, [&] { container.check(lw_gl_radiosity_step(gl_radiosity.get(), 1)); glFinish(); });
  result["gl_shade_ms"] = 1e3 * medianSeconds(options.repeats, [&] { container.check(lw_gl_radiosity_shade(gl_radiosity.get(), nullptr)); glFinish(); });
  result["gl_texture_bytes"] = lw_gl_radiosity_texture_bytes(gl_radiosity.get());

  lw_gl_radiosity_injector* gl_made = nullptr;
  container.check(lw_gl_radiosity_injector_create(gl_radiosity.get(), container.get(), radiosity.get(), 128, &gl_made));
  const cli::GlRadiosityInjectorHandle gl_injector(gl_made);
  result["gl_inject_128_ms"] = 1e3 * medianSeconds(options.repeats, [&] { container.check(lw_gl_radiosity_inject(gl_injector.get(), &lamp, 1)); glFinish(); });
  if (lw_has_section(container.get(), "probes")) result["probes"] = measureProbes(options, container, radiosity.get(), state.get(), gl_radiosity.get());

  const DoubleSweep exact(reader);
  for (const float albedo : {0.5f, 0.9f, 0.99f, 0.999f}) {
    const auto bright = container.createState(radiosity.get());
    lw_radiosity_material material = LW_RADIOSITY_MATERIAL_INIT;
    for (int k = 0; k < 3; ++k) material.albedo_factor_rgb[k] = 0, material.albedo_rgb[k] = albedo, material.emission_factor_rgb[k] = 0;
    for (uint32_t m = 0; m < info.materials; ++m) container.check(lw_radiosity_set_material(bright.get(), m, &material));
    for (size_t i = 0; i < direct.size(); ++i) direct[i] = i / 3 % 17 == 0 ? 10.0f : 0.1f;
    container.check(lw_radiosity_set_direct(bright.get(), direct.data()));
    lw_radiosity_report report;
    const auto begin = std::chrono::steady_clock::now();
    container.check(lw_radiosity_solve(bright.get(), 1e-6, 1000, &report));
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    std::vector<float> irradiance(direct.size());
    container.check(lw_radiosity_get_irradiance(bright.get(), LW_RADIOSITY_INDIRECT | LW_RADIOSITY_EMITTERS, irradiance.data()));
    std::vector<double> radiosity_of_patch(info.patches);
    for (size_t i = 0; i < info.patches; ++i) radiosity_of_patch[i] = double(albedo) * (double(direct[i * 3]) + double(irradiance[i * 3]));
    const std::vector<double> swept = exact.gather(radiosity_of_patch);
    double difference = 0, square = 0;
    for (size_t i = 0; i < info.patches; ++i) difference += std::pow(swept[i] - double(irradiance[i * 3]), 2), square += swept[i] * swept[i];
    const double residual = std::sqrt(difference / square);
    // Plain sweeps lose a factor of the albedo each.
    result["solve"].push_back({{"albedo", albedo}, {"sweeps", report.sweeps}, {"seconds", took.count()}, {"residual", report.residual},
                               {"residual_in_double", residual}, {"plain_sweeps", std::ceil(std::log(1e-6) / std::log(double(albedo)))}});
  }
  return result;
}

}  // namespace

int main(int argc, char** argv) try {
  Options options;
  CLI::App app("What radiosity costs at run time");
  app.add_option("containers", options.containers, "Containers with a section radiosity")->required();
  app.add_option("--repeats", options.repeats)->check(CLI::Range(1, 1000))->capture_default_str();
  app.add_flag("--json", options.json);
  CLI11_PARSE(app, argc, argv);
  const render::EglContext context;
  lw_gl_config config = LW_GL_CONFIG_INIT;
  config.loader = render::EglContext::load;
  lw_gl* made = nullptr;
  if (lw_gl_create(&config, &made) != LW_OK) throw std::runtime_error("no OpenGL");
  const cli::GlHandle gl(made);
  json all = json::array();
  for (const auto& file : options.containers) all.push_back(measure(options, file, gl.get()));
  if (options.json) {
    std::printf("%s\n", all.dump(2).c_str());
    return 0;
  }
  for (const json& r : all) {
    std::printf("%s: %u patches, %u links of %.2f B, a sweep %.2f ns a link on the CPU and %.2f on GL, texels %.2f and %.2f ms, injection %.2f ms, %.1f MB of textures\n",
                r["container"].get<std::string>().c_str(), r["patches"].get<uint32_t>(), r["links"].get<uint32_t>(), r["stored_bytes_per_link"].get<double>(),
                r["cpu_ns_per_link"].get<double>(), r["gl_ns_per_link"].get<double>(), r["cpu_shade_ms"].get<double>(), r["gl_shade_ms"].get<double>(),
                r["cpu_inject_128_ms"].get<double>(), r["gl_texture_bytes"].get<double>() / 1e6);
    std::printf("  injection on GL %.2f ms\n", r["gl_inject_128_ms"].get<double>());
    if (r.contains("probes")) {
      const json& p = r["probes"];
      std::printf("  %u probes, %u links, a look-up on the CPU %.2f us\n", p["probes"].get<uint32_t>(), p["links"].get<uint32_t>(), p["sample_us"].get<double>());
      for (const json& e : p["evaluate"])
        std::printf("    %u coefficients: %.2f ms (%.2f ns a link) on the CPU, %.2f ms (%.1f ns) on GL with %.1f MB\n", e["coefficients"].get<uint32_t>(), e["cpu_ms"].get<double>(),
                    e["cpu_ns_per_link"].get<double>(), e["gl_ms"].get<double>(), e["gl_ns_per_link"].get<double>(), e["gl_texture_bytes"].get<double>() / 1e6);
    }
    for (const json& s : r["solve"])
      std::printf("  albedo %.3f: %u sweeps, %.1f ms, residual %.1e, in double %.1e; plain sweeps would be %.0f\n", s["albedo"].get<double>(), s["sweeps"].get<uint32_t>(),
                  1e3 * s["seconds"].get<double>(), s["residual"].get<double>(), s["residual_in_double"].get<double>(), s["plain_sweeps"].get<double>());
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "radiosity_cost: %s\n", error.what());
  return 1;
}
