// What the runtime makes of a container's precomputed light, as a texture over the atlas: from precomputed radiance maps, radiosity or a baked light map.
#pragma once
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "lightwell/lightwell_gl.h"
#include "render/shadow_maps.h"
#include "render/view.h"

namespace lightwell::render {

enum class Technique {
  automatic,  // the first of these that the container has
  prm,
  radiosity,
  lightmap,
};

/// Portals of section "radiosity" and how far they are open, 0 to 1.
struct PortalState {
  std::string name;  // at its end * stands for any rest
  float open = 0;
};

class IndirectLight {
 public:
  virtual ~IndirectLight() = default;
  /// Brings the atlas up to date with the lamps, whose maps `lamps` has, and the part of the light that is asked for.
  virtual void update(LightPart part, std::span<const ShadowMap> lamps) = 0;
  virtual GLuint atlas() const = 0;
  /// The atlas has the direct light of lamps too: nothing else may draw it.
  virtual bool hasLamps() const { return false; }
};

/// What the container's portals have to do with its geometry: the leaves of its doors, opened as `portals` says. Empty without a section "radiosity". Throws
/// RenderError when a name is none of a portal of the container.
std::vector<Leaf> leavesOf(const lw_container* container, std::span<const PortalState> portals);

/// Null when the container has nothing of the kind and `technique` is automatic; else throws RenderError. `sky_is_drawn`: the sky itself lights the surfaces, and
/// the atlas must not. `message`: where `gl` leaves its last one. `container` is not used afterwards, `gl` must outlive the result.
std::unique_ptr<IndirectLight> makeIndirectLight(Technique technique, const lw_container* container, lw_gl* gl, std::span<const PortalState> portals,
                                                 bool sky_is_drawn, const std::string& message);

}  // namespace lightwell::render
