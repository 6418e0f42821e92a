// SPDX-License-Identifier: Apache-2.0
// `overtone simulate`.
#ifndef OVERTONE_CLIENT_CLI_SIMULATE_COMMAND_H_
#define OVERTONE_CLIENT_CLI_SIMULATE_COMMAND_H_

#include <functional>

#include "CLI/CLI.hpp"

namespace overtone {

// `run` receives what to do when the subcommand was chosen; it returns the exit code.
void AddSimulateCommand(CLI::App* app, std::function<int()>* run);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_SIMULATE_COMMAND_H_
