// SPDX-License-Identifier: Apache-2.0
// What a submap carries beside keyframes and loop closures: clouds by reference, sightings,
// absolute poses, candidates. Each by itself; what ties it to its submap (indices, missions) is
// checked in submap_conversion.
#ifndef OVERTONE_PROTO_CONVERSION_SIGHTING_CONVERSION_H_
#define OVERTONE_PROTO_CONVERSION_SIGHTING_CONVERSION_H_

#include "absl/status/statusor.h"
#include "overtone/core/graph/submap.h"
#include "overtone/v1/submap.pb.h"

namespace overtone {

v1::ScoredCandidate ToProto(const ScoredCandidate& candidate);
v1::CloudReference ToProto(const KeyframeCloud& cloud);  // its points stay behind
v1::LandmarkSighting ToProto(const LandmarkSighting& sighting);
v1::RobotSighting ToProto(const RobotSighting& sighting);
v1::AbsolutePose ToProto(const AbsolutePose& pose);

// InvalidArgument naming the field, relative to the message, when a limit in submap.proto is
// broken.
absl::StatusOr<ScoredCandidate> FromProto(const v1::ScoredCandidate& message);
absl::StatusOr<KeyframeCloud> FromProto(const v1::CloudReference& message);
absl::StatusOr<LandmarkSighting> FromProto(const v1::LandmarkSighting& message);
absl::StatusOr<RobotSighting> FromProto(const v1::RobotSighting& message);
absl::StatusOr<AbsolutePose> FromProto(const v1::AbsolutePose& message);

}  // namespace overtone

#endif  // OVERTONE_PROTO_CONVERSION_SIGHTING_CONVERSION_H_
