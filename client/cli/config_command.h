// SPDX-License-Identifier: Apache-2.0
// `overtone config`: the server's configuration.
#ifndef OVERTONE_CLIENT_CLI_CONFIG_COMMAND_H_
#define OVERTONE_CLIENT_CLI_CONFIG_COMMAND_H_

#include <functional>

#include "CLI/CLI.hpp"

namespace overtone {

// `show` asks a running server. `check`, `explain` and `default` become `overtone-mapping-server
// config ...` (FindServerProgram), which knows the options; the exit code is its.
void AddConfigCommand(CLI::App* app, std::function<int()>* run);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_CONFIG_COMMAND_H_
