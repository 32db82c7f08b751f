// A JSON value that knows where it stands, so that every complaint names the file and the place in it.
#pragma once
#include <array>
#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lightwell::scene {

/// Parses UTF-8 JSON that nests at most 64 deep. Throws InputError with the byte at which it fails.
nlohmann::json parseJson(const std::string& file, std::span<const char> text);

/// A view of a value inside a parsed document; the document and `file` must outlive it. Every accessor checks the type and
/// throws InputError naming the path (`meshes[3].primitives[0].indices`) when it is another.
class JsonValue {
 public:
  JsonValue(const std::string& file, const nlohmann::json& value, std::string path = {})
      : file_(&file), value_(&value), path_(std::move(path)) {}

  const std::string& file() const { return *file_; }
  const std::string& path() const { return path_; }
  [[noreturn]] void fail(const std::string& reason) const;

  /// The member of an object, or nothing when it is absent.
  std::optional<JsonValue> find(std::string_view key) const;
  /// The member of an object; absent is an error.
  JsonValue at(std::string_view key) const;
  /// `extensions.NAME` of an object, or nothing.
  std::optional<JsonValue> extension(std::string_view name) const;
  std::vector<std::string> keys() const;

  bool isObject() const;
  bool isBoolean() const;

  size_t size() const;  // of an array
  JsonValue operator[](size_t i) const;

  double number() const;  // finite
  bool boolean() const;
  const std::string& string() const;
  /// A whole number in [0, 2^53].
  size_t unsignedInteger() const;
  /// A whole number below `count`: an index into the array called `array`.
  size_t index(size_t count, std::string_view array) const;

  double numberOr(std::string_view key, double fallback) const;
  bool booleanOr(std::string_view key, bool fallback) const;
  std::string stringOr(std::string_view key, std::string_view fallback) const;
  size_t unsignedOr(std::string_view key, size_t fallback) const;
  /// An array of exactly N finite numbers.
  template <size_t N>
  std::array<double, N> numbers() const {
    std::array<double, N> result;
    fillNumbers(result);
    return result;
  }
  template <size_t N>
  std::array<double, N> numbersOr(std::string_view key, const std::array<double, N>& fallback) const {
    const auto member = find(key);
    return member ? member->numbers<N>() : fallback;
  }

 private:
  void fillNumbers(std::span<double> result) const;
  const std::string* file_;
  const nlohmann::json* value_;
  std::string path_;
};

}  // namespace lightwell::scene
