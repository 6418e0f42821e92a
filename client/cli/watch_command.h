// SPDX-License-Identifier: Apache-2.0
// `overtone watch`: a server's maps and robots, live.
#ifndef OVERTONE_CLIENT_CLI_WATCH_COMMAND_H_
#define OVERTONE_CLIENT_CLI_WATCH_COMMAND_H_

#include <functional>

#include "CLI/CLI.hpp"

namespace overtone {

// `run` receives what to do when the subcommand was chosen; it returns the exit code.
void AddWatchCommand(CLI::App* app, std::function<int()>* run);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_WATCH_COMMAND_H_
