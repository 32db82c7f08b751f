// Surface points: decoding.
#include <cmath>

#include "format/decode/pixel.h"
#include "runtime/src/section_loader.h"

struct lw_points {
  lightwell::runtime::Host host;
  lightwell::format::PointsHeader header;
  lightwell::runtime::Array<float> position_m, normal;
  lightwell::runtime::Array<uint32_t> texel;
};

namespace lightwell::runtime {
namespace {

using format::ElementType;

constexpr uint32_t kMostPoints = 1u << 22;

class Loader : SectionLoader {
 public:
  Loader(const lw_container& container, lw_points& points) : SectionLoader(container, "points"), p_(points) {}

  lw_result load() {
    Array<uint8_t> message;
    if (!decode("header", ElementType::bytes, elementsOf("header"), message)) return result_;
    format::PointsHeader& h = p_.header;
    require(format::parsePointsHeader(message.data(), message.size(), h), "header", "it is not a valid message");
    bool good = h.points > 0 && h.points <= kMostPoints && h.area_m2 > 0 && std::isfinite(h.area_m2);
    for (int k = 0; k < 3; ++k) good &= h.step_m[k] >= 0 && std::isfinite(h.first_m[k]) && std::isfinite(h.first_m[k] + 65535.0f * h.step_m[k]);
    require(good, "header", "a field is out of range");
    const size_t points = h.points;
    Array<uint16_t> position;
    Array<int16_t> oct;
    if (!decode("position", ElementType::u16, points * 3, position) || !decode("normal", ElementType::i16, points * 2, oct) ||
        !decode("texel", ElementType::u32, points, p_.texel) || !allocate(p_.position_m, points * 3) || !allocate(p_.normal, points * 3))
      return result_;
    for (size_t i = 0; i < points; ++i) {
      const format::Float3 n = format::unpackOct({oct[i * 2], oct[i * 2 + 1]});
      const float values[3] = {n.x, n.y, n.z};
      for (size_t k = 0; k < 3; ++k) {
        p_.position_m[i * 3 + k] = h.first_m[k] + h.step_m[k] * float(position[i * 3 + k]);
        p_.normal[i * 3 + k] = values[k];
      }
    }
    return result_;
  }

 private:
  lw_points& p_;
};

}  // namespace
}  // namespace lightwell::runtime

using namespace lightwell::runtime;

lw_result lw_points_load(const lw_container* container, lw_points** out) {
  if (!container || !out) return LW_INVALID_ARGUMENT;
  lw_points* points = createHandle<lw_points>(container->host);
  if (!points) return container->host.fail(LW_OUT_OF_MEMORY, "no memory for the handle of the points");
  if (const lw_result result = Loader(*container, *points).load()) {
    destroyHandle(points);
    return result;
  }
  *out = points;
  return LW_OK;
}

void lw_points_release(lw_points* points) { destroyHandle(points); }

lw_result lw_points_get_info(const lw_points* points, lw_points_info* info) {
  if (!points || !info) return LW_INVALID_ARGUMENT;
  *info = {points->header.points, points->header.area_m2, points->position_m.data(), points->normal.data(), points->texel.data()};
  return LW_OK;
}
