// SPDX-License-Identifier: Apache-2.0
// The binary: flags over environment over file over defaults, and the signals that end it.
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
#include "overtone/services/mapping_server/config_command.h"
#include "overtone/services/mapping_server/configuration.h"
#include "overtone/services/mapping_server/log_format.h"
#include "overtone/services/mapping_server/mapping_server.h"
#include "overtone/services/mapping_server/options_environment.h"
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

// The options that matter most, by key.
void Declare(CLI::App& app, ConfigurationInput& input) {
  app.set_version_flag("--version", OVERTONE_VERSION);
  app.add_option("--config", input.file, "YAML file; `config default` prints one")
      ->envname("OVERTONE_CONFIG");
  const auto flag = [&](const char* name, const char* key, const char* what) {
    app.add_option_function<std::string>(
        name, [&input, key](const std::string& value) { input.flags[key] = value; }, what);
  };
  flag("--listen", "listen", "host:port; port 0 takes a free one");
  flag("--data-dir", "data_dir",
       "Where maps are kept over restarts; :memory: keeps them as long as the process");
  flag("--log-level", "log_level", "trace, debug, info, warning, error, critical or off");
  flag("--log-format", "log_format", "text, or json: one object a line");
  app.add_flag_callback(
      "--insecure", [&input] { input.flags["insecure"] = "true"; },
      "Serve without certificates where other hosts can reach us; they may do everything");
}

// What differs from the defaults, and who said it.
void LogConfiguration(const Configuration& configuration) {
  const std::map<std::string, std::string> values = OptionValues(configuration.options);
  const std::map<std::string, std::string> defaults = OptionValues(ServerOptions());
  for (const auto& [key, source] : configuration.sources) {
    if (values.at(key) == defaults.at(key)) continue;
    spdlog::info("{} is {} instead of {} ({})", key, values.at(key), defaults.at(key),
                 source.place);
  }
}

absl::Status Serve(ConfigurationInput input) {
  input.environment = Environment();
  ASSIGN_OR_RETURN(const Configuration configuration, ReadConfiguration(input));
  const ServerOptions& options = configuration.options;
  spdlog::set_default_logger(spdlog::stderr_color_mt("mapping_server"));
  spdlog::set_formatter(LogLines(options.log_format));
  spdlog::set_level(spdlog::level::from_str(options.log_level));
  LogConfiguration(configuration);

  const TerminationSignals signals;
  ASSIGN_OR_RETURN(const std::unique_ptr<MappingServer> server,
                   MappingServer::Start(options, configuration.sources));
  // Who started us reads the port from this line.
  std::cout << "listening on " << server->address() << std::endl;
  signals.Wait([&server] { server->ReloadSecurity(); });
  server->Shutdown(absl::Seconds(options.shutdown_s));
  return absl::OkStatus();
}

// 2: what we were given is wrong.
int ExitCode(const absl::Status& status) {
  return absl::IsInvalidArgument(status) || absl::IsNotFound(status) ? 2 : EXIT_FAILURE;
}

}  // namespace
}  // namespace overtone

int main(int argc, char** argv) {
  try {
    CLI::App app("Overtone's mapping server", "overtone-mapping-server");
    overtone::ConfigurationInput input;
    overtone::Declare(app, input);
    std::function<absl::Status()> run = [&input] { return overtone::Serve(input); };
    overtone::AddConfigCommand(app, run);
    CLI11_PARSE(app, argc, argv);
    const absl::Status status = run();
    if (status.ok()) return EXIT_SUCCESS;
    std::cerr << "overtone-mapping-server: " << status.message() << std::endl;
    return overtone::ExitCode(status);
  } catch (const std::exception& error) {
    std::cerr << "overtone-mapping-server: " << error.what() << std::endl;
  }
  return EXIT_FAILURE;
}
