// SPDX-License-Identifier: Apache-2.0
// `overtone status`, `robots` and `missions`: what a server holds.
#ifndef OVERTONE_CLIENT_CLI_ADMIN_COMMANDS_H_
#define OVERTONE_CLIENT_CLI_ADMIN_COMMANDS_H_

#include <functional>

#include "CLI/CLI.hpp"

namespace overtone {

// `run` receives what to do when one of the subcommands was chosen; it returns the exit code.
void AddAdminCommands(CLI::App* app, std::function<int()>* run);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_ADMIN_COMMANDS_H_
