#include "cli/report/result.h"

#include <cmath>
#include <cstdio>

namespace lightwell::report {
namespace {

using nlohmann::json;

json number(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }
double numberOf(const json& value) { return value.is_null() ? std::numeric_limits<double>::infinity() : value.get<double>(); }

template <class T>
json optional(const std::optional<T>& value) { return value ? json(*value) : json(nullptr); }
template <class T>
void read(const json& object, const char* key, std::optional<T>& value) {
  if (const json& field = object.at(key); field.is_null()) value.reset();
  else value = field.get<T>();
}

json evaluatedJson(const Evaluated& e) {
  return {{"variant", e.variant}, {"command", e.command}, {"map", e.map}, {"texels", e.texels}, {"relrmse", number(e.relrmse)}, {"texrel", number(e.texrel)},
          {"bias", number(e.bias)}, {"p99", number(e.p99)}, {"max", number(e.max)}, {"relrmse_interval", {number(e.relrmse_low), number(e.relrmse_high)}},
          {"cpu_ms", optional(e.cpu_ms)}, {"gl_ms", optional(e.gl_ms)}, {"load_ms", optional(e.load_ms)}, {"fetched_bytes_per_texel", optional(e.fetched_bytes_per_texel)},
          {"texture_bytes", optional(e.texture_bytes)}};
}

Evaluated evaluatedOf(const json& j) {
  Evaluated e;
  j.at("variant").get_to(e.variant), j.at("command").get_to(e.command), j.at("map").get_to(e.map), j.at("texels").get_to(e.texels);
  e.relrmse = numberOf(j.at("relrmse")), e.texrel = numberOf(j.at("texrel")), e.bias = numberOf(j.at("bias")), e.p99 = numberOf(j.at("p99")), e.max = numberOf(j.at("max"));
  e.relrmse_low = numberOf(j.at("relrmse_interval").at(0)), e.relrmse_high = numberOf(j.at("relrmse_interval").at(1));
  read(j, "cpu_ms", e.cpu_ms), read(j, "gl_ms", e.gl_ms), read(j, "load_ms", e.load_ms), read(j, "fetched_bytes_per_texel", e.fetched_bytes_per_texel);
  read(j, "texture_bytes", e.texture_bytes);
  return e;
}

/// A CSV field (RFC 4180).
std::string field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}
std::string field(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return std::isfinite(value) ? text : "";
}
template <class T>
std::string field(const std::optional<T>& value) {
  if constexpr (std::is_integral_v<T>) return value ? std::to_string(*value) : "";
  else return value ? field(*value) : "";
}

}  // namespace

void to_json(json& j, const Baked& b) {
  json phases = json::array(), evaluated = json::array();
  for (const Phase& phase : b.phases) phases.push_back({{"name", phase.name}, {"seconds", phase.seconds}});
  for (const Evaluated& one : b.evaluated) evaluated.push_back(evaluatedJson(one));
  j = {{"series", b.series}, {"setting", b.setting}, {"technique", b.technique}, {"command", b.command}, {"file", b.file}, {"key", b.key}, {"seconds", optional(b.seconds)},
       {"rays", optional(b.rays)}, {"phases", phases}, {"container_bytes", b.container_bytes}, {"section_bytes", b.section_bytes},
       {"uncompressed_bytes", optional(b.uncompressed_bytes)}, {"evaluations", evaluated}};
}

void from_json(const json& j, Baked& b) {
  j.at("series").get_to(b.series), j.at("setting").get_to(b.setting), j.at("technique").get_to(b.technique), j.at("command").get_to(b.command), j.at("file").get_to(b.file);
  j.at("key").get_to(b.key), j.at("container_bytes").get_to(b.container_bytes), j.at("section_bytes").get_to(b.section_bytes);
  read(j, "seconds", b.seconds), read(j, "rays", b.rays), read(j, "uncompressed_bytes", b.uncompressed_bytes);
  for (const json& phase : j.at("phases")) b.phases.push_back({phase.at("name"), phase.at("seconds")});
  for (const json& one : j.at("evaluations")) b.evaluated.push_back(evaluatedOf(one));
}

void to_json(json& j, const SkyAnswer& a) {
  j = {{"model", a.model}, {"shininess", a.shininess}, {"cells", a.cells}, {"seconds", a.seconds}, {"relrmse", number(a.relrmse)}};
}
void from_json(const json& j, SkyAnswer& a) {
  j.at("model").get_to(a.model), j.at("shininess").get_to(a.shininess), j.at("cells").get_to(a.cells), j.at("seconds").get_to(a.seconds);
  a.relrmse = numberOf(j.at("relrmse"));
}

