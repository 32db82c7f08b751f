#include "precompute/scene/json_value.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "precompute/core/error.h"

namespace lightwell::scene {
namespace {

constexpr int kMaxDepth = 64;

/// Levels of arrays and objects, of text that may be no JSON. A pass of its own, because a parser with a callback looks through all siblings again after each object.
int depthOf(std::span<const char> text) {
  int depth = 0, most = 0;
  bool in_string = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      else if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      most = std::max(most, ++depth);
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return most;
}

}  // namespace

nlohmann::json parseJson(const std::string& file, std::span<const char> text) {
  if (depthOf(text) > kMaxDepth) throw InputError(file, "", "the JSON nests more than " + std::to_string(kMaxDepth) + " levels deep");
  try {
    return nlohmann::json::parse(text.begin(), text.end());
  } catch (const nlohmann::json::exception& e) {
    throw InputError(file, "", std::string("not JSON: ") + e.what());
  }
}

void JsonValue::fail(const std::string& reason) const { throw InputError(*file_, path_, reason); }

std::optional<JsonValue> JsonValue::find(std::string_view key) const {
  if (!value_->is_object()) fail("is not an object");
  const auto it = value_->find(std::string(key));
  if (it == value_->end()) return std::nullopt;
  return JsonValue(*file_, *it, path_.empty() ? std::string(key) : path_ + "." + std::string(key));
}

JsonValue JsonValue::at(std::string_view key) const {
  auto member = find(key);
  if (!member) fail("has no \"" + std::string(key) + "\"");
  return *std::move(member);
}

std::optional<JsonValue> JsonValue::extension(std::string_view name) const {
  const auto extensions = find("extensions");
  return extensions ? extensions->find(name) : std::nullopt;
}

std::vector<std::string> JsonValue::keys() const {
  if (!value_->is_object()) fail("is not an object");
  std::vector<std::string> result;
  for (const auto& item : value_->items()) result.push_back(item.key());
  return result;
}

bool JsonValue::isObject() const { return value_->is_object(); }
bool JsonValue::isBoolean() const { return value_->is_boolean(); }

size_t JsonValue::size() const {
  if (!value_->is_array()) fail("is not an array");
  return value_->size();
}

JsonValue JsonValue::operator[](size_t i) const {
  if (i >= size()) fail("has no element " + std::to_string(i));
  return JsonValue(*file_, (*value_)[i], path_ + "[" + std::to_string(i) + "]");
}

double JsonValue::number() const {
  if (!value_->is_number()) fail("is not a number");
  const double number = value_->get<double>();
  if (!std::isfinite(number)) fail("is not finite");
  return number;
}

bool JsonValue::boolean() const {
  if (!value_->is_boolean()) fail("is neither true nor false");
  return value_->get<bool>();
}

const std::string& JsonValue::string() const {
  if (!value_->is_string()) fail("is not a string");
  return value_->get_ref<const std::string&>();
}

size_t JsonValue::unsignedInteger() const {
  const double value = number();  // JSON does not tell 3 from 3.0
  if (value < 0 || value > 0x1p53 || value != std::floor(value)) fail("is not a whole number ≥ 0");
  return size_t(value);
}

size_t JsonValue::index(size_t count, std::string_view array) const {
  const size_t value = unsignedInteger();
  if (value >= count)
    fail("is " + std::to_string(value) + ", but there are " + std::to_string(count) + " " + std::string(array));
  return value;
}

double JsonValue::numberOr(std::string_view key, double fallback) const {
  const auto member = find(key);
  return member ? member->number() : fallback;
}
bool JsonValue::booleanOr(std::string_view key, bool fallback) const {
  const auto member = find(key);
  return member ? member->boolean() : fallback;
}
std::string JsonValue::stringOr(std::string_view key, std::string_view fallback) const {
  const auto member = find(key);
  return member ? member->string() : std::string(fallback);
}
size_t JsonValue::unsignedOr(std::string_view key, size_t fallback) const {
  const auto member = find(key);
  return member ? member->unsignedInteger() : fallback;
}

void JsonValue::fillNumbers(std::span<double> result) const {
  if (size() != result.size()) fail("has " + std::to_string(size()) + " elements instead of " + std::to_string(result.size()));
  for (size_t i = 0; i < result.size(); ++i) result[i] = (*this)[i].number();
}

}  // namespace lightwell::scene
