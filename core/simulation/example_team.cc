// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/example_team.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/simulation/campus.h"
#include "overtone/core/simulation/random.h"

namespace overtone {
namespace {

constexpr double kMaxPoses = 1e7;
constexpr int64_t kStartNs = 1'700'000'000'000'000'000;  // of every run: an instant in 2023
constexpr double kWanderM = 0.25;  // how far from the middle of the street, one sigma

absl::Status CheckRange(const char* name, double value, double low, double high) {
  if (value >= low && value <= high) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("ExampleTeamOptions.", name, ": must be from ",
                                                 low, " to ", high, ", is ", value));
}

// A uniform cubic B-spline in the plane: twice continuously differentiable, near its control points
// and between two of them for u from 0 to 1.
struct SplinePoint {
  Eigen::Vector2d position;
  Eigen::Vector2d direction;  // derivative by u
};

SplinePoint EvaluateSpline(const std::vector<Eigen::Vector2d>& control, double u) {
  const int last_segment = static_cast<int>(control.size()) - 4;
  const int k = std::min(static_cast<int>(u), last_segment);
  const double t = u - k;
  const double s = 1 - t;
  const Eigen::Vector2d &a = control[k], &b = control[k + 1], &c = control[k + 2],
                        &d = control[k + 3];
  return {(s * s * s * a + (3 * t * t * t - 6 * t * t + 4) * b +
           (3 * s * s * s - 6 * s * s + 4) * c + t * t * t * d) /
              6,
          (s * s * (b - a) + (1 + 2 * t * s) * (c - b) + t * t * (d - c)) / 2};
}

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
  RETURN_IF_ERROR(CheckRange("num_robots", num_robots, 1, 100));
  RETURN_IF_ERROR(CheckRange("duration_s", duration_s, 1, 86400));
  RETURN_IF_ERROR(CheckRange("rate_hz", rate_hz, 0.1, 1000));
  RETURN_IF_ERROR(CheckRange("speed_mps", speed_mps, 0.01, 10));
  RETURN_IF_ERROR(CheckRange("duration_s times rate_hz times num_robots",
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
