// SPDX-License-Identifier: Apache-2.0
// Small hand-written recordings on disk, and the error of dead reckoning on real ones.
#ifndef OVERTONE_TESTS_CLIENT_CLI_RECORDING_FILES_H_
#define OVERTONE_TESTS_CLIENT_CLI_RECORDING_FILES_H_

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "overtone/client/cli/dataset.h"
#include "overtone/core/geometry/trajectory_error.h"

namespace overtone {

// A folder of its own, removed at the end.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(const std::string& name)
      : path_(std::filesystem::temp_directory_path() / (std::to_string(getpid()) + "_" + name)) {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }

  std::string path() const { return path_.string(); }

  // Makes the folders above it too. Returns the file's path.
  std::string Write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name) << text;
    return (path_ / name).string();
  }

 private:
  std::filesystem::path path_;
};

inline std::string RealData(const std::string& name) {
  return std::string(OVERTONE_SOURCE_DIR) + "/../shared/data/" + name;
}

// RMSE of the odometry's positions where the ground truth has a pose within 0.35 s before and
// after, after SE(3) alignment; < 0 where it has none.
inline double DeadReckonedError(const Recording& recording) {
  std::vector<Rigid3d> odometry, truth;
  const Trajectory& known = recording.ground_truth;
  for (const StampedPose& pose : recording.odometry) {
    const auto after =
        std::lower_bound(known.begin(), known.end(), pose.stamp,
                         [](const StampedPose& row, Timestamp time) { return row.stamp < time; });
    if (after == known.end()) continue;
    if (after->stamp != pose.stamp &&
        (after == known.begin() || SecondsBetween((after - 1)->stamp, after->stamp) > 0.35)) {
      continue;
    }
    odometry.push_back(pose.pose);
    truth.push_back(*Interpolate(known, pose.stamp));
  }
  const auto error = AbsoluteTrajectoryError(odometry, truth);
  return error.ok() ? error->rmse_m : -1;
}

}  // namespace overtone

#endif  // OVERTONE_TESTS_CLIENT_CLI_RECORDING_FILES_H_
