#include "precompute/scene/gltf/portal_marks.h"

#include <algorithm>
#include <cmath>

#include "precompute/scene/scene.h"

namespace lightwell::scene::gltf {
namespace {

constexpr uint32_t kStrips = 8;
constexpr size_t kListedCandidates = 30;

bool matches(const std::string& pattern, const std::string& name) {
  return pattern.ends_with('*') ? name.starts_with(pattern.substr(0, pattern.size() - 1)) : name == pattern;
}

Vec3d worldDirection(const JsonValue& json, const Matrix& world) {
  const auto local = json.numbers<3>();
  Vec3d direction;
  world.multDirMatrix(Vec3d(local[0], local[1], local[2]), direction);
  if (!(direction.length() > 0) || !std::isfinite(direction.length())) json.fail("has no direction");
  return direction.normalized();
}

}  // namespace

std::optional<PortalMark> PortalMarks::of(const JsonValue& node, const Matrix& world, Diagnostics& diagnostics) {
  PortalMark mark{node.stringOr("name", ""), node.path(), kStrips, {}};
  bool marked = isNamed(mark.name);
  const auto extras = node.find("extras");  // anything may stand there; only what has our name is ours
  const auto own = extras && extras->isObject() ? extras->find("lightwell") : std::nullopt;
  const auto portal = own ? own->find("portal") : std::nullopt;
  if (portal && portal->isBoolean()) {
    marked |= portal->boolean();
  } else if (portal) {
    marked = true;
    for (const std::string& key : portal->keys())
      if (key != "strips" && key != "opens_along") diagnostics.warn(portal->path() + "." + key, "is not a key of a portal and means nothing");
    if (const auto strips = portal->find("strips")) {
      const size_t count = strips->unsignedInteger();
      if (count < 1 || count > kMostPortalStrips) strips->fail("is not from 1 to " + std::to_string(kMostPortalStrips));
      mark.strips = uint32_t(count);
    }
    if (const auto direction = portal->find("opens_along")) mark.opens_along = worldDirection(*direction, world);
  }
  if (!marked) return std::nullopt;
  return mark;
}

bool PortalMarks::isNamed(const std::string& node) {
  bool named = false;
  for (const std::string& name : names_)
    if (matches(name, node)) named = true, found_.insert(name);
  return named;
}

void PortalMarks::requireAllFound(const std::string& file, const std::vector<std::string>& candidates) const {
  for (const std::string& name : names_) {
    if (found_.contains(name)) continue;
    std::string message = "--portal: no node of " + file + " is called \"" + name + "\"";
    const std::set<std::string> sorted(candidates.begin(), candidates.end());
    size_t listed = 0;
    for (const std::string& candidate : sorted) {
      if (candidate.empty()) continue;
      if (++listed > kListedCandidates) break;
      message += (listed == 1 ? "; nodes with surfaces are " : ", ") + candidate;
    }
    if (listed == 0) message += "; no node with surfaces has a name";
    if (listed > kListedCandidates) message += ", and more";
    throw UsageError(message);
  }
}

}  // namespace lightwell::scene::gltf
