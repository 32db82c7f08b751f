#include "cli/runtime_handles.h"

#include <stdexcept>

#include "format/encode/reader.h"
#include "precompute/core/error.h"

namespace lightwell::cli {

RuntimeContainer::RuntimeContainer(const std::filesystem::path& file) : file_(file.string()) {
  lw_config config = LW_CONFIG_INIT;
  config.message = receive;
  config.message_user = this;
  lw_container* container = nullptr;
  check(lw_open_file(file.c_str(), &config, &container));
  container_.reset(container);
}

void RuntimeContainer::receive(void* self, lw_result, const char* text) { static_cast<RuntimeContainer*>(self)->message_ = text; }

void RuntimeContainer::check(lw_result result) const {
  if (result == LW_OK) return;
  const std::string why = message_.empty() ? lw_result_name(result) : message_;
  if (result == LW_OUT_OF_MEMORY) throw std::bad_alloc();
  if (result < LW_NOT_FOUND) throw format::ContainerError(file_, format::makeFault(format::Status(result), 0, "%s", why.c_str()));
  throw std::runtime_error(file_ + ": " + lw_result_name(result) + ": " + why);
}

std::unique_ptr<lw_prm, ReleasePrm> RuntimeContainer::loadPrm() const {
  lw_prm* prm = nullptr;
  check(lw_prm_load(container_.get(), &prm));
  return std::unique_ptr<lw_prm, ReleasePrm>(prm);
}

std::unique_ptr<lw_radiosity, ReleaseRadiosity> RuntimeContainer::loadRadiosity() const {
  lw_radiosity* radiosity = nullptr;
  check(lw_radiosity_load(container_.get(), &radiosity));
  return std::unique_ptr<lw_radiosity, ReleaseRadiosity>(radiosity);
}

std::unique_ptr<lw_radiosity_state, DestroyRadiosityState> RuntimeContainer::createState(const lw_radiosity* radiosity) const {
  lw_radiosity_state* state = nullptr;
  check(lw_radiosity_state_create(radiosity, &state));
  return std::unique_ptr<lw_radiosity_state, DestroyRadiosityState>(state);
}

std::unique_ptr<lw_environment, ReleaseEnvironment> RuntimeContainer::loadEnvironment() const {
  lw_environment* environment = nullptr;
  check(lw_environment_load(container_.get(), &environment));
  return std::unique_ptr<lw_environment, ReleaseEnvironment>(environment);
}

lw_light runtimeLight(const scene::Scene& scene, const scene::Light& light) {
  const double metres = scene.metres_per_unit;
  const bool directional = light.type == scene::LightType::directional;
  lw_light out{};
  out.type = directional ? LW_LIGHT_DIRECTIONAL : light.type == scene::LightType::spot ? LW_LIGHT_SPOT : LW_LIGHT_POINT;
  for (int i = 0; i < 3; ++i) {
    out.position_m[i] = directional ? 0.0f : float(light.position[i] * metres);
    out.direction[i] = light.direction[i];
    out.intensity_rgb[i] = float(light.intensity[i] * (directional ? 1.0 : metres * metres));
  }
  out.inner_cone_angle_rad = light.inner_cone_angle;
  out.outer_cone_angle_rad = light.outer_cone_angle;
  out.range_m = directional ? 0.0f : float(light.range * metres);
  return out;
}

}  // namespace lightwell::cli
