// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_PROTO_CONVERSION_SUBMAP_CONVERSION_H_
#define OVERTONE_PROTO_CONVERSION_SUBMAP_CONVERSION_H_

#include "absl/status/statusor.h"
#include "overtone/core/graph/submap.h"
#include "overtone/v1/submap.pb.h"

namespace overtone {

v1::LoopClosure ToProto(const LoopClosure& closure);
// The mission's first keyframe goes without a covariance, and clouds without their points.
v1::Submap ToProto(const Submap& submap);

// InvalidArgument naming the field, relative to the message, when a limit in submap.proto is
// broken.
absl::StatusOr<LoopClosure> FromProto(const v1::LoopClosure& message);
// All that can be checked without knowing the mission's earlier submaps. FromProto(ToProto(submap),
// mission) is therefore also how a client checks a submap before it sends it.
absl::StatusOr<Submap> FromProto(const v1::Submap& message, const MissionId& mission);

}  // namespace overtone

#endif  // OVERTONE_PROTO_CONVERSION_SUBMAP_CONVERSION_H_
