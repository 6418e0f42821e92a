// SPDX-License-Identifier: Apache-2.0
// How wrong a guess may be: random starts around the truth, registered coarse to fine, for a
// recorded pair (when given) and simulated ones. Prints a table and writes it as CSV, and the
// success rate against the error of the start as SVG.
//
//   registration_basin OUT_DIRECTORY [source.ply target.ply target_from_source.txt]
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <string>
#include <vector>

#include "overtone/benchmark/basin_plot.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/geometry/parse_pose.h"
#include "overtone/core/graph/point_cloud_io.h"
#include "overtone/core/registration/coarse_to_fine.h"
#include "overtone/tests/support/simulated_scans.h"

namespace overtone {
namespace {

constexpr int kStarts = 200;
constexpr double kSuccess_m = 0.1;
constexpr double kSuccess_rad = 1.0 * M_PI / 180;

// Of a start: so far off in a random level direction and, unless the clouds are planar, about a
// tenth of that in height; turned by yaw one way or the other.
struct StartError {
  double translation_m;
  double yaw_rad;
};

struct Scenario {
  std::string name;
  ScanPair pair;
  CoarseToFineOptions options;
  double scale = 1;        // of the starts' translations
  bool axis_open = false;  // nothing determines x: its error does not count
};

StartError ErrorOfStep(int step, double scale) {
  const double metres[] = {1, 2, 4, 6, 8, 10, 12, 16};
  const double degrees[] = {5, 10, 10, 15, 20, 30, 45, 60};
  return {scale * metres[step], degrees[step] * M_PI / 180};
}
constexpr int kSteps = 8;

Rigid3d Start(const Rigid3d& truth, const StartError& error, bool planar, Random& random) {
  const double heading = 2 * M_PI * random.Uniform();
  const double height = planar ? 0 : 0.1 * random.Normal();
  const Eigen::Vector3d offset(std::cos(heading), std::sin(heading), height);
  const double yaw = random.Below(2) == 0 ? error.yaw_rad : -error.yaw_rad;
  return truth * Rigid3d(ExpSO3(Eigen::Vector3d(0, 0, yaw)), error.translation_m * offset);
}

double Quantile(std::vector<double> values, double share) {
  if (values.empty()) return NAN;
  std::sort(values.begin(), values.end());
  return values[static_cast<size_t>(share * (values.size() - 1))];
}

absl::StatusOr<BasinRow> RunStarts(const Scenario& scenario, const RegistrationPyramid& source,
                                   const RegistrationPyramid& target, const StartError& error) {
  Random random(/*seed=*/1);
  std::vector<double> errors_m, errors_deg, overlaps, failed_overlaps;
  double seconds = 0;
  for (int i = 0; i < kStarts; ++i) {
    const Rigid3d start =
        Start(scenario.pair.target_from_source, error, source.finest().planar(), random);
    const std::clock_t begin = std::clock();
    ASSIGN_OR_RETURN(const RegistrationResult result,
                     RegisterCoarseToFine(source, target, start, scenario.options));
    seconds += static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    const Rigid3d off = scenario.pair.target_from_source.Inverse() * result.target_from_source;
    Eigen::Vector3d translation = off.translation;
    if (scenario.axis_open) translation.x() = 0;
    const double angle = LogSO3(off.rotation).norm();
    errors_m.push_back(translation.norm());
    errors_deg.push_back(angle * 180 / M_PI);
    const bool success = translation.norm() < kSuccess_m && angle < kSuccess_rad;
    (success ? overlaps : failed_overlaps).push_back(result.overlap);
  }
  BasinRow row;
  row.scenario = scenario.name;
  row.start_m = error.translation_m;
  row.start_deg = error.yaw_rad * 180 / M_PI;
  row.success_rate = static_cast<double>(overlaps.size()) / kStarts;
  row.median_error_m = Quantile(errors_m, 0.5);
  row.median_error_deg = Quantile(errors_deg, 0.5);
  row.milliseconds = 1e3 * seconds / kStarts;
  row.least_overlap_of_successes = Quantile(overlaps, 0);
  row.largest_overlap_of_failures = Quantile(failed_overlaps, 1);
  return row;
}

absl::Status RunScenario(const Scenario& scenario, std::vector<BasinRow>& rows) {
  ASSIGN_OR_RETURN(const RegistrationPyramid source,
                   RegistrationPyramid::Create(scenario.pair.source, scenario.options));
  ASSIGN_OR_RETURN(const RegistrationPyramid target,
                   RegistrationPyramid::Create(scenario.pair.target, scenario.options));
  for (int step = 0; step < kSteps; ++step) {
    ASSIGN_OR_RETURN(const BasinRow row,
                     RunStarts(scenario, source, target, ErrorOfStep(step, scenario.scale)));
    PrintRow(row);
    rows.push_back(row);
  }
  return absl::OkStatus();
}

std::vector<Scenario> SimulatedScenarios() {
  const Scanner lidar, laser = PlanarScanner();
  return {
      {"hall", ScanTwice(HallWorld(), StandingAt(2, 1, 0.3), StandingAt(0, 0, 0), lidar, 1)},
      {"room", ScanTwice(RoomWorld(), StandingAt(1, 0.5, 0.3), StandingAt(0, 0, 0), lidar, 2),
       CoarseToFineOptions(), 0.25},
      {"hall, planar", ScanTwice(HallWorld(), StandingAt(2, 1, 0.3), StandingAt(0, 0, 0), laser, 3),
       IndoorLaserOptions(), 0.5},
      {"room, planar",
       ScanTwice(RoomWorld(), StandingAt(1, 0.5, 0.3), StandingAt(0, 0, 0), laser, 4),
       IndoorLaserOptions(), 0.25},
      {"corridor, across",
       ScanTwice(CorridorWorld(), StandingAt(2, 0.3, 0), StandingAt(0, 0, 0), lidar, 5),
       CoarseToFineOptions(), 0.25, /*axis_open=*/true},
  };
}

absl::StatusOr<Scenario> RecordedScenario(char** paths) {
  Scenario scenario;
  scenario.name = "recorded pair";
  ASSIGN_OR_RETURN(scenario.pair.source, ReadPointCloud(paths[0]));
  ASSIGN_OR_RETURN(scenario.pair.target, ReadPointCloud(paths[1]));
  std::ifstream matrix(paths[2]);
  Eigen::Matrix<double, 3, 4> target_from_source;
  for (int i = 0; i < 12; ++i) matrix >> target_from_source(i / 4, i % 4);
  ASSIGN_OR_RETURN(scenario.pair.target_from_source, CheckedPose(target_from_source));
  return scenario;
}

absl::Status Run(int argc, char** argv) {
  if (argc != 2 && argc != 5) {
    return absl::InvalidArgumentError(
        "registration_basin OUT_DIRECTORY [source.ply target.ply target_from_source.txt]");
  }
  std::vector<Scenario> scenarios = SimulatedScenarios();
  if (argc == 5) {
    ASSIGN_OR_RETURN(const Scenario recorded, RecordedScenario(argv + 2));
    scenarios.insert(scenarios.begin(), recorded);
  }
  std::vector<BasinRow> rows;
  PrintHeader();
  for (const Scenario& scenario : scenarios) RETURN_IF_ERROR(RunScenario(scenario, rows));
  const std::string directory = argv[1];
  RETURN_IF_ERROR(WriteCsv(directory + "/registration_basin.csv", rows));
  return WriteSvg(directory + "/registration_basin.svg", rows);
}

}  // namespace
}  // namespace overtone

int main(int argc, char** argv) {
  const absl::Status status = overtone::Run(argc, argv);
  if (status.ok()) return 0;
  std::fprintf(stderr, "%s\n", status.ToString().c_str());
  return 1;
}
