#include "tests/cli/schema.h"

#include <algorithm>
#include <fstream>
#include <regex>

namespace lightwell::test {
namespace {

using nlohmann::json;

bool isOfType(const json& value, const std::string& type) {
  return (type == "object" && value.is_object()) || (type == "array" && value.is_array()) || (type == "string" && value.is_string()) ||
         (type == "number" && value.is_number()) || (type == "integer" && value.is_number_integer()) ||
         (type == "boolean" && value.is_boolean()) || (type == "null" && value.is_null());
}

std::string violationOfObject(const json& schema, const json& value, const std::string& place) {
  for (const auto& name : schema.value("required", json::array()))
    if (!value.contains(name.get<std::string>())) return place + " lacks " + name.dump();
  const json properties = schema.value("properties", json::object());
  for (const auto& [name, member] : value.items()) {
    if (!properties.contains(name)) {
      if (!schema.value("additionalProperties", true)) return place + " has the unknown member " + name;
      continue;
    }
    if (auto violation = schemaViolation(properties[name], member, place + "." + name); !violation.empty()) return violation;
  }
  return "";
}

}  // namespace

std::string schemaViolation(const json& schema, const json& value, const std::string& place) {
  for (const auto& [keyword, rule] : schema.items()) {
    if (keyword == "$schema" || keyword == "title" || keyword == "description" || keyword == "required" || keyword == "properties" ||
        keyword == "additionalProperties")
      continue;  // the last three are read below
    if (keyword == "type") {
      const json types = rule.is_array() ? rule : json::array({rule});
      if (std::none_of(types.begin(), types.end(), [&](const json& type) { return isOfType(value, type.get<std::string>()); }))
        return place + " is not of type " + rule.dump() + ": " + value.dump();
    } else if (keyword == "enum") {
      if (std::find(rule.begin(), rule.end(), value) == rule.end()) return place + " is none of " + rule.dump() + ": " + value.dump();
    } else if (keyword == "minimum") {
      if (value.is_number() && value < rule) return place + " is less than " + rule.dump();
    } else if (keyword == "maximum") {
      if (value.is_number() && value > rule) return place + " is more than " + rule.dump();
    } else if (keyword == "minItems" || keyword == "maxItems") {
      if (value.is_array() && (keyword == "minItems" ? value.size() < rule.get<size_t>() : value.size() > rule.get<size_t>()))
        return place + " has " + std::to_string(value.size()) + " items";
    } else if (keyword == "pattern") {
      if (value.is_string() && !std::regex_search(value.get<std::string>(), std::regex(rule.get<std::string>())))
        return place + " does not match " + rule.dump();
    } else if (keyword == "items") {
      if (value.is_array())
        for (size_t i = 0; i < value.size(); ++i)
          if (auto violation = schemaViolation(rule, value[i], place + "[" + std::to_string(i) + "]"); !violation.empty()) return violation;
    } else if (keyword == "oneOf") {
      if (std::count_if(rule.begin(), rule.end(), [&](const json& one) { return schemaViolation(one, value, place).empty(); }) != 1)
        return place + " does not match exactly one of the alternatives: " + value.dump();
    } else {
      return place + ": the schema uses the keyword " + keyword + ", which is not checked here";
    }
  }
  return value.is_object() ? violationOfObject(schema, value, place) : "";
}

json readSchema(const std::string& name) {
  std::ifstream in(std::string(LIGHTWELL_SCHEMAS) + "/" + name + ".schema.json");
  return json::parse(in);
}

}  // namespace lightwell::test
