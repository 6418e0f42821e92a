// SPDX-License-Identifier: Apache-2.0
// `overtone certs`: certificates for development.
#ifndef OVERTONE_CLIENT_CLI_CERTS_COMMAND_H_
#define OVERTONE_CLIENT_CLI_CERTS_COMMAND_H_

#include <functional>

#include "CLI/CLI.hpp"

namespace overtone {

void AddCertsCommand(CLI::App* app, std::function<int()>* run);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_CERTS_COMMAND_H_
