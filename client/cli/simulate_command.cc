// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/simulate_command.h"

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "overtone/client/cli/exit_code.h"
#include "overtone/client/cli/simulation_files.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

// As on the command line; what is absent keeps the sensor's own value.
struct SimulateOptions {
  ScenarioOptions scenario;
  double noise_scale = 1;
  std::vector<std::string> failures;
  std::string sensor = "spinning";
  std::optional<int> rings, columns;
  std::optional<double> vertical_fov_deg, horizontal_fov_deg, max_range_m, range_sigma_m;
  std::string out = "simulation";
  bool keep = false;
};

void AddTeamFlags(CLI::App* command, SimulateOptions* options) {
  const std::string group = "Team";
  ScenarioOptions& scenario = options->scenario;
  command->add_option("--scenario", scenario.scene, absl::StrJoin(SceneNames(), ", "))
      ->check(CLI::IsMember(SceneNames()))
      ->capture_default_str()
      ->group(group);
  command
      ->add_option("--robots", scenario.num_robots,
                   "How many; those beyond the scene's scripted team explore [the scripted team]")
      ->check(CLI::Range(1, 100))
      ->group(group);
  command->add_option("--seed", scenario.seed, "Of walls and clutter, ways and noise; layouts stay")
      ->capture_default_str()
      ->group(group);
  command->add_flag("--explore", scenario.explore, "All robots explore, none follows its script")
      ->group(group);
  command
      ->add_option("--length", scenario.length_m,
                   "Metres each robot drives [its script; 300 where it explores]")
      ->check(CLI::PositiveNumber)
      ->group(group);
  command->add_option("--speed", scenario.speed_mps, "Metres a second")
      ->capture_default_str()
      ->group(group);
  command
      ->add_option("--keyframe-distance", scenario.keyframes.min_distance_m,
                   "Metres between keyframes")
      ->capture_default_str()
      ->group(group);
  command
      ->add_option("--keyframe-rotation", scenario.keyframes.min_rotation_rad,
                   "Radians between keyframes")
      ->capture_default_str()
      ->group(group);
}

void AddOdometryFlags(CLI::App* command, SimulateOptions* options) {
  const std::string group = "Odometry";
  OdometryFailures& failures = options->scenario.failures;
  command
      ->add_option("--noise", options->noise_scale,
                   "Factor on the noise and biases of a LiDAR odometry, which drifts by about 1 % "
                   "of the way; 0: perfect")
      ->check(CLI::Range(0.0, 100.0))
      ->capture_default_str()
      ->group(group);
  command
      ->add_option("--failures", options->failures,
                   "yaw_drift (on the terrace), degenerate (motion along the corridor is "
                   "under-estimated, keyframes are flagged), jump (once in every run)")
      ->delimiter(',')
      ->check(CLI::IsMember({"yaw_drift", "degenerate", "jump"}))
      ->group(group);
  command
      ->add_option("--failing-robots", options->scenario.num_failing,
                   "How many, from the first on, have --failures [all]")
      ->check(CLI::Range(1, 100))
      ->group(group);
  command->add_option("--yaw-rate", failures.yaw_rate_rps, "Of yaw_drift, rad/s")
      ->capture_default_str()
      ->group(group);
  command
      ->add_option("--motion-share", failures.motion_share,
                   "Of degenerate: share of the motion along the corridor that is measured")
      ->capture_default_str()
      ->group(group);
  command->add_option("--jump", failures.jump_m, "Of jump, metres")
      ->capture_default_str()
      ->group(group);
  command->add_option("--jump-yaw", failures.jump_yaw_rad, "Of jump, rad")
      ->capture_default_str()
      ->group(group);
}

void AddSensorFlags(CLI::App* command, SimulateOptions* options) {
  const std::string group = "Sensor";
  command
      ->add_option("--sensor", options->sensor,
                   "spinning (16 rings over 30 degrees, 900 columns over 360, 50 m) or planar (one "
                   "ring, 1080 columns over 270 degrees, 30 m)")
      ->check(CLI::IsMember({"spinning", "planar"}))
      ->capture_default_str()
      ->group(group);
  command->add_option("--rings", options->rings, "e.g. 16 or 64")->group(group);
  command
      ->add_option("--vertical-fov-deg", options->vertical_fov_deg, "From lowest to highest ring")
      ->group(group);
  command->add_option("--columns", options->columns, "In a full turn")->group(group);
  command->add_option("--fov-deg", options->horizontal_fov_deg, "About straight ahead, up to 360")
      ->group(group);
  command->add_option("--max-range", options->max_range_m, "Metres")->group(group);
  command->add_option("--range-noise", options->range_sigma_m, "Metres, one sigma [0.02]")
      ->group(group);
}

