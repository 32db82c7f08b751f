#include "precompute/transport/sides.h"

namespace lightwell::transport {

Sides surfaceSides(const atlas::Atlas& atlas) {
  Sides sides;
  sides.front_count = uint32_t(atlas.slots.size());
  sides.slot.resize(sides.front_count);
  sides.back_of_slot.assign(sides.front_count, kNone);
  for (uint32_t slot = 0; slot < sides.front_count; ++slot) sides.slot[slot] = slot;
  for (uint32_t slot = 0; slot < sides.front_count; ++slot)
    if (atlas.slots[slot].double_sided) {
      sides.back_of_slot[slot] = uint32_t(sides.slot.size());
      sides.slot.push_back(slot);
    }
  return sides;
}

atlas::SurfacePoint sampleSide(const scene::Mesh& mesh, const atlas::Atlas& atlas, const Sides& sides, uint32_t side, float pick, const Vec2& u) {
  atlas::SurfacePoint point = atlas::sampleSlot(mesh, atlas, atlas.slots[sides.slot[side]], pick, u);
  if (sides.isBack(side)) {
    point.normal = -point.normal;
    point.geometric_normal = -point.geometric_normal;
  }
  return point;
}

}  // namespace lightwell::transport
