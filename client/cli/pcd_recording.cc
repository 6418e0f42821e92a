// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/pcd_recording.h"

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "overtone/client/cli/text_rows.h"
#include "overtone/core/common/parse_number.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/geometry/trajectory_io.h"

namespace overtone {
namespace {

constexpr char kOdometry[] = "odom_poses.txt";

absl::StatusOr<std::vector<Timestamp>> ReadTimes(const std::string& path) {
  std::vector<Timestamp> times;
  RETURN_IF_ERROR(ForEachRow(path, [&times](Fields fields) -> absl::Status {
    RETURN_IF_ERROR(ExpectFields(fields, 1));
    ASSIGN_OR_RETURN(const Timestamp time, ParseSeconds(fields[0]));
    if (!times.empty() && time <= times.back()) {
      return absl::InvalidArgumentError("the time does not increase");
    }
    times.push_back(time);
    return absl::OkStatus();
  }));
  return times;
}

absl::StatusOr<Trajectory> ReadPoses(const std::string& path, const std::vector<Timestamp>& times) {
  ASSIGN_OR_RETURN(Trajectory trajectory, ReadTrajectory(path, TrajectoryFormat::kKitti));
  if (trajectory.size() != times.size()) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": ", trajectory.size(), " poses for ",
                                                   times.size(), " rows of times.txt"));
  }
  for (size_t i = 0; i < times.size(); ++i) trajectory[i].stamp = times[i];
  return trajectory;
}

absl::Status ReadDegenerate(const std::string& path, Recording* recording) {
  return ForEachRow(path, [recording](Fields fields) -> absl::Status {
    RETURN_IF_ERROR(ExpectFields(fields, 4));
    ASSIGN_OR_RETURN(const int64_t frame, ParseNonNegativeInteger(fields[0]));
    if (frame >= static_cast<int64_t>(recording->frames.size())) {
      return absl::InvalidArgumentError(absl::StrCat("there is no pose ", frame));
    }
    Eigen::Vector3d direction;
    RETURN_IF_ERROR(ParseFiniteDoubles(fields.subspan(1), absl::MakeSpan(direction.data(), 3)));
    // stableNormalized keeps zero as it is: any direction.
    recording->degenerate[frame] = direction.stableNormalized();
    return absl::OkStatus();
  });
}

absl::StatusOr<Recording> ReadRobot(const std::filesystem::path& folder) {
  std::error_code error;
  Recording recording;
  recording.name = folder.filename().string();
  ASSIGN_OR_RETURN(recording.id, MissionOf(recording.name));
  ASSIGN_OR_RETURN(const std::vector<Timestamp> times, ReadTimes(folder / "times.txt"));
  ASSIGN_OR_RETURN(recording.odometry, ReadPoses(folder / kOdometry, times));
  recording.frames.resize(times.size());
  std::iota(recording.frames.begin(), recording.frames.end(), 0);
  for (const int64_t frame : recording.frames) {
    const std::filesystem::path scan = folder / "Scans" / absl::StrFormat("%06d.pcd", frame);
    if (!std::filesystem::exists(scan, error)) {
      return absl::NotFoundError(absl::StrCat(scan.string(), ": not there"));
    }
    recording.observations.clouds.push_back({frame, scan.string(), nullptr});
  }
  if (std::filesystem::exists(folder / "ground_truth.txt", error)) {
    ASSIGN_OR_RETURN(recording.ground_truth, ReadPoses(folder / "ground_truth.txt", times));
    recording.common_from_world = Rigid3d::Identity();
  }
  if (std::filesystem::exists(folder / "degenerate.txt", error)) {
    RETURN_IF_ERROR(ReadDegenerate(folder / "degenerate.txt", &recording));
  }
  return recording;
}

// The folders of the robots in it, sorted.
std::vector<std::filesystem::path> FindRobots(const std::filesystem::path& folder) {
  std::error_code error;
  if (std::filesystem::exists(folder / kOdometry, error)) return {folder};
  std::vector<std::filesystem::path> robots;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (std::filesystem::exists(entry->path() / kOdometry, error)) robots.push_back(entry->path());
  }
  std::sort(robots.begin(), robots.end());
  return robots;
}

}  // namespace

absl::StatusOr<std::vector<Recording>> ReadPcdRecordings(const std::string& folder) {
  std::error_code error;
  // Absolute, for the robots' processes; without a slash at its end, for the name.
  std::filesystem::path path = std::filesystem::absolute(folder, error).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  const std::vector<std::filesystem::path> robots = FindRobots(path);
  if (robots.empty()) {
    return absl::NotFoundError(
        absl::StrCat(folder, ": neither it nor a folder in it has ", kOdometry));
  }
  std::vector<Recording> recordings;
  for (const std::filesystem::path& robot : robots) {
    ASSIGN_OR_RETURN(Recording recording, ReadRobot(robot));
    recordings.push_back(std::move(recording));
  }
  return recordings;
}

}  // namespace overtone
