// The game in a window.
#include <epoxy/gl.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <utility>

#include "render/camera_json.h"
#include "render/lights_json.h"
#include "render/renderer.h"
#include "samples/game/lamps.h"
#include "samples/game/options.h"
#include "samples/game/player.h"
#include "samples/game/text.h"

namespace lightwell::game {
namespace {

constexpr const char* kHelp =
    "WASD walk   Space/Ctrl up, down   Shift run   mouse look (click to capture, Esc to free)\n"
    "1 direct   2 indirect   3 full   L lighting only\n"
    "Tab next lamp   G grab, let go   arrows, PgUp/PgDn move it   C colour   + - brightness   O on, off\n"
    "N new lamp   Backspace remove   X automatic exposure   , . exposure   P picture   H help   Q quit";

lw_gl_proc loadGl(void*, const char* name) { return glfwGetProcAddress(name); }

class Window {
 public:
  Window(int width, int height) {
    glfwSetErrorCallback([](int, const char* text) { std::fprintf(stderr, "GLFW: %s\n", text); });
    if (!glfwInit()) throw std::runtime_error("no window system; --headless draws without one");
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    window_ = glfwCreateWindow(width, height, "Lightwell", nullptr, nullptr);
    if (!window_) {
      glfwTerminate();
      throw std::runtime_error("no window with OpenGL 3.3; --headless draws without one");
    }
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);
  }
  ~Window() {
    glfwDestroyWindow(window_);
    glfwTerminate();
  }
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;
  operator GLFWwindow*() const { return window_; }

