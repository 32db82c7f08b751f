// What indirect light costs a frame on OpenGL and on the CPU, by layout and by the number of panes, beside the paper's way in the same run.
//   gl_frame A.lwc [B.lwc …] [--repeats 15] [--json]
// slow_frame: the lamp moves by a thousandth of the scene from frame to frame; else it jumps to another place. Shadow maps are real, and not timed.
// Wall clock until glFinish returns, medians; ratios are medians of those of frames drawn in turn. No window.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/gl_handles.h"
#include "cli/runtime_handles.h"
#include "format/encode/reader.h"
#include "lightwell/lightwell_prm_state.h"
#include "render/egl_context.h"
#include "render/gl_objects.h"
#include "render/shadow_maps.h"

using namespace lightwell;
using nlohmann::json;

namespace {

constexpr int kPaperPanes = 32;

struct Options {
  std::vector<std::filesystem::path> containers;
  std::vector<uint32_t> brightest{8, 32, 64, 0};
  int repeats = 15;
  bool json = false;
};

struct Frame {
  std::function<void()> timed;
  std::function<void()> before = [] {};
};

/// Milliseconds of each of `frames` in each repetition. They take turns, so that what else the machine does hits all alike.
std::vector<std::vector<double>> timeInTurn(int repeats, const std::vector<Frame>& frames) {
  std::vector<std::vector<double>> milliseconds(frames.size());
  for (int i = -2; i < repeats; ++i)
    for (size_t f = 0; f < frames.size(); ++f) {
      frames[f].before();
      const auto begin = std::chrono::steady_clock::now();
      frames[f].timed();
      const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
      if (i >= 0) milliseconds[f].push_back(took.count());  // the first two rounds compile shaders and touch memory
    }
  return milliseconds;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
  return values[values.size() / 2];
}

double medianRatio(const std::vector<double>& above, const std::vector<double>& below) {
  std::vector<double> ratios;
  for (size_t i = 0; i < above.size(); ++i) ratios.push_back(above[i] / below[i]);
  return median(ratios);
}

/// The paper's pass: an atlas of RGB9E5 panes, one layer each, summed with one weight per pane.
class PaperPass {
 public:
  PaperPass(int width, int height)
      : width_(width),
        height_(height),
        panes_(render::Texture::make()),
        framebuffer_(render::Framebuffer::make()),
        vertices_(render::VertexArray::make()),
        target_(render::makeTexture2D(GL_RGBA16F, width, height, GL_RGBA, GL_FLOAT, nullptr, GL_LINEAR)),
        program_("void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }",
                 R"(uniform highp sampler2DArray u_panes;
uniform vec3 u_weight[32];
out vec4 o_irradiance;
void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  vec3 sum = vec3(0.0);
  for (int i = 0; i < 32; ++i) sum += u_weight[i] * texelFetch(u_panes, ivec3(texel, i), 0).rgb;
  o_irradiance = vec4(sum, 1.0);
})") {
    render::bindTexture(0, GL_TEXTURE_2D_ARRAY, panes_);
    std::vector<uint32_t> texels(size_t(width) * height * kPaperPanes);
    for (size_t i = 0; i < texels.size(); ++i) texels[i] = 0x80000000u | (uint32_t(i * 2654435761u) >> 5);  // exponent 16, mixed mantissas
    glTexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_RGB9_E5, width, height, kPaperPanes, 0, GL_RGB, GL_UNSIGNED_INT_5_9_9_9_REV, texels.data());
    glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, target_, 0);
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
      throw std::runtime_error("the framebuffer of the paper's pass is incomplete");
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
  }
  void draw() const {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glViewport(0, 0, width_, height_);
    glBindVertexArray(vertices_);
    program_.use();
    render::bindTexture(0, GL_TEXTURE_2D_ARRAY, panes_);
    program_.set("u_panes", 0);
    for (int i = 0; i < kPaperPanes; ++i)
      program_.set(("u_weight[" + std::to_string(i) + "]").c_str(), render::Float3{1.0f / float(i + 1), 0.5f, 0.25f});
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
  }
  uint64_t textureBytes() const { return uint64_t(width_) * height_ * (4 * kPaperPanes + 8); }

 private:
  int width_, height_;
  render::Texture panes_;
  render::Framebuffer framebuffer_;
  render::VertexArray vertices_;
  render::Texture target_;
  render::Program program_;
};

