// SPDX-License-Identifier: Apache-2.0
// The server's words about loop closures, as the command line prints them.
#ifndef OVERTONE_CLIENT_CLI_CLOSURE_NAMES_H_
#define OVERTONE_CLIENT_CLI_CLOSURE_NAMES_H_

#include <string>

#include "overtone/v1/map_admin_service.pb.h"

namespace overtone {

// "accepted", "demoted_by_optimiser", "rejected_overlap", ...: the enum's own names. "unspecified"
// also for what a newer server may say.
std::string VerdictName(v1::LoopClosureVerdict verdict);

// "robot", "robot_score", "scan_context", "unspecified".
std::string ProposerName(v1::LoopClosureProposer proposer);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_CLOSURE_NAMES_H_
