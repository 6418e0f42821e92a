// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/closure_judgement.h"

#include <algorithm>
#include <cmath>

#include "Eigen/Eigenvalues"
#include "overtone/client/cli/key_values.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

const RobotPlan* FindPlan(const std::vector<RobotPlan>& plans, const MissionId& id) {
  const auto plan = std::find_if(plans.begin(), plans.end(),
                                 [&id](const RobotPlan& plan) { return plan.id == id; });
  return plan == plans.end() ? nullptr : &*plan;
}

// Where the ground truth does not know a keyframe, the nearest that it knows within this way and
// the odometry between.
constexpr double kMaxCarry_m = 3;

// The ground truth of keyframe `index`, carried from a neighbour if need be.
std::optional<Rigid3d> KnownPose(const RobotPlan& plan, int64_t index) {
  const auto count = static_cast<int64_t>(plan.ground_truth.size());
  // Without rotations there is nothing to carry along.
  if (plan.ground_truth_positions_only) return plan.ground_truth[index];
  const Rigid3d& here = plan.keyframes[index].mission_from_body;
  for (int64_t step = 0; step < count; ++step) {
    bool near = false;
    for (const int64_t other : {index - step, index + step}) {
      if (other < 0 || other >= count) continue;
      const Rigid3d between = plan.keyframes[other].mission_from_body.Inverse() * here;
      if (between.translation.norm() > kMaxCarry_m) continue;
      near = true;
      if (plan.ground_truth[other].has_value()) return *plan.ground_truth[other] * between;
    }
    if (!near) break;
  }
  return std::nullopt;
}

// In the frame that both robots of a closure share.
std::optional<Rigid3d> TruePose(const RobotPlan& plan, int64_t index, bool common) {
  if (index < 0 || index >= static_cast<int64_t>(plan.ground_truth.size())) return std::nullopt;
  const std::optional<Rigid3d> pose = KnownPose(plan, index);
  if (!pose.has_value() || !common) return pose;
  if (!plan.common_from_world.has_value()) return std::nullopt;
  return *plan.common_from_world * *pose;
}

// Without what the measurement itself leaves open, as a corridor does along its axis.
Eigen::Vector3d MeasuredPart(const Eigen::Vector3d& error, const Matrix6d& covariance) {
  constexpr double kOpenSigma_m = 10;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(
      Eigen::Matrix3d(covariance.topLeftCorner<3, 3>()));
  Eigen::Vector3d measured = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    if (axes.eigenvalues()[i] > kOpenSigma_m * kOpenSigma_m) continue;
    measured += error.dot(axes.eigenvectors().col(i)) * axes.eigenvectors().col(i);
  }
  return measured;
}

bool InUse(const ClosureResult& closure) {
  return closure.verdict == "accepted" || closure.verdict == "forced_by_operator";
}

}  // namespace

absl::StatusOr<ClosureTolerance> ParseClosureTolerance(absl::string_view text) {
  ClosureTolerance tolerance;
  RETURN_IF_ERROR(ParseKeyValues(text, {{"translation", &tolerance.translation_m},
                                        {"rotation", &tolerance.rotation_rad},
                                        {"place", &tolerance.place_m}}));
  if (!(tolerance.translation_m > 0 && tolerance.rotation_rad > 0 && tolerance.place_m > 0)) {
    return absl::InvalidArgumentError("translation, rotation and place must be > 0");
  }
  return tolerance;
}

std::optional<ClosureTruth> JudgeClosure(const LoopClosure& closure, bool measured,
                                         const std::vector<RobotPlan>& plans,
                                         const ClosureTolerance& tolerance) {
  const RobotPlan* from_plan = FindPlan(plans, closure.from.mission);
  const RobotPlan* to_plan = FindPlan(plans, closure.to.mission);
  if (from_plan == nullptr || to_plan == nullptr) return std::nullopt;
  const bool common = from_plan != to_plan;
  const std::optional<Rigid3d> from = TruePose(*from_plan, closure.from.index, common);
  const std::optional<Rigid3d> to = TruePose(*to_plan, closure.to.index, common);
  if (!from.has_value() || !to.has_value()) return std::nullopt;

  const Rigid3d from_tform_to = from->Inverse() * *to;
  ClosureTruth truth;
  truth.distance_m = from_tform_to.translation.norm();
  truth.same_place = truth.distance_m <= tolerance.place_m;
  if (!measured) return truth;
  if (from_plan->ground_truth_positions_only || to_plan->ground_truth_positions_only) {
    truth.error_m = std::abs(closure.from_tform_to.translation.norm() - truth.distance_m);
  } else {
    const Rigid3d error = from_tform_to.Inverse() * closure.from_tform_to;
    truth.error_m = MeasuredPart(error.translation, closure.covariance).norm();
    truth.error_rad = LogSO3(error.rotation).norm();
  }
  truth.right = *truth.error_m <= tolerance.translation_m &&
                truth.error_rad.value_or(0) <= tolerance.rotation_rad;
  truth.same_place |= truth.right;
  return truth;
}

std::optional<double> ClosureScore::Precision() const {
  if (accepted_judged == 0) return std::nullopt;
  return 1 - static_cast<double>(accepted_wrong) / accepted_judged;
}

std::optional<double> ClosureScore::Recall() const {
  if (same_place == 0) return std::nullopt;
  return static_cast<double>(accepted_judged - accepted_wrong) / same_place;
}

std::map<std::string, ClosureScore> ScoreClosures(const std::vector<ClosureResult>& closures) {
  std::map<std::string, ClosureScore> scores;
  for (const ClosureResult& closure : closures) {
    ClosureScore& score = scores[closure.proposer];
    ClosureScore::Count& count = score.verdicts[closure.verdict];
    ++score.proposed;
    ++count.all;
    score.accepted += InUse(closure);
    if (!closure.truth.has_value()) continue;
    ++score.judged;
    score.same_place += closure.truth->same_place;
    count.same_place += closure.truth->same_place;
    score.accepted_judged += InUse(closure);
    score.accepted_wrong += InUse(closure) && !closure.truth->right;
  }
  return scores;
}

}  // namespace overtone
