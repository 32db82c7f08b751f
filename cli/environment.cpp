// lightwell environment: what the runtime answers from a baked sky, unoccluded, and what the map itself says.
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "cli/environment_queries.h"
#include "cli/runtime_handles.h"
#include "format/encode/reader.h"
#include "precompute/bake/context.h"
#include "precompute/transport/environment/exact_environment.h"

namespace lightwell::cli {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;
using transport::EnvironmentQuery;

struct Options {
  fs::path container, queries;
  std::optional<fs::path> exact;
  int threads = 0;
  bool json = false;
};

std::vector<Rgb> answer(const RuntimeContainer& container, const std::vector<EnvironmentQuery>& queries, const CancelFlag& cancel) {
  const auto environment = container.loadEnvironment();
  std::vector<Rgb> values;
  for (const EnvironmentQuery& query : queries) {
    cancel.check();
    Rgb value;
    container.check(lw_environment_phong(environment.get(), &query.axis.x, query.shininess, nullptr, &value.x));
    values.push_back(value);
  }
  return values;
}

/// The map as the bake placed it.
std::vector<Rgb> exactAnswers(Session& session, const Options& options, const format::Reader& reader,
                              const std::vector<EnvironmentQuery>& queries) {
  const v1::EnvironmentHeader header = reader.environment();
  plan::EnvironmentPlacement placement{.rotation_deg = header.rotation_deg(), .intensity = header.intensity(), .ground_radiance_rgb = {}};
  if (header.ground_radiance_size() == 3)
    placement.ground_radiance_rgb = {header.ground_radiance(0), header.ground_radiance(1), header.ground_radiance(2)};
  Diagnostics diagnostics;
  transport::EnvironmentMap map = bake::openPlacedMap(*options.exact, options.exact->string(), placement, diagnostics);
  session.console.progress("quadrature", "quadrature over the map …");
  const std::vector<Rgb> exact = transport::exactAnswers(map, queries, options.threads, diagnostics, &session.interrupt.flag());
  for (const auto& warning : diagnostics.warnings()) session.console.warning(warning);
  return exact;
}

json numbers(const Rgb& value) { return {value.x, value.y, value.z}; }

void summarise(Session& session, const std::vector<EnvironmentQuery>& queries, const std::vector<Rgb>& values, const std::vector<Rgb>& exact) {
  if (exact.empty()) return session.console.line(std::to_string(queries.size()) + " answers");
  double difference2 = 0, exact2 = 0;
  for (size_t i = 0; i < exact.size(); ++i) difference2 += (values[i] - exact[i]).length2(), exact2 += exact[i].length2();
  char text[96];
  std::snprintf(text, sizeof text, "%zu answers, relrmse %.3g %% against the map", queries.size(),
                exact2 > 0 ? 100 * std::sqrt(difference2 / exact2) : 0.0);
  session.console.line(text);
}

void run(Session& session, const Options& options) {
  checkReadable(options.container);
  checkReadable(options.queries);
  if (options.exact) checkReadable(*options.exact);
  const std::vector<EnvironmentQuery> queries = readQueries(options.queries);
  const format::Reader reader(options.container);
  if (!reader.has("environment")) throw UsageError(reader.file() + " has no section environment");
  const std::vector<Rgb> values = answer(RuntimeContainer(options.container), queries, session.interrupt.flag());
  std::vector<Rgb> exact;
  if (options.exact) exact = exactAnswers(session, options, reader, queries);

  json answers = json::array();
  for (size_t i = 0; i < values.size(); ++i) {
    answers.push_back({{"value", numbers(values[i])}});
    if (options.exact) answers.back()["exact"] = numbers(exact[i]);
  }
  if (options.json) printJson({{"answers", answers}});
  else
    for (const auto& a : answers) std::printf("%s%s\n", a["value"].dump().c_str(), a.contains("exact") ? ("  exact " + a["exact"].dump()).c_str() : "");
  summarise(session, queries, values, exact);
}

}  // namespace

void addEnvironmentQueries(CLI::App& app, Session& session) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("environment", "What a baked sky answers for normals and mirror directions, unoccluded");
  command->add_option("container", options->container, "Container with a section environment")->required()->type_name("OUT.lwc");
  command->add_option("--queries", options->queries, R"({"queries":[{"normal":[0,1,0]},{"mirror":[0,1,0],"shininess":100}]})")
      ->required()
      ->type_name("Q.json");
  command->add_option("--exact", options->exact, "The map: also answer by quadrature over its texels, placed as in the bake")
      ->type_name("FILE");
  addThreads(*command, options->threads);
  command->add_flag("--json", options->json, "Print the answers as JSON (schemas/environment.schema.json)");
  command->footer(R"(For a normal the answer is the irradiance; for a mirror direction, the integral of radiance times cos^shininess of the
angle to it over the half sphere around it. Red, green and blue, in the order of the queries.

Example:
  lightwell environment sky.lwc --queries q.json --exact sky.hdr --json)");
  command->callback([&session, options] { run(session, *options); });
}

}  // namespace lightwell::cli
