#include "precompute/scene/json_value.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "precompute/core/error.h"

namespace lightwell::scene {
namespace {
constexpr int kMaxDepth = 64;
}

nlohmann::json parseJson(const std::string& file, std::span<const char> text) {
  const auto limit_depth = [&](int depth, nlohmann::json::parse_event_t, nlohmann::json&) {
    if (depth > kMaxDepth) throw InputError(file, "", "the JSON nests more than " + std::to_string(kMaxDepth) + " levels deep");
    return true;
  };
  try {
    return nlohmann::json::parse(text.begin(), text.end(), limit_depth);
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
