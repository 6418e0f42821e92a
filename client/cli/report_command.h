// SPDX-License-Identifier: Apache-2.0
// `overtone report`: a server's map as one page that opens offline.
#ifndef OVERTONE_CLIENT_CLI_REPORT_COMMAND_H_
#define OVERTONE_CLIENT_CLI_REPORT_COMMAND_H_

#include <functional>

#include "CLI/CLI.hpp"

namespace overtone {

// `run` receives what to do when the subcommand was chosen; it returns the exit code.
void AddReportCommand(CLI::App* app, std::function<int()>* run);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_REPORT_COMMAND_H_
