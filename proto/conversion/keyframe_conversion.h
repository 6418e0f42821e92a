// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_PROTO_CONVERSION_KEYFRAME_CONVERSION_H_
#define OVERTONE_PROTO_CONVERSION_KEYFRAME_CONVERSION_H_

#include "absl/status/statusor.h"
#include "overtone/core/graph/submap.h"
#include "overtone/v1/submap.pb.h"

namespace overtone {

// The mission's first keyframe goes, and may come, without a covariance.
v1::Keyframe ToProto(const Keyframe& keyframe, bool first_of_mission);

// InvalidArgument naming the field, relative to the message, when a limit in submap.proto is
// broken. That stamps increase is for the submap to check.
absl::StatusOr<Keyframe> FromProto(const v1::Keyframe& message, bool first_of_mission);

}  // namespace overtone

#endif  // OVERTONE_PROTO_CONVERSION_KEYFRAME_CONVERSION_H_
