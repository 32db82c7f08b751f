// The checks of section vpl. docs/format.md has the table that they hold.
#include <cmath>
#include <string>

#include "format/encode/verify_context.h"
#include "lightwell/v1/container.pb.h"

namespace lightwell::format {

namespace {

constexpr const char* kSection = "vpl";
constexpr uint8_t kPoint = 1, kDisk = 2, kSphere = 3, kPolygon = 4;
constexpr uint32_t kFewestVertices = 3, kMostVertices = 8;
constexpr float kNormalTolerance = 1e-3f, kPlaneTolerance = 1e-3f;  // the latter of a polygon's size

struct Vector {
  double x, y, z;
};
Vector vectorAt(const std::vector<float>& values, size_t i) { return {values[i * 3], values[i * 3 + 1], values[i * 3 + 2]}; }
Vector operator-(const Vector& a, const Vector& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
double dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vector cross(const Vector& a, const Vector& b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }

/// What is wrong with the polygon of these vertices about this normal; null: nothing.
const char* wrongPolygon(const std::vector<float>& vertex, uint32_t first, uint32_t end, const Vector& normal) {
  double size = 0, twice_area = 0;
  const Vector origin = vectorAt(vertex, first);
  for (uint32_t i = first + 1; i < end; ++i) {
    const Vector side = vectorAt(vertex, i) - origin;
    size = std::max(size, std::sqrt(dot(side, side)));
    if (i + 1 < end) twice_area += dot(cross(side, vectorAt(vertex, i + 1) - origin), normal);
  }
  if (!(twice_area > 0)) return "has no area on its front";
  const uint32_t count = end - first;
  for (uint32_t i = 0; i < count; ++i) {
    const Vector a = vectorAt(vertex, first + i), b = vectorAt(vertex, first + (i + 1) % count),
                 c = vectorAt(vertex, first + (i + 2) % count);
    if (std::abs(dot(a - origin, normal)) > kPlaneTolerance * size) return "does not lie in a plane";
    if (dot(cross(b - a, c - b), normal) < -kPlaneTolerance * size * size) return "is not convex";
  }
  return nullptr;
}

}  // namespace

void verifyVpl(VerifyContext& context) {
  v1::VplHeader header;
  if (!context.loadMessage(kSection, "header", header)) return;
  if (header.lights() == 0) return context.report(IssueId::header_value, kSection, "header", "there are no lights");
  if (header.sources() == 0) return context.report(IssueId::header_value, kSection, "header", "there are no sources");
  const uint64_t lights = header.lights(), vertices = header.vertices();
  const auto type = context.load<uint8_t>(kSection, "type", {lights});
  const auto source = context.load<uint32_t>(kSection, "source", {lights});
  const auto bounce = context.load<uint8_t>(kSection, "bounce", {lights});
  const auto position = context.load<float>(kSection, "position", {lights, 3});
  const auto normal = context.load<float>(kSection, "normal", {lights, 3});
  const auto flux = context.load<float>(kSection, "flux", {lights, 3});
  const auto radius = context.load<float>(kSection, "radius", {lights});
  const auto first_vertex = context.load<uint32_t>(kSection, "first_vertex", {lights + 1});
  const auto vertex = vertices > 0 ? context.load<float>(kSection, "vertex", {vertices, 3}) : std::vector<float>();
  bool sound = type && source && bounce && position && normal && flux && radius && first_vertex && vertex;
  if (position) sound &= context.checkFinite(*position, kSection, "position");
  if (vertex) sound &= context.checkFinite(*vertex, kSection, "vertex");
  if (type)
    sound &= context.checkEach(*type, IssueId::value_range, kSection, "type", "are unknown",
                               [](uint8_t t) { return t < kPoint || t > kPolygon; });
  if (source)
    sound &= context.checkEach(*source, IssueId::index_range, kSection, "source", "are no source",
                               [&](uint32_t s) { return s >= header.sources(); });
  if (flux)
    sound &= context.checkEach(*flux, IssueId::value_range, kSection, "flux", "are negative or not finite",
                               [](float v) { return !(v >= 0) || !std::isfinite(v); });
  if (first_vertex) sound &= context.checkOffsets(*first_vertex, vertices, false, kSection, "first_vertex");
  if (!sound) return;
  for (size_t i = 0; i < lights; ++i) {
    const std::string place = "light " + std::to_string(i);
    const uint8_t t = (*type)[i];
    const Vector n = vectorAt(*normal, i);
    if (!(std::abs(dot(n, n) - 1) < double(kNormalTolerance)))
      return context.report(IssueId::value_range, kSection, "normal", place + " has no unit normal");
    const float r = (*radius)[i];
    if (t == kDisk || t == kSphere ? !(r > 0) || !std::isfinite(r) : r != 0)
      return context.report(IssueId::value_range, kSection, "radius", place + " has a radius that does not fit its type");
    const uint32_t first = (*first_vertex)[i], end = (*first_vertex)[i + 1], count = end - first;
    if (t == kPolygon ? count < kFewestVertices || count > kMostVertices : count != 0)
      return context.report(IssueId::value_range, kSection, "first_vertex", place + " has a number of vertices that does not fit its type");
    if (t == kPolygon)
      if (const char* wrong = wrongPolygon(*vertex, first, end, n))
        return context.report(IssueId::value_range, kSection, "vertex", place + " " + wrong);
    if (i > 0 && ((*source)[i] < (*source)[i - 1] || ((*source)[i] == (*source)[i - 1] && (*bounce)[i] < (*bounce)[i - 1])))
      return context.report(IssueId::order, kSection, "source", place + " is not in the order of sources and bounces");
  }
  if (!context.find("scene", "header")) return;
  v1::SceneHeader scene;
  if (context.loadMessage("scene", "header", scene) && header.sources() - uint32_t(scene.lights_size()) - 1 > 1)
    context.report(IssueId::cross_section, kSection, "header", "the sources are not the lamps of the scene and one or two more");
}

}  // namespace lightwell::format