/// Mean bytes that the last pass reads per covered texel: for panes and bases from the layout, the place of the texel (8) included.
double bytesPerTexel(const format::Reader& reader, const lw_prm_info& info, uint32_t brightest) {
  const double place = 8, emitters = info.has_emitter ? 4 : 0;
  if (info.layout == LW_PRM_PANES) {
    const double panes = brightest && brightest < info.clusters ? brightest : info.clusters;
    return place + emitters + 4 * panes;
  }
  const auto first_texel = reader.read<uint32_t>("prm", "block_first_texel");
  const auto rank = reader.read<uint8_t>("prm", "block_rank");
  double bytes = 0;
  for (size_t b = 0; b < rank.size(); ++b) bytes += double(first_texel[b + 1] - first_texel[b]) * (4 * ((rank[b] + 3) / 4));
  return place + emitters + bytes / double(info.texels);
}

/// Mean bytes per covered texel that the passes before it read and all texels of a block or of the atlas share.
double sharedBytesPerTexel(const format::Reader& reader, const lw_prm_info& info) {
  double bytes = 0;
  if (info.layout == LW_PRM_LOCAL_BASES)
    for (const char* chunk : {"link_wavelet", "coefficient"}) bytes += double(reader.chunk("prm", chunk).raw_bytes);
  return bytes / double(info.texels);
}

/// A lamp over the floor, a share of the way through the entry points that look up, moved by a share of the scene's size.
lw_light lampOf(const cli::RuntimeContainer& container, const lw_prm* prm, float through, float moved) {
  lw_scene_info scene;
  lw_prm_info info;
  lw_prm_entries entries;
  container.check(lw_get_scene_info(container.get(), &scene));
  container.check(lw_prm_get_info(prm, &info));
  container.check(lw_prm_get_entries(prm, &entries));
  std::vector<const float*> floor;
  for (uint32_t e = 0; e < info.entries; ++e)
    if (entries.normal[e * 3 + 1] > 0.9f) floor.push_back(entries.position_m + e * 3);
  if (floor.empty()) floor.push_back(entries.position_m);
  const float* below = floor[size_t(through * float(floor.size() - 1))];
  const float height = scene.bounds_max_m[1] - scene.bounds_min_m[1], width = scene.bounds_max_m[0] - scene.bounds_min_m[0];
  lw_light light{};
  light.type = LW_LIGHT_POINT;
  for (int i = 0; i < 3; ++i) light.position_m[i] = below[i], light.intensity_rgb[i] = 1;
  light.position_m[0] += moved * width;
  light.position_m[1] += std::min(1.5f, 0.4f * height);
  light.direction[1] = -1;
  light.outer_cone_angle_rad = 0.7853982f;
  return light;
}

