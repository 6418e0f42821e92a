// SPDX-License-Identifier: Apache-2.0
// `overtone-mapping-server config check | explain | default | reference`.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_CONFIG_COMMAND_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_CONFIG_COMMAND_H_

#include <functional>

#include "CLI/CLI.hpp"
#include "absl/status/status.h"

namespace overtone {

// `run` is set when the command was given. Its InvalidArgument and NotFound are the user's
// mistakes.
void AddConfigCommand(CLI::App& app, std::function<absl::Status()>& run);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_CONFIG_COMMAND_H_
