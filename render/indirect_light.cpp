#include "render/indirect_light.h"

#include <algorithm>
#include <string_view>

#include "render/error.h"

namespace lightwell::render {
namespace {

constexpr uint32_t kInjectionSide = 128;
constexpr double kTolerance = 1e-3;
constexpr uint32_t kMostSweeps = 500;

template <auto destroy>
struct Destroy {
  template <class T>
  void operator()(T* handle) const {
    destroy(handle);
  }
};
template <class T, auto destroy>
using Handle = std::unique_ptr<T, Destroy<destroy>>;

/// Fetches the runtime's words for what went wrong.
class Checks {
 public:
  explicit Checks(const std::string& message) : message_(message) {}
  void operator()(lw_result result, const char* what) const {
    if (result != LW_OK) throw RenderError(result, std::string(what) + ": " + message_);
  }

 private:
  const std::string& message_;
};

bool isCalled(std::string_view name, std::string_view pattern) {
  return pattern.ends_with('*') ? name.starts_with(pattern.substr(0, pattern.size() - 1)) : name == pattern;
}

class PrmLight : public IndirectLight {
 public:
  PrmLight(const lw_container* container, lw_gl* gl, bool sky_is_drawn, const std::string& message) : check_(message), sky_is_drawn_(sky_is_drawn) {
    lw_prm* loaded = nullptr;
    check_(lw_prm_load(container, &loaded), "the container's transport");
    const Handle<lw_prm, lw_prm_release> prm(loaded);
    lw_gl_prm* made = nullptr;
    check_(lw_gl_prm_create(gl, prm.get(), nullptr, &made), "OpenGL evaluation");
    transport_.reset(made);
  }

  void update(LightPart part, std::span<const ShadowMap> lamps) override {
    std::vector<lw_gl_light> lights;
    if (part != LightPart::direct)
      for (const ShadowMap& map : lamps) lights.push_back(map.light);
    check_(lw_gl_update_entries(transport_.get(), lights.data(), uint32_t(lights.size())), "light at the entry points");
    lw_prm_options options = LW_PRM_OPTIONS_INIT;
    const uint32_t direct = LW_EMITTERS_DIRECT | (sky_is_drawn_ ? 0u : uint32_t(LW_SKY_DIRECT)), indirect = LW_EMITTERS_INDIRECT | LW_SKY_INDIRECT;
    options.emitters = part == LightPart::direct ? direct : part == LightPart::indirect ? indirect : direct | indirect;
    check_(lw_gl_evaluate(transport_.get(), &options), "indirect light");
  }
  GLuint atlas() const override { return lw_gl_prm_atlas_texture(transport_.get()); }

 private:
  Checks check_;
  bool sky_is_drawn_;
  Handle<lw_gl_prm, lw_gl_prm_destroy> transport_;
};

class RadiosityLight : public IndirectLight {
 public:
  RadiosityLight(const lw_container* container, lw_gl* gl, std::span<const PortalState> portals, const std::string& message) : check_(message) {
    lw_radiosity* loaded = nullptr;
    check_(lw_radiosity_load(container, &loaded), "the container's form factors");
    const Handle<lw_radiosity, lw_radiosity_release> radiosity(loaded);
    lw_radiosity_state* made_state = nullptr;
    check_(lw_radiosity_state_create(radiosity.get(), &made_state), "radiosity");
    const Handle<lw_radiosity_state, lw_radiosity_state_destroy> state(made_state);
    lw_radiosity_portal portal;
    for (uint32_t i = 0; lw_radiosity_get_portal(radiosity.get(), i, &portal) == LW_OK; ++i)
      for (const PortalState& p : portals)
        if (isCalled(portal.name, p.name)) check_(lw_radiosity_set_portal(state.get(), i, p.open), "a portal");
    lw_gl_radiosity* made = nullptr;
    check_(lw_gl_radiosity_create(gl, radiosity.get(), nullptr, &made), "OpenGL evaluation");
    radiosity_.reset(made);
    check_(lw_gl_radiosity_upload(made, state.get(), LW_GL_RADIOSITY_PORTALS), "portals");
    lw_gl_radiosity_injector* made_injector = nullptr;
    check_(lw_gl_radiosity_injector_create(made, container, radiosity.get(), kInjectionSide, &made_injector), "light injection");
    injector_.reset(made_injector);
  }

