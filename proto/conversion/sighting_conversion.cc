// SPDX-License-Identifier: Apache-2.0
#include "overtone/proto/conversion/sighting_conversion.h"

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/field_path.h"
#include "overtone/proto/conversion/geometry_conversion.h"
#include "overtone/proto/conversion/id_conversion.h"
#include "overtone/proto/conversion/limits.h"

namespace overtone {
namespace {

// LandmarkSighting and RobotSighting say where and how well alike.
template <typename Sighting, typename Message>
void WritePoint(const Sighting& sighting, Message& message) {
  message.set_index(sighting.index);
  *message.mutable_point_in_body() = ToProto(sighting.point_in_body);
  *message.mutable_covariance() = ToProto(sighting.covariance);
}

template <typename Sighting, typename Message>
absl::Status ReadPoint(const Message& message, Sighting& sighting) {
  sighting.index = message.index();
  if (!message.has_point_in_body()) return InvalidField("point_in_body", "missing");
  ASSIGN_OR_RETURN(sighting.point_in_body,
                   AtField("point_in_body", FromProto(message.point_in_body())));
  ASSIGN_OR_RETURN(sighting.covariance, AtField("covariance", FromProto(message.covariance())));
  return absl::OkStatus();
}

}  // namespace

v1::ScoredCandidate ToProto(const ScoredCandidate& candidate) {
  v1::ScoredCandidate message;
  *message.mutable_from() = ToProto(candidate.from);
  *message.mutable_to() = ToProto(candidate.to);
  message.set_score(candidate.score);
  return message;
}

v1::CloudReference ToProto(const KeyframeCloud& cloud) {
  v1::CloudReference message;
  message.set_index(cloud.index);
  message.set_sha256(cloud.sha256);
  message.set_encoded_bytes(cloud.encoded_bytes);
  return message;
}

v1::LandmarkSighting ToProto(const LandmarkSighting& sighting) {
  v1::LandmarkSighting message;
  message.set_landmark(sighting.landmark);
  WritePoint(sighting, message);
  return message;
}

v1::RobotSighting ToProto(const RobotSighting& sighting) {
  v1::RobotSighting message;
  message.set_robot(sighting.robot);
  WritePoint(sighting, message);
  return message;
}

v1::AbsolutePose ToProto(const AbsolutePose& pose) {
  v1::AbsolutePose message;
  message.set_index(pose.index);
  *message.mutable_map_tform_body() = ToProto(pose.map_from_body);
  *message.mutable_covariance() = ToProto(pose.covariance);
  return message;
}

absl::StatusOr<ScoredCandidate> FromProto(const v1::ScoredCandidate& message) {
  ScoredCandidate candidate;
  ASSIGN_OR_RETURN(candidate.from, AtField("from", FromProto(message.from())));
  ASSIGN_OR_RETURN(candidate.to, AtField("to", FromProto(message.to())));
  if (candidate.from == candidate.to) {
    return InvalidField("to", absl::StrCat("the same keyframe as from, ", ToString(candidate.to)));
  }
  candidate.score = message.score();
  if (!(candidate.score >= 0 && candidate.score <= 1)) {  // NaN, too
    return InvalidField("score", absl::StrCat(candidate.score, " is not in [0, 1]"));
  }
  return candidate;
}

absl::StatusOr<KeyframeCloud> FromProto(const v1::CloudReference& message) {
  KeyframeCloud cloud;
  cloud.index = message.index();
  cloud.sha256 = message.sha256();
  cloud.encoded_bytes = message.encoded_bytes();
  if (cloud.sha256.size() != limits::kSha256Bytes) {
    return InvalidField("sha256", absl::StrCat(cloud.sha256.size(), " bytes, not 32"));
  }
  if (cloud.encoded_bytes < 1 || cloud.encoded_bytes > limits::kMaxBlobBytes) {
    return InvalidField("encoded_bytes",
                        absl::StrCat(cloud.encoded_bytes, " is not in [1, 16 MiB]"));
  }
  return cloud;
}

absl::StatusOr<LandmarkSighting> FromProto(const v1::LandmarkSighting& message) {
  LandmarkSighting sighting;
  RETURN_IF_ERROR(ValidateId(message.landmark(), "landmark"));
  sighting.landmark = message.landmark();
  RETURN_IF_ERROR(ReadPoint(message, sighting));
  return sighting;
}

absl::StatusOr<RobotSighting> FromProto(const v1::RobotSighting& message) {
  RobotSighting sighting;
  RETURN_IF_ERROR(ValidateId(message.robot(), "robot"));
  sighting.robot = message.robot();
  RETURN_IF_ERROR(ReadPoint(message, sighting));
  return sighting;
}

absl::StatusOr<AbsolutePose> FromProto(const v1::AbsolutePose& message) {
  AbsolutePose pose;
  pose.index = message.index();
  ASSIGN_OR_RETURN(pose.map_from_body,
                   AtField("map_tform_body", FromProto(message.map_tform_body())));
  ASSIGN_OR_RETURN(pose.covariance, AtField("covariance", FromProto(message.covariance())));
  return pose;
}

}  // namespace overtone
