// SPDX-License-Identifier: Apache-2.0
// A small team of robots that drive through the same streets: something to show and to test with
// where no data set is at hand.
#ifndef OVERTONE_CORE_SIMULATION_EXAMPLE_TEAM_H_
#define OVERTONE_CORE_SIMULATION_EXAMPLE_TEAM_H_

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "overtone/core/geometry/trajectory.h"
#include "overtone/core/simulation/odometry_noise.h"

namespace overtone {

struct ExampleTeamOptions {
  int num_robots = 3;       // 1..100
  double duration_s = 600;  // of each run, 1 s..24 h
  double rate_hz = 10;      // poses a second, 0.1..1000
  double speed_mps = 0.6;   // along straight streets, 0.01..10; corners are rounded
  OdometryNoise odometry;
  uint64_t seed = 1;

  // InvalidArgument naming the member; also above ten million poses in all.
  absl::Status Validate() const;
};

struct SimulatedRobot {
  std::string name;         // "robot_1", "robot_2", ...
  Trajectory odometry;      // odometry_from_body, first pose identity
  Trajectory ground_truth;  // map_from_body, one map for the team; same stamps
};

// Each robot walks at random over a campus of 45 m x 45 m (campus.h), smoothly (continuous
// acceleration) and all of them from the same stamp on. With the defaults: three runs of 10 minutes
// and about 350 m, whose odometry drifts by some metres. The same options give the same team on
// every platform, up to the last bits of its sin, cos and log.
absl::StatusOr<std::vector<SimulatedRobot>> SimulateExampleTeam(const ExampleTeamOptions& options);

}  // namespace overtone

#endif  // OVERTONE_CORE_SIMULATION_EXAMPLE_TEAM_H_
