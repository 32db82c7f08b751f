#include "cli/environment_queries.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "precompute/scene/gltf/files.h"
#include "precompute/scene/json_value.h"

namespace lightwell::cli {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;
using transport::EnvironmentQuery;

constexpr uint64_t kMostQueryBytes = 64ull << 20;
constexpr size_t kMostQueries = 1 << 20;
constexpr double kMostShininess = 1e5;

Vec3 unitVector(const scene::JsonValue& value) {
  const auto n = value.numbers<3>();
  const Vec3d v(n[0], n[1], n[2]);
  const double length = v.length();
  if (!(length > 0) || !std::isfinite(length)) value.fail("has no direction");
  return Vec3(v / length);
}

EnvironmentQuery readQuery(const scene::JsonValue& query) {
  for (const std::string& key : query.keys())
    if (key != "normal" && key != "mirror" && key != "shininess") query.at(key).fail("is no key of a query");
  const auto normal = query.find("normal"), mirror = query.find("mirror"), shininess = query.find("shininess");
  if (normal.has_value() == mirror.has_value()) query.fail("needs either \"normal\" or \"mirror\"");
  if (normal) {
    if (shininess) shininess->fail("belongs to a mirror direction");
    return {unitVector(*normal), 1};
  }
  const auto n = query.at("shininess");
  if (!(n.number() >= 1 && n.number() <= kMostShininess)) n.fail("is not between 1 and 100000");
  return {unitVector(*mirror), float(n.number())};
}

}  // namespace

std::vector<EnvironmentQuery> readQueries(const fs::path& file) {
  const std::string name = file.string();
  const std::vector<uint8_t> bytes = scene::gltf::readFile(file, kMostQueryBytes);
  const json document = scene::parseJson(name, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  const scene::JsonValue root(name, document);
  for (const std::string& key : root.keys())
    if (key != "queries") root.at(key).fail("is no key of a list of queries");
  const scene::JsonValue list = root.at("queries");
  if (list.size() > kMostQueries) list.fail("has more than " + std::to_string(kMostQueries) + " queries");
  std::vector<EnvironmentQuery> queries;
  for (size_t i = 0; i < list.size(); ++i) queries.push_back(readQuery(list[i]));
  return queries;
}

}  // namespace lightwell::cli
