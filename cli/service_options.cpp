#include "cli/service_options.h"

#include <nlohmann/json.hpp>

#include "format/encode/atomic_file.h"
#include "server/job/job_json.h"
#include "server/job/job_state.h"

namespace lightwell::cli {
namespace {

constexpr size_t kBarCells = 24;

std::string bar(double fraction) {
  const auto full = size_t(std::clamp(fraction, 0.0, 1.0) * kBarCells);
  return "[" + std::string(full, '#') + std::string(kBarCells - full, '.') + "]";
}

std::string progressLine(const v1::Job& job) {
  if (job.state() == v1::JOB_STATE_QUEUED)
    return "queued" + (job.waiting_for().empty() ? std::string() : ", waits for " + job.waiting_for());
  const v1::JobProgress& p = job.progress();
  char head[64];
  std::snprintf(head, sizeof head, "%s %3.0f %%  ", bar(p.fraction()).c_str(), 100 * p.fraction());
  std::string line = head + (p.phase().empty() ? std::string("starting") : p.phase());
  if (p.tasks_total()) line += ", " + std::to_string(p.tasks_done()) + " of " + std::to_string(p.tasks_total()) + " tasks";
  if (p.tasks_reused()) line += " (" + std::to_string(p.tasks_reused()) + " reused)";
  if (p.rays_per_second() > 0) line += ", " + formatCount(p.rays_per_second()) + " rays/s";
  if (p.has_relrmse()) {
    std::snprintf(head, sizeof head, ", error %.2g %%", 100 * p.relrmse());
    line += head;
  }
  line += ", " + formatDuration(p.elapsed_s());
  if (p.eta_s() >= 1) line += ", about " + formatDuration(p.eta_s()) + " left";
  return line;
}

}  // namespace

void addServiceOptions(CLI::App& command, ServiceOptions& options) {
  const std::string group = "Server";
  command.add_option("--server", options.client.server, "Where lightwelld listens")
      ->type_name("HOST:PORT")->envname("LIGHTWELL_SERVER")->capture_default_str()->group(group);
  command.add_option("--token-file", options.client.token_file, "File with the token for the server")
      ->type_name("FILE")->envname("LIGHTWELL_TOKEN_FILE")->group(group);
  command.add_option("--tls-ca", options.client.tls_ca, "Use TLS; the authority (PEM) of the server's certificate")
      ->type_name("FILE")->group(group);
  CLI::Option* certificate =
      command.add_option("--tls-certificate", options.client.tls_certificate, "Certificate (PEM) of this client")->type_name("FILE")->group(group);
  CLI::Option* key = command.add_option("--tls-key", options.client.tls_key, "Its key (PEM)")->type_name("FILE")->group(group);
  certificate->needs(key);
  key->needs(certificate);
}

server::Client connect(Session& session, const ServiceOptions& options) {
  server::ClientOptions client = options.client;
  client.waiting = [&session](const std::string& what) { session.console.line(what); };
  return server::Client(client, session.interrupt.flag());
}

v1::Job watchJob(Session& session, server::Client& client, const ServiceOptions& options, const std::string& id) {
  int warned = 0;
  const auto changed = [&](const v1::Job& job) {
    for (; warned < job.warnings_size(); ++warned)
      session.console.warning({job.warnings(warned).place(), job.warnings(warned).message()});
    if (!server::isFinal(job.state()))
      session.console.progress(job.state() == v1::JOB_STATE_QUEUED ? "queued" : job.progress().phase(), progressLine(job));
  };
  try {
    return client.watch(id, changed);
  } catch (const Cancelled&) {
    const std::string server = options.client.server == server::ClientOptions().server ? "" : " --server " + options.client.server;
    session.console.line("detached; the job goes on. Back to it: lightwell watch" + server + " " + id + "   end it: lightwell cancel" +
                         server + " " + id);
    throw;
  }
}

void fetchResult(Session& session, server::Client& client, const std::string& id, const std::filesystem::path& output) {
  const auto bytes = client.download(id, [&](uint64_t received, uint64_t size) {
    session.console.progress("download", formatBytes(double(received)) + " of " + formatBytes(double(size)));
  });
  writeOutput(session, output, [&] { format::writeFileAtomically(output, bytes); });
  session.console.line(output.string() + ": " + formatBytes(double(bytes.size())));
}

void requireSuccess(const v1::Job& job) {
  if (job.state() == v1::JOB_STATE_SUCCEEDED) return;
  std::string reason = "job " + job.id() + " " + (job.state() == v1::JOB_STATE_CANCELLED ? "was cancelled" : "failed");
  if (!job.error().message().empty()) reason += ": " + job.error().message();
  if (!job.error().stderr_tail().empty()) reason += "\n" + job.error().stderr_tail();
  throw server::ServiceError(job.error().id(), reason, false);
}

std::string summaryLine(const v1::Job& job) {
  std::string line = job.id() + "  " + server::name(job.state());
  line.resize(std::max<size_t>(line.size(), 28), ' ');
  line += job.spec().label().empty() ? job.spec().scene() + job.spec().environment() : job.spec().label();
  if (job.state() == v1::JOB_STATE_RUNNING || job.state() == v1::JOB_STATE_QUEUED) line += "  " + progressLine(job);
  if (job.state() == v1::JOB_STATE_SUCCEEDED) {
    line += "  " + formatBytes(double(job.result().size()));
    if (job.result().from_cache()) line += ", from the cache";
    else if (job.started_ms()) line += " in " + formatDuration(double(job.finished_ms() - job.started_ms()) / 1000);
    if (job.progress().tasks_reused()) line += ", " + std::to_string(job.progress().tasks_reused()) + " tasks reused";
  }
  if (job.state() == v1::JOB_STATE_FAILED) line += "  " + job.error().id() + ": " + job.error().message();
  return line;
}

}  // namespace lightwell::cli
