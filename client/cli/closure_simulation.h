// SPDX-License-Identifier: Apache-2.0
// Loop closures made from ground truth, for data that has no scans or images to find them in.
// Whoever shows a result built on them says so.
#ifndef OVERTONE_CLIENT_CLI_CLOSURE_SIMULATION_H_
#define OVERTONE_CLIENT_CLI_CLOSURE_SIMULATION_H_

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "overtone/client/cli/robot_plan.h"

namespace overtone {

struct ClosureSimulationOptions {
  double radius_m = 1;      // the two keyframes are no further apart than this
  double sigma_t_m = 0.03;  // noise of the measurement, per axis
  double sigma_r_rad = 0.00873;
  double outliers = 0;           // share that is replaced by random wrong poses, [0, 1)
  double density = 1;            // share of the keyframes that look for closures at all, (0, 1]
  double max_per_keyframe = 12;  // each keeps its nearest ones, one of every mission first
  double min_gap_s = 10;         // between two keyframes of the same mission
  double seed = 1;

  absl::Status Validate() const;
};

// "radius=1,sigma_t=0.03,sigma_r=0.00873,outliers=0[,density=,max_per_keyframe=,min_gap_s=,seed=]".
absl::StatusOr<ClosureSimulationOptions> ParseClosureSimulation(absl::string_view text);

// One sentence for people: the rule, and that it was used.
std::string Describe(const ClosureSimulationOptions& options);

struct SimulatedClosure {
  LoopClosure closure;
  bool outlier = false;
};

// Pairs of keyframes with ground truth that meet: a keyframe with the nearest earlier ones of its
// own mission and of each mission listed before it whose ground truth lies in the same frame. The
// noise is Gaussian on the right tangent and so is the stated covariance, also of outliers. The
// same plans and seed give the same closures. O(n^2) distances.
std::vector<SimulatedClosure> SimulateClosures(const std::vector<RobotPlan>& plans,
                                               const ClosureSimulationOptions& options);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_CLOSURE_SIMULATION_H_
