// SPDX-License-Identifier: Apache-2.0
// `overtone health`: for containers' health checks and for scripts.
#ifndef OVERTONE_CLIENT_CLI_HEALTH_COMMAND_H_
#define OVERTONE_CLIENT_CLI_HEALTH_COMMAND_H_

#include <functional>

#include "CLI/CLI.hpp"

namespace overtone {

// `run` receives what to do when the subcommand was chosen; it returns 0 or 1.
void AddHealthCommand(CLI::App* app, std::function<int()>* run);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_HEALTH_COMMAND_H_
