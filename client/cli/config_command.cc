// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/config_command.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "overtone/client/cli/admin_client.h"
#include "overtone/client/cli/admin_flags.h"
#include "overtone/client/cli/exit_code.h"
#include "overtone/client/cli/server_process.h"
#include "overtone/client/cli/table.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

struct ConfigFlags : AdminFlags {
  bool changed = false;
  std::string argument;
};

absl::Status Show(const ConfigFlags& flags) {
  AdminClient client = flags.Client();
  ASSIGN_OR_RETURN(const v1::GetConfigurationResponse configuration, client.GetConfiguration());
  std::vector<v1::ConfigurationValue> values;
  std::vector<std::vector<std::string>> rows = {{"key", "value", "default", "source"}};
  for (const v1::ConfigurationValue& value : configuration.values()) {
    if (flags.changed && value.value() == value.default_value()) continue;
    values.push_back(value);
    rows.push_back({value.key(), value.value(), value.default_value(), value.source()});
  }
  if (flags.json) {
    PrintJson(values);
  } else {
    std::cout << FormatTable(rows);
  }
  return absl::OkStatus();
}

// Returns only when the server's program cannot be run.
absl::Status BecomeServer(std::vector<std::string> arguments) {
  std::string program = FindServerProgram();
  std::vector<char*> argv = {program.data()};
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  std::cout.flush();
  execvp(program.c_str(), argv.data());
  return absl::UnavailableError(
      absl::StrCat(program, " knows the options, and cannot be run: ", std::strerror(errno)));
}

CLI::App* AddServerCommand(CLI::App* config, const std::string& name, const std::string& what,
                           std::shared_ptr<ConfigFlags> flags, std::function<int()>* run) {
  CLI::App* command = config->add_subcommand(name, what);
  command->callback([name, flags = std::move(flags), run] {
    *run = [name, flags] {
      std::vector<std::string> arguments = {"config", name};
      if (!flags->argument.empty()) arguments.push_back(flags->argument);
      return Fail("config " + name, BecomeServer(std::move(arguments)));
    };
  });
  return command;
}

}  // namespace

void AddConfigCommand(CLI::App* app, std::function<int()>* run) {
  CLI::App* config =
      app->add_subcommand("config", "Check, explain or show a server's configuration");
  config->require_subcommand(1);
  const auto flags = std::make_shared<ConfigFlags>();
  AddServerCommand(config, "check", "Look for mistakes in a file", flags, run)
      ->add_option("FILE", flags->argument, "YAML file, as for overtone-mapping-server --config")
      ->required();
  AddServerCommand(config, "explain", "What an option means", flags, run)
      ->add_option("KEY", flags->argument, "As in the file, or a section; without it: all");
  AddServerCommand(config, "default", "Print a file with every option, its default and its comment",
                   flags, run);
  CLI::App* show = AddAdminCommand(
      config, "show", "What is in force at a running server, and who said it",
      {/*map=*/false, /*json=*/true}, flags.get(), [flags] { return Show(*flags); }, run);
  show->add_flag("--changed", flags->changed, "Only what is not the default");
}

}  // namespace overtone
