// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/scenario.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/simulation/ground_pose.h"
#include "overtone/core/simulation/option_range.h"
#include "overtone/core/simulation/random.h"
#include "overtone/core/simulation/uniform_spline.h"
#include "overtone/core/simulation/value_noise.h"

namespace overtone {
namespace {

constexpr double kExploredLengthM = 300;
constexpr int64_t kStartNs = 1'700'000'000'000'000'000;  // of every run: an instant in 2023
constexpr double kControlSpacingM = 1.5;                 // corners are rounded over about twice it
constexpr double kWanderM = 0.5;     // how far from the middle of the way, along x and y each
constexpr double kWanderWaveM = 8;   // along the way
constexpr double kFootprintM = 0.8;  // length over which the body levels the ground

// Positions along the walk, evenly spaced, up to length_m.
std::vector<Eigen::Vector2d> SpacedPoints(const NavigationGraph& graph,
                                          const std::vector<int>& walk, double length_m) {
  std::vector<Eigen::Vector2d> points;
  double at = 0, leg_begin = 0;
  for (size_t i = 1; i < walk.size(); ++i) {
    const Eigen::Vector2d a = graph.positions()[walk[i - 1]], b = graph.positions()[walk[i]];
    const double leg = (b - a).norm();
    for (; at < leg_begin + leg && at <= length_m; at += kControlSpacingM) {
      points.push_back(a + (at - leg_begin) / leg * (b - a));
    }
    leg_begin += leg;
  }
  return points;
}

std::vector<Eigen::Vector2d> ControlPoints(const ScenarioOptions& options, const Scene& scene,
                                           int robot, Random& random) {
  const std::vector<int>& route = scene.routes[robot % scene.routes.size()];
  const bool explores = options.explore || robot >= static_cast<int>(scene.routes.size());
  std::vector<int> walk = explores ? std::vector<int>{route.front()} : route;
  double length_m = options.length_m;
  if (length_m == 0) length_m = explores ? kExploredLengthM : scene.graph.Length(route);
  // The spline begins and ends about a spacing within its control points.
  scene.graph.Explore(length_m + 3 * kControlSpacingM, random, &walk);
  std::vector<Eigen::Vector2d> control =
      SpacedPoints(scene.graph, walk, length_m + 2 * kControlSpacingM);
  const uint64_t x_seed = random.Fork(), y_seed = random.Fork();
  for (size_t i = 0; i < control.size(); ++i) {
    const Eigen::Vector2d at(static_cast<double>(i) * kControlSpacingM / kWanderWaveM, 0);
    control[i] += kWanderM * Eigen::Vector2d(ValueNoise(x_seed, at), ValueNoise(y_seed, at));
  }
  return control;
}

Rigid3d PoseOnGround(const World& world, const SplinePoint& point, double body_height_m) {
  const Eigen::Vector2d& p = point.position;
  const Eigen::Vector2d dx(kFootprintM / 2, 0), dy(0, kFootprintM / 2);
  const Eigen::Vector2d rise(world.GroundHeight(p + dx) - world.GroundHeight(p - dx),
                             world.GroundHeight(p + dy) - world.GroundHeight(p - dy));
  return PoseOnSlope({p.x(), p.y(), world.GroundHeight(p) + body_height_m}, rise / kFootprintM,
                     point.direction);
}

Trajectory Drive(const ScenarioOptions& options, const World& world,
                 const std::vector<Eigen::Vector2d>& control) {
  const double segments_per_s = options.speed_mps / kControlSpacingM;
  const double duration_s = static_cast<double>(control.size() - 3) / segments_per_s;
  Trajectory truth;
  for (int i = 0; i <= static_cast<int>(duration_s * options.rate_hz); ++i) {
    const double time_s = i / options.rate_hz;
    truth.push_back({Timestamp{kStartNs + std::llround(time_s * 1e9)},
                     PoseOnGround(world, EvaluateSpline(control, time_s * segments_per_s),
                                  options.body_height_m)});
  }
  return truth;
}

// Keeps the keyframes of whole trajectories, and marks those that come through the corridor.
void KeepKeyframes(const KeyframeSelectionOptions& keyframes, const OdometryFailures& failures,
                   const Scene& scene, const Trajectory& truth, const Trajectory& odometry,
                   ScenarioRobot* robot) {
  int previous = 0;
  for (const int i : SelectKeyframes(Poses(truth), keyframes)) {
    const bool degenerate =
        failures.degenerate &&
        std::any_of(truth.begin() + previous, truth.begin() + i,
                    [&](const StampedPose& pose) { return InCorridor(scene, pose.pose); });
    if (degenerate) {
      robot->degenerate.push_back({static_cast<int>(robot->odometry.size()),
                                   truth[i].pose.rotation.conjugate() * Eigen::Vector3d::UnitX()});
    }
    robot->odometry.push_back(odometry[i]);
    robot->ground_truth.push_back(truth[i]);
    previous = i;
  }
}

absl::Status CheckFailures(const OdometryFailures& failures, const Scene& scene,
                           const std::string& name) {
  if (failures.yaw_drift && !scene.terrace.has_value()) {
    return absl::InvalidArgumentError(
        absl::StrCat("ScenarioOptions.failures.yaw_drift: scene ", name, " has no terrace"));
  }
  if (failures.degenerate && !scene.corridor.has_value()) {
    return absl::InvalidArgumentError(
        absl::StrCat("ScenarioOptions.failures.degenerate: scene ", name, " has no corridor"));
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status ScenarioOptions::Validate() const {
  const OptionRange range("ScenarioOptions");
  RETURN_IF_ERROR(range.Check("num_robots", num_robots, 0, 100));
  RETURN_IF_ERROR(range.Check("num_failing", num_failing, 0, 100));
  RETURN_IF_ERROR(range.Check("length_m", length_m, 0, 1e5));
  RETURN_IF_ERROR(range.Check("speed_mps", speed_mps, 0.1, 10));
  RETURN_IF_ERROR(range.Check("rate_hz", rate_hz, 1, 1000));
  RETURN_IF_ERROR(range.Check("body_height_m", body_height_m, 0, 2));
  RETURN_IF_ERROR(keyframes.Validate());
  RETURN_IF_ERROR(odometry.Validate());
  return failures.Validate();
}

PointCloud ScenarioRobot::Scan(const World& world, const Lidar& lidar, int keyframe) const {
  Random random(scan_seed + static_cast<uint64_t>(keyframe));
  return lidar.Scan(world, ground_truth[keyframe].pose, random);
}

absl::StatusOr<Scenario> SimulateScenario(const ScenarioOptions& options) {
  RETURN_IF_ERROR(options.Validate());
  Random random(options.seed);
  ASSIGN_OR_RETURN(Scene scene, MakeScene(options.scene, random.Fork()));
  RETURN_IF_ERROR(CheckFailures(options.failures, scene, options.scene));
  World world(scene.plan);
  const int num_robots =
      options.num_robots > 0 ? options.num_robots : static_cast<int>(scene.routes.size());
  std::vector<ScenarioRobot> robots(num_robots);
  for (int i = 0; i < num_robots; ++i) {
    Random own(random.Fork());
    robots[i].name = absl::StrCat("robot", i + 1);
    const Trajectory truth = Drive(options, world, ControlPoints(options, scene, i, own));
    const bool fails = options.num_failing == 0 || i < options.num_failing;
    const OdometryFailures failures = fails ? options.failures : OdometryFailures();
    const MotionFault fault = MakeMotionFault(failures, scene, truth, own);
    const Trajectory odometry = SimulateOdometry(truth, options.odometry, own.Fork(), fault);
    robots[i].scan_seed = own.Fork();
    KeepKeyframes(options.keyframes, failures, scene, truth, odometry, &robots[i]);
  }
  return Scenario{std::move(scene), std::move(world), std::move(robots)};
}

}  // namespace overtone