void measure(const Options& options, const std::filesystem::path& file, uint32_t reconstruct, lw_gl* gl, json& rows) {
  const cli::RuntimeContainer container(file);
  const format::Reader reader(file);
  const auto prm = container.loadPrm();
  lw_prm_info info;
  container.check(lw_prm_get_info(prm.get(), &info));
  const bool panes = info.layout == LW_PRM_PANES;
  if (panes && reconstruct) return;
  lw_gl_prm_options gl_options = LW_GL_PRM_OPTIONS_INIT;
  gl_options.reconstruct = reconstruct;
  lw_gl_prm* raw = nullptr;
  container.check(lw_gl_prm_create(gl, prm.get(), &gl_options, &raw));
  const cli::GlPrmHandle gl_prm(raw);
  // Two lamps in turn, so that no frame finds what it needs already summed: far from each other, or as one that moves slowly. Their shadow maps are made
  // beforehand: direct light needs them, too.
  const render::SceneMesh mesh(container.get());
  render::ShadowMaps shadows(mesh);
  shadows.update(std::vector<lw_light>{lampOf(container, prm.get(), 0.3f, 0), lampOf(container, prm.get(), 0.7f, 0), lampOf(container, prm.get(), 0.3f, 0),
                                       lampOf(container, prm.get(), 0.3f, 0.001f)});
  const lw_gl_light light[2][2] = {{shadows.maps()[0].light, shadows.maps()[1].light}, {shadows.maps()[2].light, shadows.maps()[3].light}};
  int turn = 0;
  const auto relight = [&](int pair) {
    container.check(lw_gl_update_entries(gl_prm.get(), &light[pair][turn ^= 1], 1));
  };
  const PaperPass paper(int(info.width), int(info.height));
  std::vector<float> entry_rgb(size_t(info.entries) * 3), cluster_rgb(size_t(info.clusters) * 3),
      atlas_rgba(size_t(info.width) * info.height * 4);
  std::vector<float> scratch(lw_prm_scratch_bytes(prm.get()) / sizeof(float) + 1);

  // The lamp that creeps, on the CPU: what has not changed stays.
  lw_prm_state* raw_state = nullptr;
  container.check(lw_prm_state_create(prm.get(), &raw_state));
  const std::unique_ptr<lw_prm_state, decltype(&lw_prm_state_release)> state(raw_state, lw_prm_state_release);
  std::vector<float> creeping_cluster_rgb[2] = {cluster_rgb, cluster_rgb}, kept_rgba(atlas_rgba.size());
  for (int i : {0, 1}) {
    container.check(lw_prm_entry_irradiance(prm.get(), &light[1][i].light, 1, nullptr, nullptr, entry_rgb.data()));
    container.check(lw_prm_cluster_irradiance(prm.get(), entry_rgb.data(), creeping_cluster_rgb[i].data()));
  }
  const auto entries =
      timeInTurn(options.repeats, {{[&] { relight(0), glFinish(); }}, {[&] {
                                     const lw_light& lamp = light[0][turn ^= 1].light;
                                     container.check(lw_prm_entry_irradiance(prm.get(), &lamp, 1, nullptr, nullptr, entry_rgb.data()));
                                     container.check(lw_prm_cluster_irradiance(prm.get(), entry_rgb.data(), cluster_rgb.data()));
                                   }}});
  for (const uint32_t brightest : panes ? options.brightest : std::vector<uint32_t>{0}) {
    if (brightest >= info.clusters) continue;
    lw_prm_options prm_options = LW_PRM_OPTIONS_INIT;
    prm_options.brightest = brightest;
    const auto drawn = [&] { container.check(lw_gl_evaluate(gl_prm.get(), &prm_options)), glFinish(); };
    const auto summed = [&] {
      if (!panes) container.check(lw_gl_update_coefficients(gl_prm.get()));
      glFinish();
    };
    // What is timed shows the other lamp of the pair than what came before it.
    const auto frame = [&](int pair) { relight(pair), drawn(); };
    const auto evaluate = timeInTurn(
        options.repeats, {{drawn, [&] { frame(0), relight(0), glFinish(); }},
                          {[&] { paper.draw(), glFinish(); }},
                          {[&] {
                            container.check(lw_prm_evaluate(prm.get(), cluster_rgb.data(), &prm_options, scratch.data(), scratch.size() * sizeof(float),
                                                            atlas_rgba.data()));
                          }},
                          {summed, [&] { relight(0), summed(), relight(0), glFinish(); }},
                          {[&] { frame(0); }, [&] { frame(0); }},
                          {[&] { frame(1); }, [&] { frame(1); }},
                          {[&] {
                             container.check(lw_prm_state_update(state.get(), creeping_cluster_rgb[turn].data(), &prm_options, kept_rgba.data(), nullptr));
                           },
                           [&] { turn ^= 1; }}});
    const std::string what =
        panes ? (brightest ? "brightest " + std::to_string(brightest) + " of " : "all ") + std::to_string(info.clusters) + " panes"
              : reconstruct ? "local bases, by shader" : "local bases";
    rows.push_back({{"container", file.filename().string()},
                    {"atlas", info.width},
                    {"texels", info.texels},
                    {"what", what},
                    {"entries_gl_ms", median(entries[0])},
                    {"evaluate_gl_ms", median(evaluate[0])},
                    {"coefficients_gl_ms", panes ? 0.0 : median(evaluate[3])},
                    {"paper_32_panes_gl_ms", median(evaluate[1])},
                    {"ratio_to_paper", medianRatio(evaluate[0], evaluate[1])},
                    {"frame_gl_ms", median(evaluate[4])},
                    {"frame_ratio_to_paper", medianRatio(evaluate[4], evaluate[1])},
                    {"slow_frame_gl_ms", median(evaluate[5])},
                    {"slow_frame_ratio_to_paper", medianRatio(evaluate[5], evaluate[1])},
                    {"entries_cpu_ms", median(entries[1])},
                    {"evaluate_cpu_ms", median(evaluate[2])},
                    {"slow_update_cpu_ms", median(evaluate[6])},
                    {"slow_update_ratio_to_evaluate_cpu", medianRatio(evaluate[6], evaluate[2])},
                    {"bytes_per_texel", bytesPerTexel(reader, info, brightest)},
                    {"shared_bytes_per_texel", sharedBytesPerTexel(reader, info)},
                    {"texture_bytes", lw_gl_prm_texture_bytes(gl_prm.get())},
                    {"paper_texture_bytes", paper.textureBytes()}});
    std::fprintf(stderr, "%s: %s\n", file.filename().c_str(), what.c_str());
  }
}

