// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/completion.h"

#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"

namespace overtone {
namespace {

// CLI11 tells of its checks in the type's name: "TEXT:{tum,g2o}", "TEXT:FILE".
std::vector<std::string> ChoicesIn(const std::string& type) {
  const size_t begin = type.find('{'), end = type.rfind('}');
  if (begin == std::string::npos || end == std::string::npos || end < begin) return {};
  return absl::StrSplit(type.substr(begin + 1, end - begin - 1), ',', absl::SkipEmpty());
}

CompletedOption Describe(const CLI::Option& option) {
  CompletedOption described;
  for (const std::string& name : option.get_lnames()) described.names.push_back("--" + name);
  for (const std::string& name : option.get_snames()) described.names.push_back("-" + name);
  described.description = option.get_description();
  described.takes_value = option.get_items_expected_max() > 0;
  const std::string type = option.get_type_name();
  described.choices = ChoicesIn(type);
  for (const char* word : {"FILE", "PATH", "DIR"}) {
    described.takes_file = described.takes_file || absl::StrContains(type, word);
  }
  return described;
}

CompletedCommand Describe(const CLI::App& app, std::vector<std::string> path) {
  CompletedCommand command;
  command.path = path;
  command.description = app.get_description();
  for (const CLI::Option* option : app.get_options()) {
    command.options.push_back(Describe(*option));
  }
  for (const CLI::App* child : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (child->get_name().empty()) continue;
    std::vector<std::string> below = path;
    below.push_back(child->get_name());
    command.commands.push_back(Describe(*child, std::move(below)));
  }
  return command;
}

}  // namespace

CompletedCommand Describe(const CLI::App& app) { return Describe(app, {}); }

}  // namespace overtone