  void update(LightPart part, std::span<const ShadowMap> lamps) override {
    std::vector<lw_light> lights;
    for (const ShadowMap& map : lamps) lights.push_back(map.light.light);
    check_(lw_gl_radiosity_inject(injector_.get(), lights.data(), uint32_t(lights.size())), "light on the patches");
    check_(lw_gl_radiosity_solve(radiosity_.get(), kTolerance, kMostSweeps, nullptr), "radiosity");
    lw_radiosity_shading shading = LW_RADIOSITY_SHADING_INIT;
    shading.light = 0;
    if (part != LightPart::direct) shading.light |= LW_RADIOSITY_INDIRECT;
    if (part != LightPart::indirect) shading.light |= LW_RADIOSITY_EMITTERS;
    check_(lw_gl_radiosity_shade(radiosity_.get(), &shading), "radiosity");
  }
  GLuint atlas() const override { return lw_gl_radiosity_atlas_texture(radiosity_.get()); }

 private:
  Checks check_;
  Handle<lw_gl_radiosity, lw_gl_radiosity_destroy> radiosity_;
  Handle<lw_gl_radiosity_injector, lw_gl_radiosity_injector_destroy> injector_;
};

class BakedLight : public IndirectLight {
 public:
  BakedLight(const lw_container* container, lw_gl* gl, const std::string& message) : check_(message), gl_(gl) {
    lw_lightmap* loaded = nullptr;
    check_(lw_lightmap_load(container, &loaded), "the container's light map");
    lightmap_.reset(loaded);
  }

  void update(LightPart part, std::span<const ShadowMap>) override {
    lw_lightmap_shading shading = LW_LIGHTMAP_SHADING_INIT;
    shading.light = 0;
    if (part != LightPart::direct) shading.light |= LW_LIGHTMAP_INDIRECT;
    if (part != LightPart::indirect) shading.light |= LW_LIGHTMAP_DIRECT;
    lw_gl_lightmap_options options = LW_GL_LIGHTMAP_OPTIONS_INIT;
    options.shading = &shading;
    lw_gl_lightmap* made = nullptr;
    check_(lw_gl_lightmap_create(gl_, lightmap_.get(), &options, &made), "the light map");
    texture_.reset(made);
  }
  GLuint atlas() const override { return lw_gl_lightmap_texture(texture_.get()); }
  bool hasLamps() const override { return true; }

 private:
  Checks check_;
  lw_gl* gl_;
  Handle<lw_lightmap, lw_lightmap_release> lightmap_;
  Handle<lw_gl_lightmap, lw_gl_lightmap_destroy> texture_;
};

}  // namespace

std::vector<Leaf> leavesOf(const lw_container* container, std::span<const PortalState> portals) {
  std::vector<Leaf> leaves;
  std::vector<bool> known(portals.size(), false);
  if (!portals.empty() && lw_has_section(container, "radiosity")) {
    lw_radiosity* loaded = nullptr;
    check(lw_radiosity_load(container, &loaded), "the container's form factors");
    const Handle<lw_radiosity, lw_radiosity_release> radiosity(loaded);
    lw_radiosity_portal portal;
    for (uint32_t i = 0; lw_radiosity_get_portal(radiosity.get(), i, &portal) == LW_OK; ++i)
      for (size_t p = 0; p < portals.size(); ++p) {
        if (!isCalled(portal.name, portals[p].name)) continue;
        known[p] = true;
        if (portal.triangles == 0 || portals[p].open <= 0) continue;
        Leaf& leaf = leaves.emplace_back();
        leaf.first_triangle = portal.first_triangle;
        leaf.triangle_count = portal.triangles;
        std::copy(portal.axis_per_m, portal.axis_per_m + 3, leaf.axis_per_m);
        leaf.offset = portal.offset;
        leaf.open = portals[p].open;
      }
  }
  for (size_t p = 0; p < portals.size(); ++p)
    if (!known[p]) throw RenderError(LW_NOT_FOUND, "there is no portal \"" + portals[p].name + "\"");
  return leaves;
}

std::unique_ptr<IndirectLight> makeIndirectLight(Technique technique, const lw_container* container, lw_gl* gl, std::span<const PortalState> portals,
                                                 bool sky_is_drawn, const std::string& message) {
  const auto wanted = [&](Technique t, const char* section) {
    return technique == t || (technique == Technique::automatic && lw_has_section(container, section));
  };
  // Doors that stand open are known to radiosity alone.
  if (technique == Technique::automatic && !portals.empty()) technique = Technique::radiosity;
  if (wanted(Technique::prm, "prm")) return std::make_unique<PrmLight>(container, gl, sky_is_drawn, message);
  if (wanted(Technique::radiosity, "radiosity")) return std::make_unique<RadiosityLight>(container, gl, portals, message);
  if (wanted(Technique::lightmap, "lightmap")) return std::make_unique<BakedLight>(container, gl, message);
  return nullptr;
}

}  // namespace lightwell::render