void to_json(json& j, const LampAnswer& a) {
  j = {{"incremental", a.incremental}, {"lights", a.lights}, {"shadow_side", a.shadow_side}, {"relrmse", number(a.relrmse)}, {"gl_ms", a.gl_ms}};
}
void from_json(const json& j, LampAnswer& a) {
  j.at("incremental").get_to(a.incremental), j.at("lights").get_to(a.lights), j.at("shadow_side").get_to(a.shadow_side), j.at("gl_ms").get_to(a.gl_ms);
  a.relrmse = numberOf(j.at("relrmse"));
}

void to_json(json& j, const RayRate& r) { j = {{"tracer_mrays_per_cpu_s", r.tracer_mrays}, {"raw_mrays_per_cpu_s", r.raw_mrays}, {"raw_robust_mrays_per_cpu_s", r.raw_robust_mrays}}; }
void from_json(const json& j, RayRate& r) {
  j.at("tracer_mrays_per_cpu_s").get_to(r.tracer_mrays), j.at("raw_mrays_per_cpu_s").get_to(r.raw_mrays), j.at("raw_robust_mrays_per_cpu_s").get_to(r.raw_robust_mrays);
}

void to_json(json& j, const Reference& r) {
  j = {{"samples", r.samples}, {"seeds", {r.first_seed, r.second_seed}}, {"seconds", r.seconds}, {"maps", {r.first, r.second}}, {"commands", {r.first_command, r.second_command}},
       {"noise", number(r.noise)}, {"resolution", number(r.resolution)}, {"mean_irradiance", number(r.mean_irradiance)}};
}
void from_json(const json& j, Reference& r) {
  j.at("samples").get_to(r.samples), j.at("seconds").get_to(r.seconds);
  r.first_seed = j.at("seeds").at(0), r.second_seed = j.at("seeds").at(1), r.first = j.at("maps").at(0), r.second = j.at("maps").at(1);
  r.first_command = j.at("commands").at(0), r.second_command = j.at("commands").at(1);
  r.noise = numberOf(j.at("noise")), r.resolution = numberOf(j.at("resolution")), r.mean_irradiance = numberOf(j.at("mean_irradiance"));
}

void to_json(json& j, const Report& r) {
  json skipped = json::array();
  for (const Skipped& one : r.skipped) skipped.push_back({{"what", one.what}, {"reason", one.reason}});
  j = {{"scene", r.scene}, {"environment", r.environment}, {"version", r.version}, {"key", r.key}, {"lights", r.lights}, {"made_lights", r.made_lights}, {"lightmap_size", r.lightmap_size},
       {"threads", r.threads}, {"texels", r.texels}, {"triangles", r.triangles}, {"lamps", r.lamps}, {"budget_s", r.budget_s}, {"seconds", r.seconds}, {"stage_seconds", r.stage_seconds},
       {"measured", r.measured}, {"reused", r.reused}, {"has_gl", r.has_gl}, {"reference", r.reference}, {"bakes", r.bakes}, {"sky", r.sky}, {"live_lamps", r.live_lamps},
       {"rays", r.rays ? json(*r.rays) : json(nullptr)}, {"skipped", skipped}};
}

std::string csvOf(const Report& report) {
  std::string csv = "technique,series,setting,variant,bake_seconds,rays,container_bytes,section_bytes,uncompressed_bytes,texels,relrmse,relrmse_low,relrmse_high,texrel,bias,p99,max,cpu_ms,gl_ms,load_ms,"
                    "fetched_bytes_per_texel,texture_bytes\n";
  for (const Baked& b : report.bakes)
    for (const Evaluated& e : b.evaluated)
      csv += field(b.technique) + "," + field(b.series) + "," + field(b.setting) + "," + field(e.variant) + "," + field(b.seconds) + "," + field(b.rays) + "," +
             std::to_string(b.container_bytes) + "," + std::to_string(b.section_bytes) + "," + field(b.uncompressed_bytes) + "," + std::to_string(e.texels) + "," + field(e.relrmse) + "," +
             field(e.relrmse_low) + "," + field(e.relrmse_high) + "," + field(e.texrel) + "," + field(e.bias) + "," + field(e.p99) + "," + field(e.max) + "," + field(e.cpu_ms) + "," +
             field(e.gl_ms) + "," + field(e.load_ms) + "," + field(e.fetched_bytes_per_texel) + "," + field(e.texture_bytes) + "\n";
  return csv;
}

}  // namespace lightwell::report
