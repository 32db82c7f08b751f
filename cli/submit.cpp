// lightwell submit: a bake on a server.
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/bake_options.h"
#include "cli/service_options.h"
#include "server/job/job_json.h"

namespace lightwell::cli {
namespace {
namespace fs = std::filesystem;

constexpr const char* kFooter = R"(Examples:
  lightwell submit room.glb --watch -o room.lwc             bake on the server, wait, download
  lightwell submit level.gltf --lightmap-size 512 --json    prints {"job": "…", …}; later: watch, fetch
  lightwell submit room.glb --server bake.example.org:7411 --tls-ca ca.pem --token-file token

The container is the same, byte for byte, as that of lightwell bake. Ctrl-C while watching leaves the job running.)";

struct Options {
  BakeOptions bake;
  ServiceOptions service;
  std::optional<fs::path> output;
  std::string label;
  int priority = 0;
  uint64_t memory_limit_bytes = 0;
  double wall_limit_s = 0;
  bool watch = false;
};

/// The spec and the files that it names.
v1::JobSpec specOf(const Options& options, std::vector<server::LocalFile>& files) {
  const bake::Request& request = options.bake.request;
  v1::JobSpec spec;
  if (!request.source.scene.empty()) {
    files = server::filesOfScene(request.source.scene);
    spec.set_scene(files[0].name);
  }
  const auto add = [&](const fs::path& path) {
    files.push_back(server::singleFile(path, files));
    return files.back().name;
  };
  if (request.source.lights) spec.set_lights(add(*request.source.lights));
  if (request.source.environment) spec.set_environment(add(*request.source.environment));
  for (const auto& file : files) {
    v1::SceneFile& named = *spec.add_files();
    named.set_name(file.name);
    named.set_sha256(file.sha256);
    named.set_size(file.size);
  }
  spec.set_settings_json(plan::canonicalJson(request.settings));
  spec.set_time_limit_s(request.time_limit_s.value_or(0));
  spec.set_target_error(request.target_error.value_or(0));
  spec.set_size_limit_bytes(request.size_limit_bytes.value_or(0));
  spec.set_threads(uint32_t(request.threads));
  spec.set_priority(options.priority);
  spec.set_label(options.label);
  spec.mutable_limits()->set_memory_bytes(options.memory_limit_bytes);
  spec.mutable_limits()->set_wall_s(options.wall_limit_s);
  return spec;
}

void run(Session& session, Options& options) {
  if (options.output) checkWritable(*options.output);
  resolve(options.bake);
  chooseLightmapSize(session, options.bake);
  server::Client client = connect(session, options.service);
  std::vector<server::LocalFile> files;
  const v1::JobSpec spec = specOf(options, files);
  client.upload(files, [&](uint64_t sent, uint64_t total) {
    session.console.progress("upload", "upload " + formatBytes(double(sent)) + " of " + formatBytes(double(total)));
  });
  v1::Job job = client.submit(spec);
  session.console.line("job " + job.id());
  if (options.watch || options.output) job = watchJob(session, client, options.service, job.id());
  if (options.output && job.state() == v1::JOB_STATE_SUCCEEDED) fetchResult(session, client, job.id(), *options.output);
  if (options.watch || options.output) session.console.line(summaryLine(job));
  if (options.service.json) {
    nlohmann::json document = server::jobJson(job);
    if (options.output) document["output"] = options.output->string();
    printJson(document);
  }
  if (options.watch || options.output) requireSuccess(job);
}

}  // namespace

void addSubmit(CLI::App& app, Session& session) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("submit", "Bake on a server (lightwelld): send the scene, make a job");
  addBakeOptions(*command, options->bake);
  command->add_flag("--watch", options->watch, "Show progress until the job ends");
  command->add_option("-o,--output", options->output, "Wait for the container and write it here")->type_name("FILE");
  command->add_option("--label", options->label, "For people: shown by jobs and on the status page")->type_name("TEXT");
  command->add_option("--priority", options->priority, "-10 to 10; greater goes first")->type_name("N")->check(CLI::Range(-10, 10));
  command->add_option("--memory-limit", options->memory_limit_bytes, "Of the job's worker; 0: the server's")->type_name("BYTES")
      ->transform(CLI::AsSizeValue(false));
  command->add_option("--wall-limit", options->wall_limit_s, "Seconds until the job is given up; 0: the server's")->type_name("S")
      ->check(CLI::NonNegativeNumber);
  addServiceOptions(*command, options->service);
  command->add_flag("--json", options->service.json, "Print the job on stdout (schemas/job.schema.json)");
  command->footer(kFooter);
  command->callback([&session, options] { run(session, *options); });
}

}  // namespace lightwell::cli
