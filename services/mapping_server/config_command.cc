// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/config_command.h"

#include <iostream>
#include <memory>
#include <string>

#include "overtone/core/common/status_macros.h"
#include "overtone/services/mapping_server/configuration.h"
#include "overtone/services/mapping_server/default_configuration.h"
#include "overtone/services/mapping_server/option_reference.h"

namespace overtone {
namespace {

// The file alone: it may be meant for another host, with another environment.
absl::Status Check(const std::string& file) {
  ConfigurationInput input;
  input.file = file;
  ASSIGN_OR_RETURN(const Configuration configuration, ReadConfiguration(input));
  const auto defaults = OptionValues(ServerOptions());
  for (const auto& [key, value] : OptionValues(configuration.options)) {
    if (value != defaults.at(key)) {
      std::cout << key << " is " << value << " instead of " << defaults.at(key) << "\n";
    }
  }
  std::cout << file << ": no mistakes\n";
  return absl::OkStatus();
}

absl::Status Explain(const std::string& name) {
  ASSIGN_OR_RETURN(const std::string explanation, ExplainOption(name));
  std::cout << explanation;
  return absl::OkStatus();
}

}  // namespace

void AddConfigCommand(CLI::App& app, std::function<absl::Status()>& run) {
  CLI::App* config = app.add_subcommand("config", "Check a configuration file, explain its keys");
  config->require_subcommand(1);
  const auto argument = std::make_shared<std::string>();

  CLI::App* check = config->add_subcommand("check", "Look for mistakes in a file");
  check->add_option("FILE", *argument, "YAML file, as for --config")->required();
  check->callback([argument, &run] { run = [argument] { return Check(*argument); }; });

  CLI::App* explain = config->add_subcommand("explain", "What an option means");
  explain->add_option("KEY", *argument, "As in the file, or a section; without it: all");
  explain->callback([argument, &run] { run = [argument] { return Explain(*argument); }; });

  const auto print = [&run](absl::string_view text) {
    run = [text = std::string(text)] {
      std::cout << text;
      return absl::OkStatus();
    };
  };
  config->add_subcommand("default", "Print a file with every option, its default and its comment")
      ->callback([print] { print(DefaultConfiguration()); });
  config->add_subcommand("reference", "Print docs/configuration.md")->callback([print] {
    print(ConfigurationReference());
  });
}

}  // namespace overtone
