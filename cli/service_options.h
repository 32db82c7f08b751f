// What submit, jobs, watch, fetch and cancel share: how to reach the server, and how a job looks on a terminal.
#pragma once
#include <CLI/CLI.hpp>

#include "cli/command.h"
#include "server/client/client.h"

namespace lightwell::cli {

struct ServiceOptions {
  server::ClientOptions client;
  bool json = false;
};

/// --server (or the environment variable LIGHTWELL_SERVER), --token-file, --tls-….
void addServiceOptions(CLI::App& command, ServiceOptions& options);

/// A connection that says on the terminal when it waits for the server. `session` must outlive it.
server::Client connect(Session& session, const ServiceOptions& options);

/// Shows a job's progress until it ends; warnings once each. On Ctrl-C says how to come back, and throws Cancelled.
v1::Job watchJob(Session& session, server::Client& client, const ServiceOptions& options, const std::string& id);

/// Downloads a finished job's container into `output`.
void fetchResult(Session& session, server::Client& client, const std::string& id, const std::filesystem::path& output);

/// Throws ServiceError unless the job succeeded.
void requireSuccess(const v1::Job& job);

/// One line for people.
std::string summaryLine(const v1::Job& job);

}  // namespace lightwell::cli
