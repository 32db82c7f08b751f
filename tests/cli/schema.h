// The part of JSON Schema (2020-12) that schemas/ uses. A keyword that it does not know is an error: nothing passes unchecked.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace lightwell::test {

/// Empty when `value` obeys `schema`; otherwise what is wrong and where.
std::string schemaViolation(const nlohmann::json& schema, const nlohmann::json& value, const std::string& place = "$");

/// schemas/<name>.schema.json.
nlohmann::json readSchema(const std::string& name);

}  // namespace lightwell::test