ScenarioOptions ScenarioOf(const SimulateOptions& options) {
  ScenarioOptions scenario = options.scenario;
  for (double* density :
       {&scenario.odometry.translation_density, &scenario.odometry.rotation_density,
        &scenario.odometry.initial_yaw_bias_sigma, &scenario.odometry.yaw_bias_walk_density,
        &scenario.odometry.scale_sigma}) {
    *density *= options.noise_scale;
  }
  const auto wanted = [&options](const char* failure) {
    return std::count(options.failures.begin(), options.failures.end(), failure) > 0;
  };
  scenario.failures.yaw_drift = wanted("yaw_drift");
  scenario.failures.degenerate = wanted("degenerate");
  scenario.failures.jump = wanted("jump");
  return scenario;
}

LidarOptions LidarOf(const SimulateOptions& options) {
  LidarOptions lidar = options.sensor == "planar" ? LidarOptions::Planar() : LidarOptions();
  lidar.rings = options.rings.value_or(lidar.rings);
  lidar.columns = options.columns.value_or(lidar.columns);
  lidar.vertical_fov_deg = options.vertical_fov_deg.value_or(lidar.vertical_fov_deg);
  lidar.horizontal_fov_deg = options.horizontal_fov_deg.value_or(lidar.horizontal_fov_deg);
  lidar.max_range_m = options.max_range_m.value_or(lidar.max_range_m);
  lidar.range_sigma_m = options.range_sigma_m.value_or(lidar.range_sigma_m);
  return lidar;
}

void Report(const SimulatedFolder& robot) {
  std::cout << absl::StreamFormat("%s: %d keyframes over %.0f m, %d points", robot.name,
                                  robot.num_keyframes, robot.path_m, robot.num_points);
  if (robot.num_degenerate > 0) std::cout << ", " << robot.num_degenerate << " degenerate";
  std::cout << std::endl;
}

// To `out` at once or not at all, where an interrupted one must not stand in the way of the next.
absl::Status WriteWhole(const SimulateOptions& options) {
  const std::string draft = options.out + ".part";
  std::error_code error;
  std::filesystem::remove_all(draft, error);
  RETURN_IF_ERROR(WriteSimulation(ScenarioOf(options), LidarOf(options), draft, Report).status());
  std::filesystem::rename(draft, options.out, error);
  if (!error) return absl::OkStatus();
  return absl::UnavailableError(absl::StrCat("cannot write ", options.out, ": ", error.message()));
}

absl::Status Write(const SimulateOptions& options) {
  if (options.keep) return WriteWhole(options);
  return WriteSimulation(ScenarioOf(options), LidarOf(options), options.out, Report).status();
}

int Run(const SimulateOptions& options) {
  std::error_code error;
  if (options.keep && std::filesystem::exists(options.out + "/scenario.json", error)) {
    std::cout << options.out << " is there already\n";
    return 0;
  }
  const absl::Status written = Write(options);
  if (!written.ok()) return Fail("simulate", written);
  std::cout << "Written to " << options.out << "\n";
  return 0;
}

}  // namespace

void AddSimulateCommand(CLI::App* app, std::function<int()>* run) {
  auto options = std::make_shared<SimulateOptions>();
  CLI::App* command = app->add_subcommand(
      "simulate", "Drive a simulated team with LiDAR, and write down what it measures");
  command->footer(
      "Writes for every robot a folder robot1, robot2, ... with Scans/NNNNNN.pcd (a cloud for each "
      "keyframe, body\n"
      "frame), odom_poses.txt (3x4 row-major, in the robot's own frame), times.txt (seconds), "
      "ground_truth.txt\n"
      "(as odom_poses.txt, one world for all) and, where keyframes are flagged, degenerate.txt "
      "(keyframe and\n"
      "direction in the body frame); and scenario.json. The same options give the same files.\n\n"
      "  overtone simulate --scenario subterranean --out team/\n"
      "  overtone simulate --scenario corridor --failures degenerate,jump --rings 64 --out team/");
  AddTeamFlags(command, options.get());
  AddOdometryFlags(command, options.get());
  AddSensorFlags(command, options.get());
  command->add_option("--out", options->out, "Folder to write to, new or empty")
      ->capture_default_str();
  command->add_flag("--keep", options->keep,
                    "Leave the folder as it is where a simulation is there already");
  command->callback([options, run] { *run = [options] { return Run(*options); }; });
}

}  // namespace overtone
