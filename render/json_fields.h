// Reading the small JSON files of people's hands: every value checked, every complaint with its place.
#pragma once
#include <array>
#include <filesystem>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "render/vector_math.h"

namespace lightwell::render {

/// At most 1 MiB. Throws FileError.
std::string readSmallFile(const std::filesystem::path& file);
/// Nesting is limited. Throws FileError.
nlohmann::json parseJson(std::string_view text, const std::string& file);

/// The members of one object. All functions throw FileError naming `place` and the key.
class JsonFields {
 public:
  /// `json` and `file` must outlive this. Keys other than `known` are errors.
  JsonFields(const nlohmann::json& json, const std::string& file, std::string place, std::initializer_list<const char*> known);

  bool has(const char* key) const { return json_.contains(key); }
  /// Finite, within ±1e9 and [low, high]. Without `fallback` the key must be there.
  double number(const char* key, std::optional<double> fallback, double low = -1e9, double high = 1e9) const;
  int integer(const char* key, int fallback, int low, int high) const;
  bool boolean(const char* key, bool fallback) const;
  std::array<double, 3> vector(const char* key, const std::optional<std::array<double, 3>>& fallback, double low = -1e9) const;
  /// The vector scaled to length 1; zero is an error.
  Float3 direction(const char* key, const std::optional<std::array<double, 3>>& fallback) const;
  /// The index of the string in `names`.
  size_t choice(const char* key, const std::vector<std::string>& names, const std::optional<std::string>& fallback) const;
  const nlohmann::json& at(const char* key) const;
  [[noreturn]] void fail(const char* key, const std::string& reason) const;

 private:
  double checked(const char* key, const nlohmann::json& value, double low, double high) const;
  const nlohmann::json& json_;
  const std::string& file_;
  std::string place_;
};

}  // namespace lightwell::render