 private:
  GLFWwindow* window_ = nullptr;
};

class Game {
 public:
  Game(const Options& options, lw_container* container)
      : options_(options),
        window_(options.width, options.height),
        renderer_(container, loadGl, nullptr),
        player_(renderer_.sceneInfo()),
        lamps_(options.lights ? render::readLights(*options.lights, renderer_.sceneInfo().origin_m) : renderer_.lights(),
               renderer_.sceneInfo()) {
    if (options.camera) {
      view_ = render::readCamera(*options.camera);
      player_.placeAt(view_);
    }
    view_.show_lamps = true;
    if (options.part) view_.part = *options.part;
    automatic_exposure_ = !view_.exposure_ev;
    glfwSetWindowUserPointer(window_, this);
    glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int, int action, int) {
      if (action == GLFW_PRESS) static_cast<Game*>(glfwGetWindowUserPointer(window))->press(key);
    });
    glfwSetMouseButtonCallback(window_, [](GLFWwindow* window, int, int action, int) {
      if (action == GLFW_PRESS) static_cast<Game*>(glfwGetWindowUserPointer(window))->capture(true);
    });
  }

  void run() {
    double last = glfwGetTime();
    for (int frame = 0; !glfwWindowShouldClose(window_) && (options_.frames == 0 || frame < options_.frames); ++frame) {
      glfwPollEvents();
      const double now = glfwGetTime();
      const float seconds = float(std::clamp(now - last, 0.0, 0.25));
      last = now;
      frame_ms_ += (seconds * 1000 - frame_ms_) * 0.1f;
      steer(seconds);
      drawFrame(seconds, frame);
      glfwSwapBuffers(window_);
    }
  }

 private:
  bool held(int key) const { return glfwGetKey(window_, key) == GLFW_PRESS; }
  float axis(int positive, int negative) const { return float(held(positive)) - float(held(negative)); }

  void capture(bool on) {
    if (on == captured_) return;
    captured_ = on;
    glfwSetInputMode(window_, GLFW_CURSOR, on ? GLFW_CURSOR_DISABLED : GLFW_CURSOR_NORMAL);
    glfwGetCursorPos(window_, &cursor_x_, &cursor_y_);
  }

  void steer(float seconds) {
    Steering steering;
    steering.forward = axis(GLFW_KEY_W, GLFW_KEY_S);
    steering.right = axis(GLFW_KEY_D, GLFW_KEY_A);
    steering.up = axis(GLFW_KEY_SPACE, GLFW_KEY_LEFT_CONTROL);
    steering.fast = held(GLFW_KEY_LEFT_SHIFT);
    if (captured_) {
      double x, y;
      glfwGetCursorPos(window_, &x, &y);
      steering.turn_rad = float(x - cursor_x_) * 0.0025f;
      steering.tilt_rad = float(cursor_y_ - y) * 0.0025f;
      cursor_x_ = x;
      cursor_y_ = y;
    }
    player_.move(steering, seconds);
    const render::Float3 ahead = player_.forward(), right = render::normalized(render::cross(ahead, {0, 1, 0}));
    const render::Float3 along = render::cross({0, 1, 0}, right);
    const render::Float3 push = right * axis(GLFW_KEY_RIGHT, GLFW_KEY_LEFT) + along * axis(GLFW_KEY_UP, GLFW_KEY_DOWN) +
                                render::Float3{0, axis(GLFW_KEY_PAGE_UP, GLFW_KEY_PAGE_DOWN), 0};
    if (render::length(push) > 0) lamps_.moveSelected(push * (2 * seconds));
    if (carrying_) lamps_.carryTo(player_.eye_m() + ahead * 1.2f + render::Float3{0, -0.25f, 0});
    const float brighten = axis(GLFW_KEY_EQUAL, GLFW_KEY_MINUS);
    if (brighten != 0) lamps_.scaleIntensity(std::exp2(brighten * 2 * seconds));
    const float expose = axis(GLFW_KEY_PERIOD, GLFW_KEY_COMMA);
    if (expose != 0) {
      automatic_exposure_ = false;
      *view_.exposure_ev -= expose * 2 * seconds;
    }
  }

  void press(int key) {
    switch (key) {
      case GLFW_KEY_1: view_.part = render::LightPart::direct; break;
      case GLFW_KEY_2: view_.part = render::LightPart::indirect; break;
      case GLFW_KEY_3: view_.part = render::LightPart::full; break;
      case GLFW_KEY_L: view_.lighting_only = !view_.lighting_only; break;
      case GLFW_KEY_TAB: lamps_.selectNext(); break;
      case GLFW_KEY_G: carrying_ = !carrying_; break;
      case GLFW_KEY_C: lamps_.cycleColor(); break;
      case GLFW_KEY_O: lamps_.toggleSelected(); break;
      case GLFW_KEY_N: lamps_.add(player_.eye_m() + player_.forward()); break;
      case GLFW_KEY_BACKSPACE: lamps_.removeSelected(); break;
      case GLFW_KEY_X: automatic_exposure_ = true; break;
      case GLFW_KEY_H: show_help_ = !show_help_; break;
      case GLFW_KEY_P: picture_wanted_ = true; break;
      case GLFW_KEY_ESCAPE: capture(false); break;
      case GLFW_KEY_Q: glfwSetWindowShouldClose(window_, GLFW_TRUE); break;
      default: break;
    }
  }

  void drawFrame(float seconds, int frame) {
    if (lamps_.takeChanged()) renderer_.setLights(lamps_.lit());
    player_.applyTo(view_);
    glfwGetFramebufferSize(window_, &view_.width, &view_.height);
    if (view_.width == 0 || view_.height == 0) return;  // minimised
    // The eye adapts: metering now and then is enough.
    if (automatic_exposure_ && frame % 12 == 0) metered_ev_ = renderer_.meterExposure(view_);
    if (!view_.exposure_ev) view_.exposure_ev = metered_ev_;
    if (automatic_exposure_) *view_.exposure_ev += (metered_ev_ - *view_.exposure_ev) * (1 - std::exp(-3 * seconds));
    renderer_.draw(view_, 0);
    if (std::exchange(picture_wanted_, false)) {
      render::writePng(options_.output_prefix + ".png", renderer_.render(view_));
      glBindFramebuffer(GL_FRAMEBUFFER, 0);
    }
    char line[160];
    std::snprintf(line, sizeof line, "%s  %.1f ms  EV %.1f  lamp %zu of %zu%s  H help", render::partName(view_.part), double(frame_ms_),
                  double(*view_.exposure_ev), lamps_.selected() + 1, lamps_.count(), carrying_ ? " (carried)" : "");
    text_.draw(line, 12, 12, view_.width, view_.height, 2);
    if (show_help_) text_.draw(kHelp, 12, 44, view_.width, view_.height, 2);
    if (frame % 30 == 0) glfwSetWindowTitle(window_, (options_.container.filename().string() + ": " + line).c_str());
  }

  Options options_;
  Window window_;
  render::Renderer renderer_;
  Text text_;
  Player player_;
  Lamps lamps_;
  render::View view_;
  bool automatic_exposure_ = true, carrying_ = false, captured_ = false, show_help_ = true, picture_wanted_ = false;
  float metered_ev_ = 0, frame_ms_ = 16;
  double cursor_x_ = 0, cursor_y_ = 0;
};

}  // namespace

int runWindowed(const Options& options, lw_container* container) {
  Game(options, container).run();
  return 0;
}

}  // namespace lightwell::game
