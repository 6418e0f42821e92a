// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/relation_evaluation.h"

#include <algorithm>
#include <map>
#include <numeric>

namespace overtone {
namespace {

struct Estimate {
  const char* name;
  std::vector<Rigid3d> RobotResult::*trajectory;
  bool shared;  // robots that are anchored are in one frame
};

constexpr Estimate kEstimates[] = {{"onboard", &RobotResult::onboard, false},
                                   {"server", &RobotResult::server, true},
                                   {"corrected", &RobotResult::corrected, false}};

double Mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double Median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

bool InOneFrame(const RobotResult& from, const RobotResult& to, const Estimate& estimate) {
  return &from == &to || (estimate.shared && from.anchored && to.anchored);
}

RelationErrors Evaluate(const Estimate& estimate, const std::vector<LoopClosure>& relations,
                        const std::map<MissionId, const RobotResult*>& robots) {
  RelationErrors errors;
  errors.estimate = estimate.name;
  std::vector<double> translations, rotations;
  for (const LoopClosure& relation : relations) {
    const RobotResult& from = *robots.at(relation.from.mission);
    const RobotResult& to = *robots.at(relation.to.mission);
    const auto& from_poses = from.*estimate.trajectory;
    const auto& to_poses = to.*estimate.trajectory;
    if (!InOneFrame(from, to, estimate) ||
        relation.from.index >= static_cast<int64_t>(from_poses.size()) ||
        relation.to.index >= static_cast<int64_t>(to_poses.size())) {
      continue;
    }
    const Rigid3d error =
        (from_poses[relation.from.index].Inverse() * to_poses[relation.to.index]).Inverse() *
        relation.from_tform_to;
    translations.push_back(error.translation.norm());
    rotations.push_back(LogSO3(error.rotation).norm());
  }
  errors.count = static_cast<int>(translations.size());
  if (errors.count == 0) return errors;
  errors.translation_mean_m = Mean(translations);
  errors.translation_median_m = Median(translations);
  errors.rotation_mean_rad = Mean(rotations);
  errors.rotation_median_rad = Median(rotations);
  return errors;
}

}  // namespace

std::vector<RelationErrors> EvaluateRelations(const std::vector<LoopClosure>& relations,
                                              const std::vector<RobotPlan>& plans,
                                              const std::vector<RobotResult>& robots) {
  std::vector<RelationErrors> errors;
  if (relations.empty()) return errors;
  std::map<MissionId, const RobotResult*> by_mission;
  for (size_t i = 0; i < plans.size(); ++i) by_mission[plans[i].id] = &robots[i];
  for (const Estimate& estimate : kEstimates) {
    errors.push_back(Evaluate(estimate, relations, by_mission));
  }
  return errors;
}

}  // namespace overtone
