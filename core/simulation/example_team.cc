// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/example_team.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/simulation/campus.h"
#include "overtone/core/simulation/option_range.h"
#include "overtone/core/simulation/random.h"
#include "overtone/core/simulation/uniform_spline.h"

namespace overtone {
namespace {

constexpr double kMaxPoses = 1e7;
constexpr int64_t kStartNs = 1'700'000'000'000'000'000;  // of every run: an instant in 2023
constexpr double kWanderM = 0.25;  // how far from the middle of the street, one sigma

// The walk, one control point every Campus::kBlockM / kPointsPerStreet metres, so that along a
// street the speed is the wanted one.
Trajectory SimulateGroundTruth(const ExampleTeamOptions& options, int num_poses, Random& random) {
  const double segments_per_s = options.speed_mps * Campus::kPointsPerStreet / Campus::kBlockM;
  const int num_segments = static_cast<int>(options.duration_s * segments_per_s) + 1;
  std::vector<Eigen::Vector2d> control =
      Campus::RandomWalk((num_segments + 3) / Campus::kPointsPerStreet + 1, random);
  for (Eigen::Vector2d& point : control) point += kWanderM * random.Normal3().head<2>();

  Trajectory truth;
  truth.reserve(num_poses);
  for (int i = 0; i < num_poses; ++i) {
    const double time_s = i / options.rate_hz;
    const SplinePoint point = EvaluateSpline(control, time_s * segments_per_s);
    truth.push_back({Timestamp{kStartNs + std::llround(time_s * 1e9)},
                     Campus::PoseOnGround(point.position, point.direction)});
  }
  return truth;
}

}  // namespace

absl::Status ExampleTeamOptions::Validate() const {
  const OptionRange range("ExampleTeamOptions");
  RETURN_IF_ERROR(range.Check("num_robots", num_robots, 1, 100));
  RETURN_IF_ERROR(range.Check("duration_s", duration_s, 1, 86400));
  RETURN_IF_ERROR(range.Check("rate_hz", rate_hz, 0.1, 1000));
  RETURN_IF_ERROR(range.Check("speed_mps", speed_mps, 0.01, 10));
  RETURN_IF_ERROR(range.Check("duration_s times rate_hz times num_robots",
                              duration_s * rate_hz * num_robots, 0, kMaxPoses));
  return odometry.Validate();
}

absl::StatusOr<std::vector<SimulatedRobot>> SimulateExampleTeam(const ExampleTeamOptions& options) {
  RETURN_IF_ERROR(options.Validate());
  const int num_poses = static_cast<int>(options.duration_s * options.rate_hz) + 1;
  Random team(options.seed);
  std::vector<SimulatedRobot> robots;
  for (int i = 1; i <= options.num_robots; ++i) {
    Random random(team.Fork());
    SimulatedRobot robot;
    robot.name = absl::StrCat("robot_", i);
    robot.ground_truth = SimulateGroundTruth(options, num_poses, random);
    robot.odometry = SimulateOdometry(robot.ground_truth, options.odometry, random.Fork());
    robots.push_back(std::move(robot));
  }
  return robots;
}

}  // namespace overtone
