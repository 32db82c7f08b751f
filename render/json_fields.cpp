#include "render/json_fields.h"

#include <algorithm>
#include <cmath>
#include <fstream>

#include "render/error.h"

namespace lightwell::render {
namespace {

using Json = nlohmann::json;
constexpr size_t kMaxFileBytes = 1 << 20;
constexpr int kMaxDepth = 8;

}  // namespace

std::string readSmallFile(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string text(kMaxFileBytes + 1, '\0');
  in.read(text.data(), std::streamsize(text.size()));
  if (in.bad() || (in.fail() && !in.eof())) throw FileError(file.string(), "", "cannot be read");
  text.resize(size_t(in.gcount()));
  if (text.size() > kMaxFileBytes) throw FileError(file.string(), "", "is larger than 1 MiB");
  return text;
}

Json parseJson(std::string_view text, const std::string& file) {
  const auto shallow = [&](int depth, Json::parse_event_t, Json&) {
    if (depth > kMaxDepth) throw FileError(file, "", "is nested too deeply");
    return true;
  };
  try {
    return Json::parse(text.begin(), text.end(), shallow);
  } catch (const Json::exception& error) {
    throw FileError(file, "", std::string("is not JSON: ") + error.what());
  }
}

JsonFields::JsonFields(const Json& json, const std::string& file, std::string place, std::initializer_list<const char*> known)
    : json_(json), file_(file), place_(std::move(place)) {
  if (!json.is_object()) throw FileError(file, place_, "must be an object");
  for (const auto& [key, value] : json.items())
    if (std::find(known.begin(), known.end(), key) == known.end()) fail(key.c_str(), "is not a known key");
}

void JsonFields::fail(const char* key, const std::string& reason) const {
  throw FileError(file_, place_ + (place_.empty() ? "" : ".") + key, reason);
}

const Json& JsonFields::at(const char* key) const {
  if (!has(key)) fail(key, "is missing");
  return json_[key];
}

double JsonFields::checked(const char* key, const Json& value, double low, double high) const {
  if (!value.is_number()) fail(key, "must be a number");
  const double number = value.get<double>();
  if (!(number >= low && number <= high)) fail(key, "must lie in [" + Json(low).dump() + ", " + Json(high).dump() + "]");
  return number;
}

double JsonFields::number(const char* key, std::optional<double> fallback, double low, double high) const {
  return fallback && !has(key) ? *fallback : checked(key, at(key), low, high);
}

int JsonFields::integer(const char* key, int fallback, int low, int high) const {
  const double value = number(key, fallback, low, high);
  if (value != std::floor(value)) fail(key, "must be a whole number");
  return int(value);
}

bool JsonFields::boolean(const char* key, bool fallback) const {
  if (!has(key)) return fallback;
  if (!at(key).is_boolean()) fail(key, "must be true or false");
  return at(key).get<bool>();
}

std::array<double, 3> JsonFields::vector(const char* key, const std::optional<std::array<double, 3>>& fallback, double low) const {
  if (fallback && !has(key)) return *fallback;
  const Json& value = at(key);
  if (!value.is_array() || value.size() != 3) fail(key, "must be an array of three numbers");
  return {checked(key, value[0], low, 1e9), checked(key, value[1], low, 1e9), checked(key, value[2], low, 1e9)};
}

Float3 JsonFields::direction(const char* key, const std::optional<std::array<double, 3>>& fallback) const {
  const auto v = vector(key, fallback);
  const double size = std::hypot(v[0], v[1], v[2]);
  if (!(size > 1e-9)) fail(key, "has no direction");
  return {float(v[0] / size), float(v[1] / size), float(v[2] / size)};
}

size_t JsonFields::choice(const char* key, const std::vector<std::string>& names, const std::optional<std::string>& fallback) const {
  if ((!fallback || has(key)) && !at(key).is_string()) fail(key, "must be a string");
  const std::string value = has(key) ? at(key).get<std::string>() : *fallback;
  const auto found = std::find(names.begin(), names.end(), value);
  if (found != names.end()) return size_t(found - names.begin());
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  fail(key, "must be one of " + all);
}

}  // namespace lightwell::render
