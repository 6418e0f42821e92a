// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/tuc_recording.h"

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "overtone/client/cli/text_rows.h"
#include "overtone/client/cli/velocity_odometry.h"
#include "overtone/core/common/parse_number.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/geometry/parse_pose.h"

namespace overtone {
namespace {

constexpr char kInputSuffix[] = "_Input.txt";

struct Candidate {
  Timestamp from;
  Timestamp to;
  double score = 0;
};

struct Input {
  std::vector<PlanarVelocity> velocities;
  std::vector<Eigen::Vector3d> variances;  // of each: ahead, left, turn rate
  std::vector<Candidate> candidates;
};

// The path without its suffix.
absl::StatusOr<std::string> FindInput(const std::string& folder) {
  std::vector<std::string> found;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string path = entry->path().string();
    if (absl::EndsWith(path, kInputSuffix)) found.push_back(path);
  }
  if (found.size() == 1) return std::string(absl::StripSuffix(found[0], kInputSuffix));
  return absl::NotFoundError(
      absl::StrCat(folder, ": ", found.size(), " files *", kInputSuffix, " where one is expected"));
}

absl::Status ParseOdometry(Fields fields, Input* input) {
  RETURN_IF_ERROR(ExpectFields(fields, 8));
  PlanarVelocity row;
  ASSIGN_OR_RETURN(row.stamp, ParseSeconds(fields[1]));
  Vector6d v;
  RETURN_IF_ERROR(ParseFiniteDoubles(fields.subspan(2), absl::MakeSpan(v.data(), 6)));
  row.ahead_m_per_s = v[0];
  row.left_m_per_s = v[1];
  row.turn_rad_per_s = v[2];
  if (!(v.tail<3>().minCoeff() > 0)) return absl::InvalidArgumentError("a variance is not > 0");
  RETURN_IF_ERROR(AppendVelocity(row, &input->velocities));
  input->variances.resize(input->velocities.size());
  input->variances.back() = v.tail<3>();
  return absl::OkStatus();
}

absl::Status ParseCandidate(Fields fields, double min_score, Input* input) {
  RETURN_IF_ERROR(ExpectFields(fields, 4));
  Candidate candidate;
  ASSIGN_OR_RETURN(candidate.from, ParseSeconds(fields[1]));
  ASSIGN_OR_RETURN(candidate.to, ParseSeconds(fields[2]));
  ASSIGN_OR_RETURN(candidate.score, ParseFiniteDouble(fields[3]));
  if (!(candidate.score >= 0 && candidate.score <= 1)) {
    return absl::InvalidArgumentError("a score must be in [0, 1]");
  }
  if (candidate.score >= min_score) input->candidates.push_back(candidate);
  return absl::OkStatus();
}

absl::StatusOr<Input> ReadInput(const std::string& path, double min_score) {
  Input input;
  RETURN_IF_ERROR(ForEachRow(path, [&](Fields fields) -> absl::Status {
    if (fields[0] == "odom2") return ParseOdometry(fields, &input);
    if (fields[0] == "loop") return ParseCandidate(fields, min_score, &input);
    return absl::OkStatus();
  }));
  if (input.velocities.empty()) return absl::InvalidArgumentError(absl::StrCat(path, ": no odom2"));
  return input;
}

// What a velocity's error does to the motion that it makes. Off the plane the robot is no better
// known than in it.
Matrix6d MotionCovarianceOf(const Eigen::Vector3d& variances, double duration_s) {
  Vector6d diagonal;
  diagonal << variances[0], variances[1], variances[1], variances[2], variances[2], variances[2];
  return Matrix6d((diagonal * duration_s * duration_s).asDiagonal());
}

int64_t NearestFrame(const std::vector<PlanarVelocity>& velocities, Timestamp stamp) {
  const auto after = std::lower_bound(
      velocities.begin(), velocities.end(), stamp,
      [](const PlanarVelocity& velocity, Timestamp time) { return velocity.stamp < time; });
  if (after == velocities.begin()) return 0;
  if (after == velocities.end()) return static_cast<int64_t>(velocities.size()) - 1;
  const bool earlier =
      SecondsBetween((after - 1)->stamp, stamp) <= SecondsBetween(stamp, after->stamp);
  return (after - velocities.begin()) - (earlier ? 1 : 0);
}

absl::StatusOr<Trajectory> ReadPositions(const std::string& path) {
  Trajectory positions;
  RETURN_IF_ERROR(ForEachRow(path, [&positions](Fields fields) -> absl::Status {
    if (fields[0] != "point2") return absl::OkStatus();
    if (fields.size() < 4) return ExpectFields(fields, 4);
    StampedPose row;
    ASSIGN_OR_RETURN(row.stamp, ParseSeconds(fields[1]));
    const absl::string_view planar[] = {fields[2], fields[3], "0"};
    ASSIGN_OR_RETURN(row.pose, ParsePlanarPose(planar));
    if (!positions.empty() && row.stamp < positions.back().stamp) {
      return absl::InvalidArgumentError("the time runs back");
    }
    if (positions.empty() || positions.back().stamp < row.stamp) positions.push_back(row);
    return absl::OkStatus();
  }));
  return positions;
}

}  // namespace

absl::StatusOr<Recording> ReadTucRecording(const std::string& folder, double min_candidate_score) {
  ASSIGN_OR_RETURN(const std::string prefix, FindInput(folder));
  ASSIGN_OR_RETURN(const Input input, ReadInput(prefix + kInputSuffix, min_candidate_score));
  Recording recording;
  recording.name = std::filesystem::path(prefix).filename().string();
  ASSIGN_OR_RETURN(recording.id, MissionOf(recording.name));
  ASSIGN_OR_RETURN(recording.odometry, IntegrateVelocities(input.velocities, {}));
  recording.frames.resize(recording.odometry.size());
  std::iota(recording.frames.begin(), recording.frames.end(), 0);
  recording.motion_covariances.push_back(Matrix6d::Identity());
  for (size_t i = 1; i < input.velocities.size(); ++i) {
    recording.motion_covariances.push_back(MotionCovarianceOf(
        input.variances[i - 1],
        SecondsBetween(input.velocities[i - 1].stamp, input.velocities[i].stamp)));
  }
  for (const Candidate& candidate : input.candidates) {
    recording.candidates.push_back({NearestFrame(input.velocities, candidate.from),
                                    NearestFrame(input.velocities, candidate.to), candidate.score});
  }
  std::error_code error;
  if (std::filesystem::exists(prefix + "_GT.txt", error)) {
    ASSIGN_OR_RETURN(recording.ground_truth, ReadPositions(prefix + "_GT.txt"));
    recording.ground_truth_positions_only = true;
    recording.common_from_world = Rigid3d::Identity();
  }
  return recording;
}

}  // namespace overtone
