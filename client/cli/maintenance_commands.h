// SPDX-License-Identifier: Apache-2.0
// `overtone backup`, `restore`, `verify` and `delete`: what a server has stored, as a whole.
#ifndef OVERTONE_CLIENT_CLI_MAINTENANCE_COMMANDS_H_
#define OVERTONE_CLIENT_CLI_MAINTENANCE_COMMANDS_H_

#include <functional>
#include <istream>
#include <ostream>
#include <string>

#include "CLI/CLI.hpp"
#include "absl/status/status.h"

namespace overtone {

// `run` receives what to do when one of the subcommands was chosen; it returns the exit code.
void AddMaintenanceCommands(CLI::App* app, std::function<int()>* run);

// Asks whether `what` shall go. `in`: null where nobody can be asked, which is InvalidArgument.
// Cancelled: anything but yes.
absl::Status ConfirmDeletion(const std::string& what, std::istream* in, std::ostream* out);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_MAINTENANCE_COMMANDS_H_
