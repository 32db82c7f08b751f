// The C runtime's handles with owners, and its results as exceptions.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "lightwell/lightwell.h"
#include "precompute/scene/scene.h"

namespace lightwell::cli {

struct CloseContainer {
  void operator()(lw_container* container) const { lw_close(container); }
};
struct ReleasePrm {
  void operator()(lw_prm* prm) const { lw_prm_release(prm); }
};
struct ReleaseRadiosity {
  void operator()(lw_radiosity* radiosity) const { lw_radiosity_release(radiosity); }
};
struct DestroyRadiosityState {
  void operator()(lw_radiosity_state* state) const { lw_radiosity_state_destroy(state); }
};
struct ReleaseEnvironment {
  void operator()(lw_environment* environment) const { lw_environment_release(environment); }
};

/// A container opened by the runtime, as a game would. Failures throw: a damaged file is a format::ContainerError.
class RuntimeContainer {
 public:
  explicit RuntimeContainer(const std::filesystem::path& file);
  RuntimeContainer(const RuntimeContainer&) = delete;
  RuntimeContainer& operator=(const RuntimeContainer&) = delete;

  lw_container* get() const { return container_.get(); }
  std::unique_ptr<lw_prm, ReleasePrm> loadPrm() const;
  std::unique_ptr<lw_radiosity, ReleaseRadiosity> loadRadiosity() const;
  std::unique_ptr<lw_radiosity_state, DestroyRadiosityState> createState(const lw_radiosity* radiosity) const;
  std::unique_ptr<lw_environment, ReleaseEnvironment> loadEnvironment() const;
  /// Throws for a result that is not LW_OK, with the runtime's last message.
  void check(lw_result result) const;

 private:
  static void receive(void* self, lw_result result, const char* text);
  std::string file_, message_;
  std::unique_ptr<lw_container, CloseContainer> container_;
};

/// A scene's light as the runtime takes it: container metres, candela or lux.
lw_light runtimeLight(const scene::Scene& scene, const scene::Light& light);

}  // namespace lightwell::cli
