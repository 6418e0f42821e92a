// SPDX-License-Identifier: Apache-2.0
// `overtone closures`, `veto`, `force`, `revisions` and `rollback`.
#ifndef OVERTONE_CLIENT_CLI_CLOSURE_COMMANDS_H_
#define OVERTONE_CLIENT_CLI_CLOSURE_COMMANDS_H_

#include <functional>

#include "CLI/CLI.hpp"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "overtone/core/common/ids.h"

namespace overtone {

void AddClosureCommands(CLI::App* app, std::function<int()>* run);

// "robot/mission" and "robot/mission:index". InvalidArgument saying what was expected.
absl::StatusOr<MissionId> ParseMissionId(absl::string_view text);
absl::StatusOr<NodeId> ParseNodeId(absl::string_view text);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_CLOSURE_COMMANDS_H_
