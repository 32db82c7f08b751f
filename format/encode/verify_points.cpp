// The checks of section points. docs/format.md has the table that they hold.
#include <cmath>
#include <cstdlib>

#include "format/encode/verify_context.h"
#include "lightwell/v1/container.pb.h"

namespace lightwell::format {
namespace {

constexpr const char* kSection = "points";
constexpr uint32_t kMostPoints = 1u << 22, kNoTexel = 0xffffffffu;

bool isSound(const v1::PointsHeader& header) {
  if (header.first_size() != 3 || header.step_size() != 3) return false;
  for (int k = 0; k < 3; ++k)
    if (!std::isfinite(header.first(k)) || !(header.step(k) >= 0) || !std::isfinite(header.first(k) + 65535.0f * header.step(k))) return false;
  return header.points() > 0 && header.points() <= kMostPoints && header.area() > 0 && std::isfinite(header.area());
}

}  // namespace

void verifyPoints(VerifyContext& context) {
  v1::PointsHeader header;
  if (!context.loadMessage(kSection, "header", header)) return;
  if (!isSound(header)) return context.report(IssueId::header_value, kSection, "header", "a field is out of range");
  const uint64_t points = header.points();
  context.load<uint16_t>(kSection, "position", {points, 3});
  if (const auto normal = context.load<int16_t>(kSection, "normal", {points, 2}))
    context.checkEach(*normal, IssueId::reserved_bits, kSection, "normal", "are reserved", [](int16_t v) { return v == INT16_MIN; });
  const auto texel = context.load<uint32_t>(kSection, "texel", {points});
  if (!texel || !context.find("atlas", "source")) return;
  const auto source = context.load<uint32_t>("atlas", "source", {kAnyExtent, kAnyExtent});
  if (source)
    context.checkEach(*texel, IssueId::index_range, kSection, "texel", "are no texel that shows itself",
                      [&](uint32_t t) { return t != kNoTexel && (t >= source->size() || (*source)[t] != t); });
}

}  // namespace lightwell::format
