// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/simulation_files.h"

#include <filesystem>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "nlohmann/json.hpp"
#include "overtone/client/cli/output_files.h"
#include "overtone/core/common/format_number.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/geometry/trajectory_io.h"
#include "overtone/core/graph/point_cloud_io.h"

namespace overtone {
namespace {

using Json = nlohmann::json;

Json ToJson(const OdometryNoise& noise) {
  return {{"translation_density", noise.translation_density},
          {"rotation_density", noise.rotation_density},
          {"initial_yaw_bias_sigma", noise.initial_yaw_bias_sigma},
          {"yaw_bias_walk_density", noise.yaw_bias_walk_density},
          {"scale_sigma", noise.scale_sigma}};
}

Json ToJson(const OdometryFailures& failures) {
  return {{"yaw_drift", failures.yaw_drift},
          {"degenerate", failures.degenerate},
          {"jump", failures.jump},
          {"yaw_rate_rps", failures.yaw_rate_rps},
          {"motion_share", failures.motion_share},
          {"jump_m", failures.jump_m},
          {"jump_yaw_rad", failures.jump_yaw_rad}};
}

Json ToJson(const ScenarioOptions& options) {
  return {{"scene", options.scene},
          {"num_robots", options.num_robots},
          {"seed", options.seed},
          {"explore", options.explore},
          {"length_m", options.length_m},
          {"speed_mps", options.speed_mps},
          {"rate_hz", options.rate_hz},
          {"body_height_m", options.body_height_m},
          {"keyframe_distance_m", options.keyframes.min_distance_m},
          {"keyframe_rotation_rad", options.keyframes.min_rotation_rad},
          {"odometry", ToJson(options.odometry)},
          {"failures", ToJson(options.failures)},
          {"num_failing", options.num_failing}};
}

Json ToJson(const LidarOptions& options) {
  return {{"rings", options.rings},
          {"vertical_fov_deg", options.vertical_fov_deg},
          {"columns", options.columns},
          {"horizontal_fov_deg", options.horizontal_fov_deg},
          {"min_range_m", options.min_range_m},
          {"max_range_m", options.max_range_m},
          {"range_sigma_m", options.range_sigma_m},
          {"mounting_height_m", options.mounting_height_m}};
}

// [x_min, y_min, x_max, y_max], or null.
Json ToJson(const std::optional<Eigen::AlignedBox2d>& box) {
  if (!box.has_value()) return nullptr;
  return {box->min().x(), box->min().y(), box->max().x(), box->max().y()};
}

Json ToJson(const ScenarioRobot& robot) {
  return {{"name", robot.name},
          {"scan_seed", robot.scan_seed},
          {"keyframes", robot.ground_truth.size()},
          {"path_m", PathLength(robot.ground_truth)}};
}

absl::Status CheckEmpty(const std::string& folder) {
  std::error_code error;
  if (!std::filesystem::exists(folder, error)) return absl::OkStatus();
  if (std::filesystem::is_empty(folder, error) && !error) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(folder, ": is no empty folder"));
}

absl::StatusOr<SimulatedFolder> WriteRobot(const World& world, const Lidar& lidar,
                                           const ScenarioRobot& robot, const std::string& folder) {
  RETURN_IF_ERROR(MakeFolder(absl::StrCat(folder, "/Scans")));
  SimulatedFolder written;
  written.name = robot.name;
  written.path_m = PathLength(robot.ground_truth);
  written.num_keyframes = static_cast<int>(robot.ground_truth.size());
  written.num_degenerate = static_cast<int>(robot.degenerate.size());
  std::string times, degenerate;
  for (int i = 0; i < written.num_keyframes; ++i) {
    const PointCloud cloud = robot.Scan(world, lidar, i);
    written.num_points += static_cast<int64_t>(cloud.size());
    RETURN_IF_ERROR(WritePcd(absl::StrFormat("%s/Scans/%06d.pcd", folder, i), cloud));
    absl::StrAppend(&times, FormatSeconds(robot.odometry[i].stamp), "\n");
  }
  for (const auto& [index, direction] : robot.degenerate) {
    absl::StrAppend(&degenerate, index, " ", FormatDouble(direction.x()), " ",
                    FormatDouble(direction.y()), " ", FormatDouble(direction.z()), "\n");
  }
  RETURN_IF_ERROR(WriteText(absl::StrCat(folder, "/times.txt"), times));
  if (!degenerate.empty()) {
    RETURN_IF_ERROR(WriteText(absl::StrCat(folder, "/degenerate.txt"), degenerate));
  }
  RETURN_IF_ERROR(WriteTrajectory(absl::StrCat(folder, "/odom_poses.txt"), TrajectoryFormat::kKitti,
                                  robot.odometry));
  RETURN_IF_ERROR(WriteTrajectory(absl::StrCat(folder, "/ground_truth.txt"),
                                  TrajectoryFormat::kKitti, robot.ground_truth));
  return written;
}

}  // namespace

absl::StatusOr<std::vector<SimulatedFolder>> WriteSimulation(
    const ScenarioOptions& scenario, const LidarOptions& lidar_options, const std::string& folder,
    const std::function<void(const SimulatedFolder&)>& report) {
  ASSIGN_OR_RETURN(const Lidar lidar, Lidar::Create(lidar_options));
  ASSIGN_OR_RETURN(const Scenario simulated, SimulateScenario(scenario));
  RETURN_IF_ERROR(CheckEmpty(folder));
  RETURN_IF_ERROR(MakeFolder(folder));
  std::vector<SimulatedFolder> written;
  Json robots = Json::array();
  for (const ScenarioRobot& robot : simulated.robots) {
    ASSIGN_OR_RETURN(SimulatedFolder one, WriteRobot(simulated.world, lidar, robot,
                                                     absl::StrCat(folder, "/", robot.name)));
    robots.push_back(ToJson(robot));
    report(one);
    written.push_back(std::move(one));
  }
  const Json record = {{"scenario", ToJson(scenario)},
                       {"lidar", ToJson(lidar_options)},
                       {"terrace", ToJson(simulated.scene.terrace)},
                       {"corridor", ToJson(simulated.scene.corridor)},
                       {"robots", robots}};
  RETURN_IF_ERROR(WriteText(absl::StrCat(folder, "/scenario.json"), record.dump(2) + "\n"));
  return written;
}

}  // namespace overtone
