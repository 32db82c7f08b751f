// lightwell info: what is in a container.
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "format/encode/reader.h"
#include "precompute/bake/run.h"

namespace lightwell::cli {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;

struct Options {
  fs::path container;
  bool json = false;
};

const char* elementName(const format::ChunkInfo& chunk) {
  static constexpr const char* kNames[] = {"", "bytes", "u8", "i8", "u16", "i16", "u32", "f16", "f32", "rgb9e5"};
  return chunk.decodable ? kNames[int(chunk.element)] : "unknown";
}
const char* codecName(const format::ChunkInfo& chunk) {
  static constexpr const char* kNames[] = {"", "raw", "zstd", "zstd_planes", "zstd_delta_planes", "rans"};
  return chunk.decodable ? kNames[int(chunk.codec)] : "unknown";
}

json chunkJson(const format::ChunkInfo& chunk) {
  return {{"name", chunk.name},
          {"element", elementName(chunk)},
          {"shape", std::vector<uint64_t>(chunk.shape, chunk.shape + chunk.rank)},
          {"codec", codecName(chunk)},
          {"stored_bytes", chunk.stored_bytes},
          {"raw_bytes", chunk.raw_bytes}};
}

json sectionsJson(const format::Reader& reader) {
  json sections = json::array();
  for (const auto& section : reader.view().sections())
    sections.push_back({{"type", section.type},
                        {"version", section.version},
                        {"required", section.required},
                        {"known", section.known},
                        {"stored_bytes", 0},
                        {"raw_bytes", 0},
                        {"chunks", json::array()}});
  for (const auto& chunk : reader.view().chunks()) {
    json& section = sections[chunk.section_index];
    section["chunks"].push_back(chunkJson(chunk));
    section["stored_bytes"] = section["stored_bytes"].get<uint64_t>() + chunk.stored_bytes;
    section["raw_bytes"] = section["raw_bytes"].get<uint64_t>() + chunk.raw_bytes;
  }
  return sections;
}

json portalsJson(const v1::RadiosityHeader& radiosity) {
  json portals = json::array();
  for (const auto& portal : radiosity.portals()) portals.push_back({{"name", portal.name()}, {"strips", portal.strips()}, {"triangles", portal.triangles()}});
  return portals;
}

/// The parts of the headers that people ask for.
json contentJson(const format::Reader& reader) {
  json content = json::object();
  if (reader.has("scene", "header")) {
    const auto scene = reader.scene();
    content["scene"] = {{"origin_m", std::vector<double>(scene.origin().begin(), scene.origin().end())},
                        {"bounds_min_m", std::vector<float>(scene.bounds_min().begin(), scene.bounds_min().end())},
                        {"bounds_max_m", std::vector<float>(scene.bounds_max().begin(), scene.bounds_max().end())},
                        {"lights", scene.lights_size()}};
  }
  if (reader.has("atlas", "header")) {
    const auto atlas = reader.atlas();
    content["atlas"] = {{"width", atlas.width()},
                        {"height", atlas.height()},
                        {"covered_texels", atlas.covered_texels()},
                        {"charts", atlas.charts()},
                        {"unwrapped", atlas.unwrapped()}};
  }
  if (reader.has("prm", "header")) {
    const auto prm = reader.prm();
    content["prm"] = {{"layout", prm.layout() == v1::PRM_LAYOUT_PANES ? "panes" : "local_bases"},
                      {"entries", prm.entries()},
                      {"clusters", prm.clusters()},
                      {"texels", prm.texels()},
                      {"blocks", prm.blocks()},
                      {"max_rank", prm.max_rank()},
                      {"brightest", prm.brightest()},
                      {"has_emitter", prm.has_emitter()},
                      {"has_sky", prm.has_sky()}};
  }
  if (reader.has("radiosity", "header")) {
    const auto radiosity = reader.radiosity();
    const auto names = [](const auto& items) {
      json list = json::array();
      for (const auto& item : items) list.push_back(item.name());
      return list;
    };
    content["radiosity"] = {{"patches", radiosity.patches()},
                            {"texels", radiosity.texels()},
                            {"links", reader.has("radiosity", "link_node") ? reader.chunk("radiosity", "link_node").elements : 0},
                            {"raw_transfers", radiosity.raw_transfers()},
                            {"dark_patches", radiosity.dark_patches()},
                            {"has_emission", radiosity.has_emission()},
                            {"has_backs", radiosity.has_backs()},
                            {"materials", names(radiosity.materials())},
                            {"portals", portalsJson(radiosity)}};
  }
  if (reader.has("lightmap", "header")) {
    const auto lightmap = reader.lightmap();
    content["lightmap"] = {{"texels", lightmap.texels()}, {"has_direct", lightmap.has_direct()}, {"has_indirect", lightmap.has_indirect()},
                           {"has_gradients", lightmap.has_direct_gradient() || lightmap.has_indirect_gradient()}};
  }
  if (reader.has("vpl", "header")) {
    const auto vpl = reader.vpl();
    constexpr const char* kTypes[] = {"points", "disks", "spheres", "polygons"};
    json of_type = json::object();
    for (const char* type : kTypes) of_type[type] = 0;
    for (const uint8_t type : reader.read<uint8_t>("vpl", "type"))
      if (type >= 1 && type <= 4) of_type[kTypes[type - 1]] = of_type[kTypes[type - 1]].get<int>() + 1;
    content["vpl"] = {{"lights", vpl.lights()}, {"of_type", of_type}, {"vertices", vpl.vertices()}, {"sources", vpl.sources()}, {"clustered_from", vpl.points()}};
  }
  if (reader.has("points", "header")) content["points"] = {{"points", reader.points().points()}, {"area_m2", reader.points().area()}};
  if (reader.has("prm_probes", "header"))
    content["prm_probes"] = {{"probes", reader.prmProbes().probes()},
                             {"max_rank", reader.prmProbes().max_rank()},
                             {"has_emitter", reader.prmProbes().has_emitter()},
                             {"links", reader.has("prm_probes", "link_wavelet") ? reader.chunk("prm_probes", "link_wavelet").elements : 0}};
  if (reader.has("probes", "header")) {
    const auto probes = reader.probes();
    content["probes"] = {{"lattice_probes", probes.lattice_probes()},
                         {"points", probes.points()},
                         {"lattice_count", std::vector<uint32_t>(probes.lattice_count().begin(), probes.lattice_count().end())},
                         {"lattice_spacing_m", probes.lattice_spacing()},
                         {"moved", probes.moved()},
                         {"inside", probes.inside()},
                         {"sealed", probes.sealed()},
                         {"links", reader.has("probes", "link_node") ? reader.chunk("probes", "link_node").elements : 0}};
  }
  if (reader.has("environment", "header")) {
    const auto environment = reader.environment();
    content["environment"] = {{"cells", environment.cells()},
                              {"suns", environment.suns()},
                              {"face_cells", environment.face_cells()},
                              {"sky_flux", std::vector<float>(environment.sky_flux().begin(), environment.sky_flux().end())},
                              {"rotation_deg", environment.rotation_deg()},
                              {"intensity", environment.intensity()},
                              {"ground_radiance",
                               std::vector<float>(environment.ground_radiance().begin(), environment.ground_radiance().end())}};
  }
  return content;
}

std::string hexadecimal(uint64_t hash) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

json documentOf(const format::Reader& reader) {
  json document{{"file", reader.file()},
                {"bytes", reader.view().fileBytes()},
                {"version", "1." + std::to_string(reader.view().versionMinor())},
                {"sections", sectionsJson(reader)},
                {"content", contentJson(reader)},
                {"omitted", json::array()},
                {"errors", json::array()},
                {"provenance", nullptr}};
  if (!reader.has("meta", "header")) return document;
  const auto meta = reader.meta();
  for (const auto& o : meta.omitted()) document["omitted"].push_back({{"type", o.type()}, {"reason", o.reason()}, {"decoded_bytes", o.decoded_bytes()}, {"rays", o.rays()}});
  for (const auto& e : meta.errors())
    document["errors"].push_back(bake::errorJson(e));
  const auto& p = meta.provenance();
  const json settings = json::parse(p.settings_json(), nullptr, false);
  document["provenance"] = {{"tool_version", p.tool_version()},
                            {"scene_name", p.scene_name()},
                            {"scene_hash", hexadecimal(p.scene_hash())},
                            {"environment_name", p.environment_name()},
                            {"environment_hash", hexadecimal(p.environment_hash())},
                            {"settings", settings.is_discarded() ? json(nullptr) : settings},
                            {"time_limited", p.time_limited()},
                            {"warnings", std::vector<std::string>(p.warnings().begin(), p.warnings().end())}};
  return document;
}

std::string shapeText(const json& shape) {
  std::string text;
  for (const auto& extent : shape) text += (text.empty() ? "" : " x ") + extent.dump();
  return text.empty() ? "1" : text;
}

std::string padded(std::string text, size_t width) { return text.append(text.size() < width ? width - text.size() : 1, ' '); }

/// Whether the plan has added radiosity of its own accord.
bool isThereForPortals(const json& d) {
  const json& content = d["content"];
  if (!content.contains("radiosity") || content["radiosity"]["portals"].empty() || d["provenance"].is_null()) return false;
  const json& settings = d["provenance"]["settings"];
  return settings.is_object() && settings.value("techniques", json()) == "auto";
}

/// A share of one as people read it.
std::string percentText(const json& share) {
  if (!share.is_number()) return "undefined";
  char text[32];
  std::snprintf(text, sizeof text, "%.3g %%", 100 * share.get<double>());
  return text;
}

/// " (LOW to HIGH)", or nothing.
std::string intervalText(const json& error, const char* key) {
  return error.contains(key) ? " (" + percentText(error[key][0]) + " to " + percentText(error[key][1]) + ")" : "";
}

void printForPeople(const json& d) {
  const auto out = [](const std::string& line) { std::printf("%s\n", line.c_str()); };
  out(d["file"].get<std::string>() + ": container version " + d["version"].get<std::string>() + ", " +
      formatBytes(d["bytes"].get<double>()));
  if (const auto& p = d["provenance"]; !p.is_null()) {
    std::string sources;
    for (const std::string source : {"scene", "environment"})
      if (const auto name = p[source + "_name"].get<std::string>(); !name.empty())
        sources += (sources.empty() ? "" : " under ") + name + " (" + p[source + "_hash"].get<std::string>() + ")";
    out("  baked from " + sources + " by lightwell " + p["tool_version"].get<std::string>() +
        (p["time_limited"].get<bool>() ? ", cut by a time limit" : ""));
    out("  settings " + p["settings"].dump());
    for (const auto& w : p["warnings"]) out("  warning: " + w.get<std::string>());
  }
  for (const auto& [name, header] : d["content"].items()) {
    std::string line = "  " + name + ":";
    for (const auto& [key, value] : header.items())
      line += " " + key + " " + (value.is_string() ? value.get<std::string>() : value.dump()) + ",";
    line.pop_back();
    out(line);
  }
  for (const auto& s : d["sections"]) {
    out(padded(s["type"].get<std::string>(), 12) + padded(formatBytes(s["stored_bytes"].get<double>()), 10) + "decoded " +
        formatBytes(s["raw_bytes"].get<double>()) + (s["known"].get<bool>() ? "" : "  (not known to this version)"));
    for (const auto& c : s["chunks"])
      out("  " + padded(c["name"].get<std::string>(), 22) + padded(c["element"].get<std::string>(), 8) + padded(shapeText(c["shape"]), 18) +
          padded(c["codec"].get<std::string>(), 18) + formatBytes(c["stored_bytes"].get<double>()));
  }
  for (const auto& e : d["errors"])
    out("measured error of " + e["section"].get<std::string>() + ": relrmse " + percentText(e["relrmse"]) + intervalText(e, "relrmse_interval") + ", texrel " +
        percentText(e["texrel"]) + intervalText(e, "texrel_interval") + ", bias " + percentText(e["bias"]) + intervalText(e, "bias_interval") +
        (e.contains("maximum") ? ", maximum " + percentText(e["maximum"]) + intervalText(e, "maximum_interval") : "") + " against " + e["against"].get<std::string>() +
        (e.contains("seconds") ? ", baked in " + formatDuration(e["seconds"].get<double>()) : ""));
  if (isThereForPortals(d)) out("with radiosity: the scene has portals, which the other sections have as they are in the file");
  for (const auto& o : d["omitted"]) {
    const double bytes = o["decoded_bytes"].get<double>(), rays = o["rays"].get<double>();
    std::string saved = bytes > 0 ? " (saves " + formatBytes(bytes) + " decoded" : "";
    if (rays > 0) saved += (saved.empty() ? " (saves " : ", ") + formatCount(rays) + " rays";
    out("without " + o["type"].get<std::string>() + ": " + o["reason"].get<std::string>() + saved + (saved.empty() ? "" : ")"));
  }
}

void run(const Options& options) {
  checkReadable(options.container);
  const format::Reader reader(options.container);
  const json document = documentOf(reader);
  if (options.json)
    printJson(document);
  else
    printForPeople(document);
}

}  // namespace

void addInfo(CLI::App& app, Session&) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("info", "Tell what is in a container: sections, sizes, codecs, what was left out and why");
  command->add_option("container", options->container, "Container to read")->required()->type_name("OUT.lwc");
  command->add_flag("--json", options->json, "Print JSON (schemas/info.schema.json)");
  command->footer("Example:\n  lightwell info room.lwc --json | jq '.sections[] | {type, stored_bytes}'");
  command->callback([options] { run(*options); });
}

}  // namespace lightwell::cli
