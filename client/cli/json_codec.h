// SPDX-License-Identifier: Apache-2.0
// The project's types as JSON, for what the command's own processes tell each other and for
// metrics.json.
#ifndef OVERTONE_CLIENT_CLI_JSON_CODEC_H_
#define OVERTONE_CLIENT_CLI_JSON_CODEC_H_

#include <cstdint>
#include <functional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "nlohmann/json.hpp"
#include "overtone/client/cli/run_result.h"
#include "overtone/core/graph/submap.h"

namespace overtone {

using Json = nlohmann::json;

Json ToJson(const NodeId& id);            // [robot, mission, index]
Json ToJson(const Rigid3d& pose);         // [x, y, z, qx, qy, qz, qw]
Json ToJson(const Matrix6d& covariance);  // upper triangle, 21 numbers
Json ToJson(const Keyframe& keyframe);
Json ToJson(const LoopClosure& closure);
Json ToJson(const Constraint& constraint);
Json ToJson(const ConstraintRecord& record);

// These throw nlohmann::json::exception or std::exception for what does not fit: call them inside
// Decode.
int64_t IntegerFromJson(const Json& json);  // not 1.5, 1e50, 2^63 or true
NodeId NodeIdFromJson(const Json& json);
Rigid3d PoseFromJson(const Json& json);
Matrix6d CovarianceFromJson(const Json& json);
Keyframe KeyframeFromJson(const Json& json);
LoopClosure LoopClosureFromJson(const Json& json);
Constraint ConstraintFromJson(const Json& json);
ConstraintRecord ConstraintRecordFromJson(const Json& json);

// Parses `text` and runs `decode` on it. InvalidArgument, naming `source`, when either throws.
absl::Status Decode(const std::string& text, const std::string& source,
                    const std::function<void(const Json&)>& decode);

absl::string_view ToString(ConstraintAction action);  // "add", "update", "retract"

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_JSON_CODEC_H_
