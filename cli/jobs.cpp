// lightwell jobs, watch, fetch and cancel: what becomes of jobs on a server.
#include <cstdio>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/service_options.h"
#include "server/job/job_json.h"

namespace lightwell::cli {
namespace {
namespace fs = std::filesystem;

const std::map<std::string, v1::JobState> kStates{{"queued", v1::JOB_STATE_QUEUED},
                                                  {"running", v1::JOB_STATE_RUNNING},
                                                  {"succeeded", v1::JOB_STATE_SUCCEEDED},
                                                  {"failed", v1::JOB_STATE_FAILED},
                                                  {"cancelled", v1::JOB_STATE_CANCELLED}};

struct Options {
  ServiceOptions service;
  std::string job, label;
  std::vector<std::string> states;
  uint32_t limit = 50;
  fs::path output;
  bool remove = false;
};

/// The job of the command line; what is printed with --json is that job afterwards.
using Action = std::function<v1::Job(server::Client&)>;

void printJobs(Session& session, const Options& options) {
  server::Client client = connect(session, options.service);
  v1::ListJobsRequest request;
  request.set_label(options.label);
  for (const auto& state : options.states) request.add_states(kStates.at(state));
  nlohmann::json document{{"jobs", nlohmann::json::array()}};
  for (uint32_t left = options.limit; left > 0;) {
    request.set_page_size(std::min(left, 200u));
    const auto page = client.list(request);
    for (const auto& job : page.jobs()) {
      if (options.service.json) document["jobs"].push_back(server::jobJson(job));
      else std::printf("%s\n", summaryLine(job).c_str());
    }
    left -= std::min(left, uint32_t(page.jobs_size()));
    request.set_page_token(page.next_page_token());
    if (page.next_page_token().empty()) break;
  }
  if (options.service.json) printJson(document);
}

void act(Session& session, const Options& options, const Action& action) {
  server::Client client = connect(session, options.service);
  const v1::Job job = action(client);
  if (options.service.json) printJson(server::jobJson(job));
}

CLI::App* addCommand(CLI::App& app, const std::shared_ptr<Options>& options, const char* name, const char* what, bool of_a_job) {
  CLI::App* command = app.add_subcommand(name, what);
  if (of_a_job) command->add_option("job", options->job, "Its id")->required()->type_name("JOB");
  addServiceOptions(*command, options->service);
  command->add_flag("--json", options->service.json,
                    of_a_job ? "Print the job on stdout (schemas/job.schema.json)" : "Print {\"jobs\": […]} on stdout (schemas/job.schema.json)");
  return command;
}

}  // namespace

void addJobs(CLI::App& app, Session& session) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = addCommand(app, options, "jobs", "Jobs on the server, newest first", false);
  std::vector<std::string> names;
  for (const auto& [name, state] : kStates) names.push_back(name);
  command->add_option("--state", options->states, "Only these states; may be repeated")->type_name("NAME")->check(CLI::IsMember(names));
  command->add_option("--label", options->label, "Only jobs with this label")->type_name("TEXT");
  command->add_option("--limit", options->limit, "At most so many")->type_name("N")->check(CLI::Range(1u, 100000u))->capture_default_str();
  command->callback([&session, options] { printJobs(session, *options); });
}

void addWatch(CLI::App& app, Session& session) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = addCommand(app, options, "watch", "Progress of a job until it ends; restarts of the server are survived", true);
  command->callback([&session, options] {
    v1::Job job;
    act(session, *options, [&](server::Client& client) {
      job = watchJob(session, client, options->service, options->job);
      session.console.line(summaryLine(job));
      return job;
    });
    requireSuccess(job);
  });
}

void addFetch(CLI::App& app, Session& session) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = addCommand(app, options, "fetch", "Download the container of a job that succeeded", true);
  addOutput(*command, options->output, "Container to write");
  command->callback([&session, options] {
    checkWritable(options->output);
    act(session, *options, [&](server::Client& client) {
      fetchResult(session, client, options->job, options->output);
      return client.get(options->job);
    });
  });
}

void addCancel(CLI::App& app, Session& session) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = addCommand(app, options, "cancel", "End a job; a finished one stays as it is", true);
  command->add_flag("--delete", options->remove, "Delete the job too, with its container");
  command->callback([&session, options] {
    act(session, *options, [&](server::Client& client) {
      v1::Job job = client.cancel(options->job);
      if (options->remove || job.state() == v1::JOB_STATE_RUNNING) job = client.watch(options->job, {});
      if (options->remove) client.remove(options->job);
      session.console.line(summaryLine(job) + (options->remove ? ", deleted" : ""));
      return job;
    });
  });
}

}  // namespace lightwell::cli
