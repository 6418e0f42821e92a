// SPDX-License-Identifier: Apache-2.0
// `overtone completion`: a script for the shell.
#ifndef OVERTONE_CLIENT_CLI_COMPLETION_COMMAND_H_
#define OVERTONE_CLIENT_CLI_COMPLETION_COMMAND_H_

#include <functional>

#include "CLI/CLI.hpp"

namespace overtone {

// `run` receives what to do when the subcommand was chosen; it returns the exit code. The script
// holds what `app` has when it runs.
void AddCompletionCommand(CLI::App* app, std::function<int()>* run);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_COMPLETION_COMMAND_H_
