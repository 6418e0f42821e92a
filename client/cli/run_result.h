// SPDX-License-Identifier: Apache-2.0
// Everything a replay leaves behind, as plain data: the files, the table and the report are views
// of this.
#ifndef OVERTONE_CLIENT_CLI_RUN_RESULT_H_
#define OVERTONE_CLIENT_CLI_RUN_RESULT_H_

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "Eigen/Core"
#include "overtone/core/common/timestamp.h"
#include "overtone/core/geometry/se3.h"
#include "overtone/core/geometry/trajectory_error.h"
#include "overtone/core/graph/submap.h"
#include "overtone/core/synchronization/constraint.h"

namespace overtone {

enum class ConstraintAction { kAdd, kUpdate, kRetract };

// One change of one constraint on its way to the robot's estimator. For kRetract only the id, the
// kind and the nodes say anything.
struct ConstraintRecord {
  ConstraintAction action = ConstraintAction::kAdd;
  Constraint constraint;
  double time_s = 0;  // data time of the comparison, since the robot's first keyframe
};

// One comparison of the server's estimate with the onboard one, and the state of the robot right
// after it.
struct ComparisonRecord {
  double time_s = 0;  // data time since the robot's first keyframe
  uint64_t revision = 0;
  double compare_ms = 0;  // graph, filter, selection
  int added = 0;
  int updated = 0;
  int retracted = 0;
  std::vector<int64_t> keyframe_index;  // the nodes compared, increasing
  Eigen::MatrixXd
      discrepancy;  // one row each; columns: large, mid, small (Band), before correcting
  // Of the keyframes so far against the ground truth, aligned; absent without ground truth. Metres.
  std::optional<double> onboard_rmse_m;
  std::optional<double> corrected_rmse_m;
};

struct RobotResult {
  std::string name;
  // One for each keyframe, in time order. The three estimates are in three frames of their own.
  std::vector<Timestamp> stamps;
  std::vector<Rigid3d> onboard;    // odometry only
  std::vector<Rigid3d> server;     // optimised with all robots
  bool anchored = false;           // `server` is in the map's frame, as that of all anchored robots
  std::vector<Rigid3d> corrected;  // onboard estimate with the constraints applied
  std::vector<std::optional<Rigid3d>> ground_truth;  // absent: none at this stamp
  bool ground_truth_positions_only = false;          // errors of rotations mean nothing

  double path_m = 0;      // of the odometry
  double duration_s = 0;  // data time
  int graph_nodes = 0;    // of this robot in the last graph the server sent

  // ATE over the keyframes that have ground truth, per_pose_m in their order; absent without ground
  // truth. reference_from_estimate takes the estimate's frame to the ground truth's.
  std::optional<TrajectoryError> onboard_error;
  std::optional<TrajectoryError> server_error;
  std::optional<TrajectoryError> corrected_error;

  std::vector<ComparisonRecord> comparisons;   // in time order
  std::vector<ConstraintRecord> constraints;   // every change, in time order
  std::vector<Constraint> active_constraints;  // in force at the end

  int64_t bytes_up = 0;  // messages, without HTTP/2 framing
  int64_t bytes_down = 0;
};

// A closure against the ground truth; what counts as right and as one place is the run's setting.
struct ClosureTruth {
  double distance_m = 0;            // between the two ends, truly
  bool same_place = false;          // by that distance, or because it was measured right
  std::optional<double> error_m;    // of the measured relative pose; absent: none was measured
  std::optional<double> error_rad;  // absent also where the ground truth has no rotations
  bool right = false;               // measured, and close enough to the truth
};

// What the server's registration of a closure's two clouds gave.
struct ClosureRegistration {
  double overlap = 0;     // [0, 1]
  double residual_m = 0;  // rms
  int open_directions = 0;
};

struct ClosureResult {
  LoopClosure closure;             // MissionId::robot is the robot's name
  std::string proposer = "robot";  // "robot", "robot_score", "scan_context"
  bool measured = true;            // false: closure.from_tform_to is a guess
  double score = 0;                // similarity of the two places, [0, 1]; 0: none was computed
  std::string verdict;  // "accepted", "demoted_by_optimiser", "pending", "rejected_overlap", ...
  double weight = 0;    // [0, 1]
  double chi_square = 0;
  std::optional<ClosureRegistration> registration;  // absent: there was none
  std::optional<ClosureTruth> truth;                // absent: the ground truth does not know
  bool simulated = false;                           // made from ground truth
  bool outlier = false;                             // made wrong on purpose
};

// Of relative poses known to be true; means and medians over `count` of them.
struct RelationErrors {
  std::string estimate;  // "onboard", "server", "corrected"
  int count = 0;
  double translation_mean_m = 0;
  double translation_median_m = 0;
  double rotation_mean_rad = 0;
  double rotation_median_rad = 0;
};

struct RunResult {
  // A server's map as it stands, not a run: `corrected`, ground truth and traffic are not known,
  // and robots are named as missions are.
  bool live = false;
  std::string dataset;  // "euroc", "example", ...; of a live map its name
  std::string command;  // the options of the run, as on the command line
  // One sentence on where the closures come from; when simulated, it says so and gives the rule.
  std::string closures_note;
  bool closures_simulated = false;
  // Name and value of what steered the run (strategy, n, metric, ...), for people.
  std::vector<std::pair<std::string, std::string>> settings;
  uint64_t revision = 0;  // of the server's final map
  int components = 0;     // of that map; 1: all robots are tied together
  double wall_time_s = 0;
  std::vector<RobotResult> robots;
  std::vector<ClosureResult> closures;
  std::vector<RelationErrors> relations;  // of each estimate; empty: no relations were given
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_RUN_RESULT_H_
