// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/recorded_suites.h"

#include <string>
#include <utility>

#include "absl/strings/str_cat.h"

namespace overtone {
namespace {

// Fills what is particular to a dataset; paths begin with the data folder.
using Fill = void (*)(const std::string& data, ReplayOptions* options);

Experiment Recorded(std::string name, std::string title, Fill fill) {
  return {std::move(name), std::move(title),
          [fill](const std::string& /*folder*/, uint64_t /*seed*/,
                 const std::string& data) -> absl::StatusOr<ReplayOptions> {
            ReplayOptions options;
            fill(data, &options);
            return options;
          }};
}

void SetDataset(DatasetKind kind, const std::string& name, ReplayOptions* options) {
  options->dataset = kind;
  options->dataset_name = name;
}

Experiment Euroc() {
  return Recorded(
      "euroc", "EuRoC MH_01 to 03, visual-inertial odometry, simulated closures",
      [](const std::string& data, ReplayOptions* options) {
        SetDataset(DatasetKind::kEuroc, "euroc", options);
        for (const std::string robot : {"MH_01", "MH_02", "MH_03"}) {
          options->robots.push_back(absl::StrCat(robot, ":", data, "/euroc/odometry_cppt/", robot,
                                                 ".txt:", data, "/euroc/gt/", robot, ".txt"));
        }
        options->closures_from_ground_truth = "radius=1,sigma_t=0.03,sigma_r=0.00873";
      });
}

Experiment Mulran() {
  return Recorded(
      "mulran", "MulRan KAIST_01 to 03, LiDAR odometry, simulated closures",
      [](const std::string& data, ReplayOptions* options) {
        SetDataset(DatasetKind::kMulran, "mulran", options);
        for (const std::string run : {"KAIST_01", "KAIST_02", "KAIST_03"}) {
          options->robots.push_back(absl::StrCat(run, ":", data, "/mulran/odometry/", run,
                                                 ".txt:", data, "/mulran/gt/", run, ".txt"));
          if (run == "KAIST_01") continue;
          options->alignments.push_back(
              absl::StrCat(run, ":", data, "/mulran/session_alignment/", run, "_to_01.txt"));
        }
        options->closures_from_ground_truth =
            "radius=5,sigma_t=0.1,sigma_r=0.00873,density=0.1,max_per_keyframe=3";
      });
}

template <int kSequence>
void FillKitti(const std::string& data, ReplayOptions* options) {
  SetDataset(DatasetKind::kKitti, "kitti", options);
  const std::string sequence = absl::StrCat(kSequence < 10 ? "0" : "", kSequence);
  options->robots = {absl::StrCat("K", sequence, ":", data, "/kitti/odometry_simple/", sequence,
                                  ".txt:", data, "/kitti/gt/", sequence, ".txt")};
  options->closures_file = absl::StrCat(data, "/kitti/stereo_g2o/kitti_", sequence, ".g2o");
}

std::vector<Experiment> Kitti() {
  return {Recorded("kitti_00", "KITTI 00 in three, LiDAR odometry, the stereo graph's loop edges",
                   [](const std::string& data, ReplayOptions* options) {
                     FillKitti<0>(data, options);
                     options->split = 3;
                   }),
          Recorded("kitti_05", "KITTI 05 in two, likewise",
                   [](const std::string& data, ReplayOptions* options) {
                     FillKitti<5>(data, options);
                     options->split = 2;
                   })};
}

Experiment Mrclam() {
  return Recorded("mrclam", "MRCLAM 6, five robots, wheel odometry, landmarks and each other",
                  [](const std::string& data, ReplayOptions* options) {
                    SetDataset(DatasetKind::kMrclam, "mrclam", options);
                    options->sensor_files.paths = {data + "/mrclam/Dataset6"};
                  });
}

Experiment Hku() {
  return Recorded("hku", "HKU Livox in two, injected drift, clouds",
                  [](const std::string& data, ReplayOptions* options) {
                    SetDataset(DatasetKind::kPcd, "pcd", options);
                    options->sensor_files.paths = {data + "/hku_livox"};
                    options->split = 2;
                    options->inject_drift = "translation=0.05,rotation=0.01";
                  });
}

Experiment Radish() {
  return Recorded("aces", "Radish aces in three, wheel odometry, planar scans",
                  [](const std::string& data, ReplayOptions* options) {
                    SetDataset(DatasetKind::kCarmen, "carmen", options);
                    options->sensor_files.paths = {data + "/radish_2d/aces.clf"};
                    options->sensor_files.reference = data + "/radish_2d/aces-corrected.log";
                    options->split = 3;
                  });
}

}  // namespace

std::vector<EvaluationSuite> RecordedSuites() {
  std::vector<EvaluationSuite> suites = {
      {"euroc", "EuRoC MAV, selection strategies", {Euroc()}, true},
      {"mulran", "MulRan KAIST, selection strategies", {Mulran()}, true},
      {"kitti", "KITTI odometry, selection strategies", Kitti(), true},
      {"mrclam", "UTIAS MRCLAM, selection strategies", {Mrclam()}, true},
      {"hku", "HKU Livox, selection strategies", {Hku()}, true},
      {"radish", "Radish aces, selection strategies", {Radish()}, true}};
  EvaluationSuite all = {"all", "Selection strategies on every recording", {}, true};
  for (const EvaluationSuite& suite : suites) {
    all.experiments.insert(all.experiments.end(), suite.experiments.begin(),
                           suite.experiments.end());
  }
  EvaluationSuite constraints = {"constraints",
                                 "Selection strategies on recordings without clouds",
                                 {Euroc(), Mulran()},
                                 true};
  for (Experiment& experiment : Kitti()) constraints.experiments.push_back(std::move(experiment));
  suites.push_back(std::move(constraints));
  suites.push_back(std::move(all));
  return suites;
}

}  // namespace overtone
