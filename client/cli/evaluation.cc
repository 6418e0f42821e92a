// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/evaluation.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

namespace overtone {

std::optional<TrajectoryError> ErrorAgainst(
    const std::vector<Rigid3d>& estimate, const std::vector<std::optional<Rigid3d>>& ground_truth) {
  std::vector<Rigid3d> known_estimate, known_truth;
  for (size_t i = 0; i < std::min(estimate.size(), ground_truth.size()); ++i) {
    if (!ground_truth[i].has_value()) continue;
    known_estimate.push_back(estimate[i]);
    known_truth.push_back(*ground_truth[i]);
  }
  absl::StatusOr<TrajectoryError> error = AbsoluteTrajectoryError(known_estimate, known_truth);
  if (!error.ok()) return std::nullopt;
  return *std::move(error);
}

void Evaluate(RobotResult* robot) {
  robot->onboard_error = ErrorAgainst(robot->onboard, robot->ground_truth);
  robot->server_error = ErrorAgainst(robot->server, robot->ground_truth);
  robot->corrected_error = ErrorAgainst(robot->corrected, robot->ground_truth);
}

std::vector<Constraint> ActiveConstraints(const std::vector<ConstraintRecord>& records) {
  std::map<std::string, Constraint> active;
  for (const ConstraintRecord& record : records) {
    if (record.action == ConstraintAction::kRetract) {
      active.erase(record.constraint.id);
    } else {
      active[record.constraint.id] = record.constraint;
    }
  }
  std::vector<Constraint> result;
  for (const auto& [id, constraint] : active) result.push_back(constraint);
  return result;
}

double CompareQuantile(const RobotResult& robot, double p) {
  std::vector<double> times;
  for (const ComparisonRecord& comparison : robot.comparisons) {
    times.push_back(comparison.compare_ms);
  }
  if (times.empty()) return 0;
  std::sort(times.begin(), times.end());
  const int rank = static_cast<int>(std::ceil(p * static_cast<double>(times.size())));
  return times[std::clamp<int>(rank - 1, 0, static_cast<int>(times.size()) - 1)];
}

}  // namespace overtone
