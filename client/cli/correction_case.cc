// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/correction_case.h"

#include <utility>

#include "Eigen/Cholesky"
#include "absl/strings/str_cat.h"
#include "overtone/client/cli/evaluation.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/synchronization/aligned_rmse.h"
#include "overtone/core/synchronization/chain_smoother.h"
#include "overtone/core/synchronization/wavelet_discrepancy.h"

namespace overtone {
namespace {

constexpr int kKeyframesPerSubmap = 50;

MapGraph GraphOf(const RobotPlan& plan, const std::vector<Rigid3d>& server) {
  MapMission mission;
  mission.id = plan.id;
  for (int i = 0; i < plan.keyframes.size(); ++i) {
    MapNode node;
    node.index = i;
    node.stamp = plan.keyframes[i].stamp;
    node.map_from_body = server[i];
    node.submap_start = i % kKeyframesPerSubmap == 0;
    node.degenerate = plan.keyframes[i].degenerate;
    mission.nodes.push_back(node);
  }
  MapGraph graph;
  graph.revision = 1;
  graph.missions = {mission};
  return graph;
}

}  // namespace

absl::StatusOr<CorrectionCase> MakeCorrectionCase(const std::string& sequence,
                                                  const RobotPlan& plan, const RobotResult& robot,
                                                  const SynchronizationOptions& options) {
  if (robot.server.size() != plan.keyframes.size() || !robot.onboard_error.has_value() ||
      !robot.server_error.has_value()) {
    return absl::FailedPreconditionError(
        absl::StrCat(robot.name, ": no ground truth, or no estimate of the server's"));
  }
  CorrectionCase result;
  result.sequence = sequence;
  result.robot = robot.name;
  result.keyframes = plan.keyframes;
  result.ground_truth = plan.ground_truth;
  result.onboard_rmse_m = robot.onboard_error->rmse_m;
  result.server_rmse_m = robot.server_error->rmse_m;
  result.bytes_down = robot.bytes_down;
  std::vector<NodePose> onboard;
  for (int i = 0; i < plan.keyframes.size(); ++i) {
    const Keyframe& keyframe = plan.keyframes[i];
    onboard.push_back({i, keyframe.stamp, keyframe.mission_from_body});
    result.context.odometry.push_back(keyframe.mission_from_body);
    result.context.step_covariance.push_back(keyframe.motion_covariance);
  }
  ASSIGN_OR_RETURN(result.comparison,
                   CompareTrajectories(GraphOf(plan, robot.server), plan.id, onboard, options));
  return result;
}

absl::StatusOr<CorrectionOutcome> Correct(const CorrectionCase& correction_case,
                                          const std::vector<Constraint>& constraints) {
  std::vector<Rigid3d> poses;
  std::vector<OdometryStep> odometry;
  for (const Keyframe& keyframe : correction_case.keyframes) {
    OdometryStep step;
    if (!poses.empty()) {
      step.previous_from_this = poses.back().Inverse() * keyframe.mission_from_body;
      step.covariance = keyframe.motion_covariance;
      step.information = step.covariance.llt().solve(Matrix6d::Identity());
    }
    odometry.push_back(step);
    poses.push_back(keyframe.mission_from_body);
  }
  std::vector<Chord> chords;
  for (const Constraint& constraint : constraints) {
    Chord chord;
    chord.from = static_cast<int>(constraint.from);
    chord.to = static_cast<int>(constraint.to);
    chord.from_tform_to = constraint.from_tform_to;
    chord.information = constraint.covariance.llt().solve(Matrix6d::Identity());
    chords.push_back(chord);
  }
  ASSIGN_OR_RETURN(const ChainSmootherResult smoothed,
                   SmoothChain(poses, odometry, chords, ChainSmootherOptions()));
  CorrectionOutcome outcome;
  outcome.to_server_m = AlignedRmse(smoothed.poses, correction_case.comparison.server);
  const auto error = ErrorAgainst(smoothed.poses, correction_case.ground_truth);
  if (error.has_value()) outcome.rmse_m = error->rmse_m;
  outcome.factor_nonzeros = smoothed.factor_non_zeros;
  return outcome;
}

}  // namespace overtone
