// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/replay_command.h"

#include <cmath>
#include <iostream>
#include <map>
#include <memory>
#include <string>

#include "overtone/client/cli/exit_code.h"
#include "overtone/client/cli/replay.h"
#include "overtone/client/cli/table.h"
#include "overtone/client/cli/tls_flags.h"

namespace overtone {
namespace {

const std::map<std::string, DatasetKind>& Datasets() {
  static const auto* const names = new std::map<std::string, DatasetKind>{
      {"example", DatasetKind::kExample}, {"euroc", DatasetKind::kEuroc},
      {"mulran", DatasetKind::kMulran},   {"kitti", DatasetKind::kKitti},
      {"tum", DatasetKind::kTum},         {"g2o", DatasetKind::kG2o},
      {"mrclam", DatasetKind::kMrclam},   {"pcd", DatasetKind::kPcd},
      {"carmen", DatasetKind::kCarmen},   {"tuc", DatasetKind::kTuc}};
  return *names;
}

void AddInputFlags(CLI::App* command, ReplayOptions* options) {
  const std::string group = "Recordings";
  command
      ->add_option("--dataset", options->dataset_name,
                   "Format and defaults: example (a simulated team, no files needed); with "
                   "--robot: euroc, mulran, kitti, tum, g2o; with PATH: mrclam, pcd, carmen, tuc")
      ->check(CLI::IsMember(Datasets()))
      ->capture_default_str()
      ->group(group);
  command
      ->add_option("path", options->sensor_files.paths,
                   "mrclam: folder of RobotN_*.dat; pcd: folders of Scans/NNNNNN.pcd, "
                   "odom_poses.txt, times.txt, or folders of such; carmen: raw log; tuc: folder of "
                   "NAME_Input.txt")
      ->check(CLI::ExistingPath)
      ->group(group);
  command
      ->add_option("--reference", options->sensor_files.reference,
                   "carmen: the SLAM-corrected log, for ground truth")
      ->check(CLI::ExistingFile)
      ->group(group);
  command
      ->add_option("--relations", options->sensor_files.relations,
                   "carmen: true relative poses, rows \"t1 t2 dx dy dz roll pitch yaw\", to "
                   "evaluate against")
      ->check(CLI::ExistingFile)
      ->group(group);
  command
      ->add_option("--min-candidate-score", options->sensor_files.min_candidate_score,
                   "tuc: leave out loop candidates below this")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str()
      ->group(group);
  command
      ->add_option("--robot", options->robots,
                   "NAME:odometry[:ground_truth], once for each robot; g2o: "
                   "NAME:file.g2o[:ground_truth.tum]")
      ->group(group);
  command
      ->add_option("--split", options->split,
                   "Cut the one robot into this many overlapping ones, NAME_0, NAME_1, ...")
      ->check(CLI::Range(1, 100))
      ->group(group);
  command
      ->add_option("--overlap", options->overlap,
                   "Share of its length that a part has in common with the next")
      ->check(CLI::Range(0.0, 0.9))
      ->capture_default_str()
      ->group(group);
  command
      ->add_option("--inject-drift", options->inject_drift,
                   "Make the odometry worse: translation=M,rotation=RAD (random walk, after 1 m)"
                   "[,seed=N], each robot its own; where there is no ground truth, the recorded "
                   "odometry becomes it")
      ->group(group);
  command
      ->add_option("--alignment", options->alignments,
                   "NAME:file with the 3x4 matrix that takes NAME's ground truth to the frame of "
                   "the robots without one; only to make "
                   "measurements between robots, every robot is evaluated in its own frame")
      ->group(group);
  command
      ->add_option("--keyframe-distance", options->keyframe_distance_m,
                   "Metres between keyframes [0.4; tuc: 0.5; kitti, mulran: 2; g2o, pcd: every "
                   "pose]; mrclam: sightings are keyframes too, carmen: poses of --reference and "
                   "--relations")
      ->check(CLI::NonNegativeNumber)
      ->group(group);
  command
      ->add_option("--keyframe-rotation", options->keyframe_rotation_rad,
                   "Radians between keyframes [0.5; carmen, kitti, mulran: 0.3]")
      ->check(CLI::NonNegativeNumber)
      ->group(group);
  command
      ->add_option("--odometry-sigma", options->odometry_sigma,
                   "How far odometry is trusted: translation=M,rotation=RAD (after 1 m),turn=RAD "
                   "(after turning 1 rad); "
                   "variances grow with the way [by dataset]")
      ->group(group);
  command
      ->add_option("--example-duration", options->example_duration_s,
                   "Seconds each robot of the example drives")
      ->check(CLI::Range(20.0, 86400.0))
      ->capture_default_str()
      ->group(group);
}

void AddClosureFlags(CLI::App* command, ReplayOptions* options) {
  const std::string group = "Loop closures";
  command
      ->add_option("--closures-from-ground-truth", options->closures_from_ground_truth,
                   "Simulate them: radius=M,sigma_t=M,sigma_r=RAD,outliers=SHARE[,density=SHARE of "
                   "keyframes,"
                   "max_per_keyframe=N,min_gap_s=S,seed=N]")
      ->group(group);
  command
      ->add_option("--closures", options->closures_file,
                   "File: closures.csv of an earlier run (columns "
                   "from_robot,from_stamp_s,to_robot,to_stamp_s,x,y,z,qx,qy,qz,qw,"
                   "sigma_t,sigma_r), or a .g2o whose vertex ids are rows of the odometry")
      ->check(CLI::ExistingFile)
      ->group(group);
  command
      ->add_option("--closure-tolerance", options->closure_tolerance,
                   "What the ground truth lets pass: translation=M,rotation=RAD off is right, "
                   "keyframes place=M apart show one place [1, 0.1745, 5]")
      ->group(group);
}

void AddRunFlags(CLI::App* command, ReplayOptions* options) {
  const std::string group = "Run";
  command->add_option("--out", options->out, "Folder for results")
      ->capture_default_str()
      ->group(group);
  command
      ->add_option("--server", options->server,
                   "host:port of a running mapping server [starts one of its own on a free port]")
      ->group(group);
  AddTlsFlags(command, &options->tls);
  command
      ->add_option("--tls-robot-certs", options->robot_certs,
                   "Folder of robot-NAME.crt and robot-NAME.key, as `overtone certs` writes them; "
                   "the other --tls flags are then the operator's")
      ->envname("OVERTONE_TLS_ROBOT_CERTS")
      ->group("Transport security");
  command
      ->add_option("--server-config", options->server_config,
                   "YAML file for the server that the replay starts; it keeps nothing, "
                   "whatever data_dir says")
      ->check(CLI::ExistingFile)
      ->group(group);
  command->add_option("--map", options->map, "Map to build [one of this run's own]")->group(group);
  command->add_option("--mission", options->mission, "What to call each robot's mission [run]")
      ->group(group);
  command
      ->add_flag("--fresh", options->fresh,
                 "Delete --map first, where the server has it: whatever it holds is gone")
      ->group(group);
  command
      ->add_option("--speed", options->speed,
                   "Data seconds per second of wall time, 0: as fast as possible")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str()
      ->group(group);
  command
      ->add_option("--compare-every", options->compare_every_s,
                   "Seconds of data time between comparisons, and the length of a submap")
      ->check(CLI::Range(0.1, 1e6))
      ->capture_default_str()
      ->group(group);
  command
      ->add_option("--reduction", options->reduction_percent,
                   "Percent by which the node limit of each robot's graph lies below its number of "
                   "keyframes: the server Kron-reduces to it")
      ->check(CLI::Range(0.0, 95.0))
      ->capture_default_str()
      ->group(group);
  command
      ->add_option("--timeout", options->timeout_s, "Seconds to wait for the server in each step")
      ->check(CLI::PositiveNumber)
      ->capture_default_str()
      ->group(group);
}

int Run(const ReplayOptions& options) {
  const absl::StatusOr<RunResult> result = RunReplay(options);
  if (!result.ok()) return Fail("replay", result.status());
  std::cout << "\n" << FormatSummary(*result) << "\nReport: " << options.out << "/report.html\n";
  return 0;
}

}  // namespace

void AddReplayCommand(CLI::App* app, std::function<int()>* run) {
  auto options = std::make_shared<ReplayOptions>();
  CLI::App* command = app->add_subcommand(
      "replay", "Play a team's recordings through client and server, and measure the correction");
  command->footer(
      "Starts a mapping server and one process for each robot. In steps of data time every robot "
      "uploads its\n"
      "keyframes, the server maps them all, and every robot compares and corrects. Robots recorded "
      "at different\n"
      "times all start together. Writes <robot>/{onboard,server,corrected}.tum, constraints.csv, "
      "closures.csv,\n"
      "metrics.json and report.html. RMSE: of positions after SE(3) alignment to the ground truth, "
      "robot by robot.\n"
      "Odometry and ground truth must be of the same body axes. Closures, the robots' and the "
      "server's own, are\n"
      "judged by the ground truth: precision is the right ones among those in use, recall the "
      "right ones in use\n"
      "among those proposed that truly show one place.\n\n"
      "  overtone replay\n"
      "  overtone replay --dataset euroc --robot MH_01:odometry.txt:gt.txt --robot MH_02:... \\\n"
      "      --closures-from-ground-truth radius=1,sigma_t=0.03,sigma_r=0.00873,outliers=0 --out "
      "run/\n"
      "  overtone replay --dataset mrclam MRCLAM_Dataset6\n"
      "  overtone replay --dataset pcd robot_a robot_b\n"
      "  overtone replay --dataset pcd HKU --split 2 --inject-drift "
      "translation=0.05,rotation=0.01\n"
      "  overtone replay --dataset carmen aces.clf --reference aces-corrected.log \\\n"
      "      --relations aces.relations --split 3\n"
      "  overtone replay --dataset tuc Lecture_Hall --min-candidate-score 0.5");
  AddInputFlags(command, options.get());
  AddClosureFlags(command, options.get());
  AddRunFlags(command, options.get());
  AddClientFlags(command, &options->client);
  command->callback([options, run, app] {
    if (IsSensorDataset(Datasets().at(options->dataset_name)) ==
        options->sensor_files.paths.empty()) {
      throw CLI::ValidationError("path",
                                 "mrclam, pcd, carmen and tuc need one, other datasets take none");
    }
    options->dataset = Datasets().at(options->dataset_name);
    options->command_line = app->config_to_str(false);
    *run = [options] { return Run(*options); };
  });
}

}  // namespace overtone
