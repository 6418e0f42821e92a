// SPDX-License-Identifier: Apache-2.0
// Shell completion out of the command tree itself, so that no flag is ever missing in it.
#ifndef OVERTONE_CLIENT_CLI_COMPLETION_H_
#define OVERTONE_CLIENT_CLI_COMPLETION_H_

#include <string>
#include <vector>

#include "CLI/CLI.hpp"

namespace overtone {

struct CompletedOption {
  std::vector<std::string> names;  // "--server", "-h"; none: a positional argument
  std::string description;
  bool takes_value = false;
  bool takes_file = false;           // a path
  std::vector<std::string> choices;  // what the value may be; empty: anything
};

struct CompletedCommand {
  std::vector<std::string> path;  // {}: the program itself; {"export"}; {"config", "check"}
  std::string description;
  std::vector<CompletedOption> options;
  std::vector<CompletedCommand> commands;
};

CompletedCommand Describe(const CLI::App& app);

// Scripts for the program `root`, whose name is `program`.
std::string BashCompletion(const CompletedCommand& root, const std::string& program);
std::string ZshCompletion(const CompletedCommand& root, const std::string& program);
std::string FishCompletion(const CompletedCommand& root, const std::string& program);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_COMPLETION_H_