void run(const Options& options) {
  const render::EglContext context;
  lw_gl_config config = LW_GL_CONFIG_INIT;
  config.loader = render::EglContext::load;
  lw_gl* raw = nullptr;
  if (const lw_result result = lw_gl_create(&config, &raw))
    throw std::runtime_error(std::string("lw_gl_create: ") + lw_result_name(result));
  const cli::GlHandle gl(raw);
  std::fprintf(stderr, "%s\n", context.description().c_str());
  json rows = json::array();
  for (const auto& file : options.containers)
    for (const uint32_t reconstruct : {LW_GL_RECONSTRUCT_AUTO, LW_GL_RECONSTRUCT_SHADER}) measure(options, file, reconstruct, gl.get(), rows);
  if (options.json) {
    std::printf("%s\n", json{{"renderer", context.description()}, {"rows", rows}}.dump(1).c_str());
    return;
  }
  constexpr const char* kColumns[] = {"entries_gl_ms",          "evaluate_gl_ms", "coefficients_gl_ms", "paper_32_panes_gl_ms",
                                      "ratio_to_paper",         "frame_gl_ms",    "frame_ratio_to_paper", "slow_frame_gl_ms",   "slow_frame_ratio_to_paper",
                                      "entries_cpu_ms",         "evaluate_cpu_ms", "slow_update_cpu_ms", "slow_update_ratio_to_evaluate_cpu", "bytes_per_texel",
                                      "shared_bytes_per_texel", "texture_bytes",  "paper_texture_bytes"};
  std::printf("container,what,atlas,texels");
  for (const char* column : kColumns) std::printf(",%s", column);
  for (const auto& row : rows) {
    std::printf("\n\"%s\",\"%s\",%u,%u", row["container"].get_ref<const std::string&>().c_str(),
                row["what"].get_ref<const std::string&>().c_str(), row["atlas"].get<uint32_t>(), row["texels"].get<uint32_t>());
    for (const char* column : kColumns)
      if (row[column].is_number_float())
        std::printf(",%.3f", row[column].get<double>());
      else
        std::printf(",%llu", static_cast<unsigned long long>(row[column].get<uint64_t>()));
  }
  std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Milliseconds per frame of indirect light: CSV or JSON on stdout.", "gl_frame");
  app.add_option("container", options.containers, "Containers to time")->required();
  app.add_option("--brightest", options.brightest, "Panes: numbers of clusters to sum, 0 for all; may be given several times")
      ->capture_default_str();
  app.add_option("--repeats", options.repeats, "Frames; the median is reported")->check(CLI::Range(9, 10000))->capture_default_str();
  app.add_flag("--json", options.json, "JSON instead of CSV");
  CLI11_PARSE(app, argc, argv);
  try {
    run(options);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "gl_frame: %s\n", error.what());
    return 1;
  }
}
