// lightwell_moving_lamp CONTAINER.lwc --camera CAM.json --lights LIGHTS.json --move DX DY DZ -o STRIP.png
//
// The shortest use of lightwell_dynamic in a picture of one's own: the first lamp moves, every pixel sums the virtual lights of its first reflection (lwLampIrradiance), and the frames
// become a strip. Only reflected light is shown, so that what virtual lights do wrong can be seen.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <memory>

#include "lightwell/lightwell_gl_dynamic.h"
#include "render/camera_json.h"
#include "render/container_file.h"
#include "render/egl_context.h"
#include "render/gl_objects.h"
#include "render/lights_json.h"
#include "render/scene_mesh.h"
#include "render/shaders.h"
#include "samples/common/contact_sheet.h"

namespace {

using namespace lightwell;
using render::Image8;
using render::operator*;

constexpr const char* kFragment = R"(
uniform sampler2D albedo_atlas;
uniform float exposure;
out vec4 color;
void main() {
  vec3 normal = normalize(gl_FrontFacing ? v_normal : -v_normal);
  vec3 radiance = texture(albedo_atlas, v_lightmap_uv).rgb * lwLampIrradiance(v_position, normal, 0, 1) * 0.31830988618;
  vec3 shown = radiance * exposure / (1.0 + radiance * exposure);
  color = vec4(mix(12.92 * shown, 1.055 * pow(max(shown, vec3(1e-6)), vec3(1.0 / 2.4)) - 0.055, step(vec3(0.0031308), shown)), surfaceAlpha());
}
)";

struct Destroy {
  void operator()(lw_gl_dynamic* scene) const { lw_gl_dynamic_destroy(scene); }
  void operator()(lw_gl_lamp* lamp) const { lw_gl_lamp_destroy(lamp); }
};

struct Options {
  std::string container, camera, lights, output;
  std::vector<float> move_m{1, 0, 0};
  int frames = 8, frames_between = 4;
  uint32_t virtual_lights = 256, shadow_side = 32;
  bool by_flux = false;
  float exposure = 1;
};

/// Throws with the library's message.
void check(lw_result result, const std::string& message) {
  if (result) throw std::runtime_error(message.empty() ? lw_result_name(result) : message);
}

Image8 draw(const render::SceneMesh& mesh, const render::Program& program, const lw_gl_lamp* lamp, const render::View& view, float exposure) {
  lw_gl_lamp_lookup_values lookup;
  check(lw_gl_lamp_lookup(lamp, nullptr, &lookup), "");
  const render::Texture color = render::makeTexture2D(GL_RGBA8, view.width, view.height, GL_RGBA, GL_UNSIGNED_BYTE, nullptr, GL_NEAREST);
  const auto depth = render::Renderbuffer::make();
  const auto framebuffer = render::Framebuffer::make();
  glBindRenderbuffer(GL_RENDERBUFFER, depth);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, view.width, view.height);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, color, 0);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth);
  glViewport(0, 0, view.width, view.height);
  glClearColor(0, 0, 0, 1);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  render::Float3 eye;
  for (size_t k = 0; k < 3; ++k) eye[k] = float(view.eye_m[k] - mesh.info().origin_m[k]);
  const float slope = std::tan(0.5f * view.vertical_fov_rad), far = 1.01f * mesh.farthest_m(eye);
  program.use();
  program.set("view_projection", render::perspective(slope * float(view.width) / float(view.height), slope, 1e-3f * far, far) * render::lookAlong(eye, view.forward, view.up));
  program.set("exposure", exposure);
  program.set("albedo_atlas", 0);
  program.set("lw_lamp_place", 1), program.set("lw_lamp_flux", 2), program.set("lw_lamp_shadow", 3);
  glUniform4fv(glGetUniformLocation(program.name(), "lw_lamp_numbers"), 2, lookup.numbers);
  render::bindTexture(0, GL_TEXTURE_2D, mesh.albedoAtlas());
  render::bindTexture(1, GL_TEXTURE_2D, lookup.place_texture);
  render::bindTexture(2, GL_TEXTURE_2D, lookup.flux_texture);
  render::bindTexture(3, GL_TEXTURE_2D, lookup.shadow_texture);
  mesh.draw(render::SceneMesh::Kind::solid, program, 4, true);
  Image8 image{view.width, view.height, std::vector<uint8_t>(size_t(view.width) * size_t(view.height) * 4)};
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, view.width, view.height, GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
  const auto row = std::ptrdiff_t(view.width) * 4;
  for (int y = 0; y < view.height / 2; ++y)
    std::swap_ranges(image.rgba.begin() + y * row, image.rgba.begin() + (y + 1) * row, image.rgba.begin() + (view.height - 1 - y) * row);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  return image;
}

