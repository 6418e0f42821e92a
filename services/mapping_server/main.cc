// SPDX-License-Identifier: Apache-2.0
// The binary: flags over file over defaults, and the signals that end it.
#include <csignal>
#include <cstdlib>
#include <exception>
#include <functional>
#include <iostream>
#include <map>
#include <memory>
#include <string>

#include "CLI/CLI.hpp"
#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/services/mapping_server/log_format.h"
#include "overtone/services/mapping_server/mapping_server.h"
#include "overtone/services/mapping_server/options_file.h"
#include "spdlog/sinks/stdout_color_sinks.h"
#include "spdlog/spdlog.h"

namespace overtone {
namespace {

// Blocked before any thread starts, so that only Wait() ever takes them.
class TerminationSignals {
 public:
  TerminationSignals() {
    sigemptyset(&signals_);
    sigaddset(&signals_, SIGINT);
    sigaddset(&signals_, SIGTERM);
    sigaddset(&signals_, SIGHUP);
    pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
  }

  // Until the end is asked for. SIGHUP only calls `reload`.
  void Wait(const std::function<void()>& reload) const {
    int signal = 0;
    while (sigwait(&signals_, &signal) == 0 && signal == SIGHUP) reload();
  }

 private:
  sigset_t signals_;
};

struct Flags {
  std::string config;
  std::string listen;
  std::string data_dir;
  std::string log_level;
  std::string log_format;
  bool insecure = false;
};

void Declare(CLI::App& app, Flags& flags) {
  app.set_version_flag("--version", OVERTONE_VERSION);
  app.add_option("--config", flags.config, "YAML file; configs/default.yaml lists the keys");
  app.add_option("--listen", flags.listen, "host:port; port 0 takes a free one");
  app.add_option("--data-dir", flags.data_dir,
                 "where maps are kept over restarts; :memory: keeps them as long as the process");
  app.add_flag("--insecure", flags.insecure,
               "Serve without certificates where other hosts can reach us; they may do everything");
  app.add_option("--log-level", flags.log_level,
                 "trace, debug, info, warning, error, critical or off");
  app.add_option("--log-format", flags.log_format, "text, or json: one object a line");
}

absl::StatusOr<ServerOptions> ReadOptions(const Flags& flags) {
  ServerOptions options;
  if (!flags.config.empty()) RETURN_IF_ERROR(ReadOptionsFile(flags.config, options));
  if (!flags.listen.empty()) options.listen = flags.listen;
  if (!flags.data_dir.empty()) options.data_dir = flags.data_dir;
  if (flags.insecure) options.security.insecure = true;
  if (!flags.log_level.empty()) options.log_level = flags.log_level;
  if (!flags.log_format.empty()) options.log_format = flags.log_format;
  RETURN_IF_ERROR(options.Validate());
  return options;
}

// What differs from the defaults, whoever said it.
void LogOptions(const ServerOptions& options) {
  const std::map<std::string, std::string> defaults = OptionValues(ServerOptions());
  for (const auto& [key, value] : OptionValues(options)) {
    if (value != defaults.at(key)) {
      spdlog::info("{} is {} instead of {}", key, value, defaults.at(key));
    }
  }
}

absl::Status Serve(const Flags& flags) {
  ASSIGN_OR_RETURN(const ServerOptions options, ReadOptions(flags));
  spdlog::set_default_logger(spdlog::stderr_color_mt("mapping_server"));
  spdlog::set_formatter(LogLines(options.log_format));
  spdlog::set_level(spdlog::level::from_str(options.log_level));
  LogOptions(options);

  const TerminationSignals signals;
  ASSIGN_OR_RETURN(const std::unique_ptr<MappingServer> server, MappingServer::Start(options));
  // Who started us reads the port from this line.
  std::cout << "listening on " << server->address() << std::endl;
  signals.Wait([&server] { server->ReloadSecurity(); });
  server->Shutdown(absl::Seconds(options.shutdown_s));
  return absl::OkStatus();
}

}  // namespace
}  // namespace overtone

int main(int argc, char** argv) {
  try {
    CLI::App app("Overtone's mapping server");
    overtone::Flags flags;
    overtone::Declare(app, flags);
    CLI11_PARSE(app, argc, argv);
    const absl::Status status = overtone::Serve(flags);
    if (status.ok()) return EXIT_SUCCESS;
    std::cerr << "overtone-mapping-server: " << status.message() << std::endl;
  } catch (const std::exception& error) {
    std::cerr << "overtone-mapping-server: " << error.what() << std::endl;
  }
  return EXIT_FAILURE;
}