void play(const Options& o) {
  const render::ContainerFile container = render::openContainer(o.container);
  const render::EglContext context;
  const render::SceneMesh mesh(container.get());
  const render::View view = render::readCamera(o.camera);
  const auto lights = render::readLights(o.lights, mesh.info().origin_m);
  if (lights.empty()) throw std::runtime_error(o.lights + ": there is no lamp in it");
  std::string message;
  lw_gl_config config = LW_GL_CONFIG_INIT;
  config.loader = render::EglContext::load;
  config.message = [](void* user, lw_result, const char* text) { *static_cast<std::string*>(user) = text; };
  config.message_user = &message;
  lw_gl_dynamic* raw_scene = nullptr;
  check(lw_gl_dynamic_create(&config, container.get(), nullptr, &raw_scene), message);
  const std::unique_ptr<lw_gl_dynamic, Destroy> scene(raw_scene);
  lw_gl_lamp_options options = LW_GL_LAMP_OPTIONS_INIT;
  options.lights = o.virtual_lights, options.shadow_side = o.shadow_side, options.incremental = !o.by_flux;
  lw_gl_lamp* raw_lamp = nullptr;
  check(lw_gl_lamp_create(scene.get(), &options, &raw_lamp), message);
  const std::unique_ptr<lw_gl_lamp, Destroy> lamp(raw_lamp);
  const render::Program program(render::kSceneVertexGlsl, std::string(render::kAlphaGlsl) + lw_glsl_lamp() + kFragment);
  std::vector<Image8> strip;
  const int last = (o.frames - 1) * o.frames_between;
  for (int frame = 0; frame <= last; ++frame) {
    lw_light light = lights[0];
    for (int k = 0; k < 3; ++k) light.position_m[k] += o.move_m[size_t(k)] * float(frame) / float(std::max(last, 1));
    lw_gl_lamp_work work;
    check(lw_gl_lamp_update(lamp.get(), &light, &work), message);
    if (frame % o.frames_between) continue;
    std::printf("frame %d: %u lights, %u placed anew, %u draws, %llu points\n", frame, work.lights, work.updated, work.draws, static_cast<unsigned long long>(work.points));
    strip.push_back(draw(mesh, program, lamp.get(), view, o.exposure));
  }
  render::writePng(o.output, samples::contactSheet(strip, std::min(o.frames, 4)));
}

}  // namespace

int main(int argc, char** argv) {
  Options o;
  CLI::App app{"Draws the first reflection of a lamp that moves, as a strip of frames."};
  app.add_option("container", o.container, "what `lightwell bake --points N` made (.lwc)")->required();
  app.add_option("--camera", o.camera, "CAM.json")->required();
  app.add_option("--lights", o.lights, "LIGHTS.json; its first lamp moves")->required();
  app.add_option("--move", o.move_m, "metres that it moves from the first frame to the last")->expected(3);
  app.add_option("--frames", o.frames, "frames that are shown")->check(CLI::Range(1, 64))->capture_default_str();
  app.add_option("--frames-between", o.frames_between, "frames from one shown to the next")->check(CLI::Range(1, 64))->capture_default_str();
  app.add_option("--virtual-lights", o.virtual_lights, "virtual lights")->check(CLI::Range(16, 1024))->capture_default_str();
  app.add_option("--shadow-side", o.shadow_side, "texels along a virtual light's shadow map; 0: none")->capture_default_str();
  app.add_flag("--by-flux", o.by_flux, "find the virtual lights anew in each frame, by flux");
  app.add_option("--exposure", o.exposure, "factor on radiance")->capture_default_str();
  app.add_option("-o,--output", o.output, "PNG to write")->required();
  CLI11_PARSE(app, argc, argv);
  try {
    play(o);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "lightwell_moving_lamp: %s\n", error.what());
    return 1;
  }
}
