// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/replay_record.h"

#include <algorithm>
#include <array>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "overtone/client/cli/closure_judgement.h"
#include "overtone/client/cli/closure_names.h"
#include "overtone/client/cli/evaluation.h"
#include "overtone/client/cli/relation_evaluation.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/geometry_conversion.h"
#include "overtone/proto/conversion/id_conversion.h"
#include "overtone/proto/conversion/submap_conversion.h"

namespace overtone {
namespace {

RobotResult StartOf(const RobotPlan& plan) {
  RobotResult robot;
  robot.name = plan.name;
  for (const Keyframe& keyframe : plan.keyframes) {
    robot.stamps.push_back(keyframe.stamp);
    robot.onboard.push_back(keyframe.mission_from_body);
  }
  robot.ground_truth = plan.ground_truth;
  robot.ground_truth_positions_only = plan.ground_truth_positions_only;
  robot.path_m = plan.path_m;
  robot.duration_s = plan.TimeOf(static_cast<int>(plan.keyframes.size()) - 1);
  return robot;
}

ComparisonRecord ComparisonFromJson(const Json& answer) {
  ComparisonRecord record;
  record.time_s = answer.at("time_s").get<double>();
  record.revision = answer.at("revision").get<uint64_t>();
  record.compare_ms = answer.at("compare_ms").get<double>();
  record.keyframe_index = answer.at("keyframe_index").get<std::vector<int64_t>>();
  const auto rows = answer.at("discrepancy").get<std::vector<std::array<double, 3>>>();
  record.discrepancy.resize(rows.size(), 3);
  for (size_t row = 0; row < rows.size(); ++row) {
    record.discrepancy.row(row) << rows[row][0], rows[row][1], rows[row][2];
  }
  return record;
}

std::optional<double> Rmse(const std::optional<TrajectoryError>& error) {
  return error.has_value() ? std::optional<double>(error->rmse_m) : std::nullopt;
}

// A closure's ends, and its relative pose where there is one. What was never measured need not be a
// valid measurement.
absl::StatusOr<LoopClosure> ClosureOf(const v1::LoopClosureStatus& status, bool measured) {
  if (measured) return FromProto(status.loop_closure());
  LoopClosure closure;
  ASSIGN_OR_RETURN(closure.from, FromProto(status.loop_closure().from()));
  ASSIGN_OR_RETURN(closure.to, FromProto(status.loop_closure().to()));
  return closure;
}

}  // namespace

ReplayRecord::ReplayRecord(const ReplayInput& input)
    : input_(input), known_constraints_(input.plans.size()) {
  for (const RobotPlan& plan : input.plans) {
    result_.robots.push_back(StartOf(plan));
    duration_s_ = std::max(duration_s_, result_.robots.back().duration_s);
  }
  result_.closures_note = input.closures_note;
  result_.closures_simulated = input.closures_simulated;
}

absl::Status ReplayRecord::Add(const std::vector<Json>& answers) {
  for (size_t i = 0; i < answers.size(); ++i) {
    absl::Status status;
    try {
      status = AddAnswer(answers[i], input_.plans[i], &result_.robots[i]);
    } catch (const std::exception& error) {
      status = absl::InternalError(error.what());
    }
    if (!status.ok()) {
      return absl::InternalError(
          absl::StrCat("robot ", input_.plans[i].name, " answered: ", status.message()));
    }
  }
  return absl::OkStatus();
}

absl::Status ReplayRecord::AddAnswer(const Json& answer, const RobotPlan& plan,
                                     RobotResult* robot) {
  robot->bytes_up = answer.at("bytes_up").get<int64_t>();
  robot->bytes_down = answer.at("bytes_down").get<int64_t>();
  robot->corrected.clear();
  for (const Json& pose : answer.at("trajectory")) robot->corrected.push_back(PoseFromJson(pose));
  if (robot->corrected.size() > plan.keyframes.size()) {
    return absl::InternalError("more poses than keyframes");
  }
  if (answer.contains("skipped")) return absl::OkStatus();

  ComparisonRecord comparison = ComparisonFromJson(answer);
  robot->graph_nodes = static_cast<int>(comparison.keyframe_index.size());
  auto& known = known_constraints_[&plan - input_.plans.data()];
  for (const Json& change : answer.at("changes")) {
    ConstraintRecord record = ConstraintRecordFromJson(change);
    if (record.action == ConstraintAction::kRetract) {
      const uint64_t revision = record.constraint.revision;
      record.constraint = known[record.constraint.id];  // its kind and nodes
      record.constraint.revision = revision;
    }
    known[record.constraint.id] = record.constraint;
    comparison.added += record.action == ConstraintAction::kAdd;
    comparison.updated += record.action == ConstraintAction::kUpdate;
    comparison.retracted += record.action == ConstraintAction::kRetract;
    robot->constraints.push_back(std::move(record));
  }
  const std::vector<Rigid3d> onboard(robot->onboard.begin(),
                                     robot->onboard.begin() + robot->corrected.size());
  comparison.onboard_rmse_m = Rmse(ErrorAgainst(onboard, plan.ground_truth));
  comparison.corrected_rmse_m = Rmse(ErrorAgainst(robot->corrected, plan.ground_truth));
  robot->comparisons.push_back(std::move(comparison));
  return absl::OkStatus();
}

std::string ReplayRecord::ProgressLine(double time_s, uint64_t revision) const {
  std::string line =
      absl::StrFormat("%6.0f s of %.0f s, revision %d; constraints so far, corrected RMSE:", time_s,
                      duration_s_, revision);
  for (const RobotResult& robot : result_.robots) {
    absl::StrAppend(&line, "  ", robot.name, " ", ActiveConstraints(robot.constraints).size());
    if (!robot.comparisons.empty() && robot.comparisons.back().corrected_rmse_m.has_value()) {
      absl::StrAppendFormat(&line, " %.3f m", *robot.comparisons.back().corrected_rmse_m);
    }
  }
  return line;
}

absl::StatusOr<RunResult> ReplayRecord::Finish(AdminClient* admin, const std::string& map) {
  for (size_t i = 0; i < result_.robots.size(); ++i) {
    RobotResult& robot = result_.robots[i];
    RETURN_IF_ERROR(FetchTrajectory(admin, map, input_.plans[i], &robot));
    robot.active_constraints = ActiveConstraints(robot.constraints);
    Evaluate(&robot);
  }
  result_.relations = EvaluateRelations(input_.relations, input_.plans, result_.robots);
  RETURN_IF_ERROR(FetchClosures(admin, map));
  ASSIGN_OR_RETURN(const v1::MapSummary summary, admin->GetMap(map));
  result_.components = summary.components();
  return result_;
}

absl::Status ReplayRecord::FetchTrajectory(AdminClient* admin, const std::string& map,
                                           const RobotPlan& plan, RobotResult* robot) {
  ASSIGN_OR_RETURN(const v1::GetTrajectoryResponse response, admin->GetTrajectory(map, plan.id));
  result_.revision = response.revision();
  robot->anchored = response.anchored();
  robot->server.clear();
  for (const v1::Node& node : response.nodes()) {
    ASSIGN_OR_RETURN(const Rigid3d map_from_body, FromProto(node.map_tform_body()));
    robot->server.push_back(map_from_body);
  }
  if (robot->server.size() != plan.keyframes.size()) {
    return absl::InternalError(absl::StrCat("the server holds ", robot->server.size(), " of the ",
                                            plan.keyframes.size(), " keyframes of ", plan.name));
  }
  return absl::OkStatus();
}

// Verdicts on what the robots of this run reported and on what the server proposed between them, in
// the order the server received them.
absl::Status ReplayRecord::FetchClosures(AdminClient* admin, const std::string& map) {
  std::map<MissionId, std::string> names;
  for (const RobotPlan& plan : input_.plans) names[plan.id] = plan.name;
  std::map<std::pair<NodeId, NodeId>, const InputClosure*> ours;
  for (const InputClosure& closure : input_.closures) {
    ours[{closure.closure.from, closure.closure.to}] = &closure;
  }
  ASSIGN_OR_RETURN(const std::vector<v1::LoopClosureStatus> closures, admin->ListLoopClosures(map));
  result_.closures.clear();
  for (const v1::LoopClosureStatus& status : closures) {
    const bool by_robot = status.proposer() == v1::LOOP_CLOSURE_PROPOSER_ROBOT ||
                          status.proposer() == v1::LOOP_CLOSURE_PROPOSER_UNSPECIFIED;
    ClosureResult row;
    row.measured = by_robot || status.measured();
    ASSIGN_OR_RETURN(row.closure, ClosureOf(status, row.measured));
    // A map may hold more than this run.
    if (names.count(row.closure.from.mission) == 0 || names.count(row.closure.to.mission) == 0) {
      continue;
    }
    const auto origin = ours.find({row.closure.from, row.closure.to});
    if (by_robot && origin == ours.end()) continue;
    row.proposer = ProposerName(by_robot ? v1::LOOP_CLOSURE_PROPOSER_ROBOT : status.proposer());
    row.score = status.score();
    row.verdict = VerdictName(status.verdict());
    row.weight = status.weight();
    row.chi_square = status.chi_square();
    if (status.has_registration()) {
      const v1::RegistrationFigures& figures = status.registration();
      row.registration = {figures.overlap(), figures.residual_m(), figures.open_directions()};
    }
    row.simulated = by_robot && origin->second->simulated;
    row.outlier = by_robot && origin->second->outlier;
    row.truth = JudgeClosure(row.closure, row.measured, input_.plans, input_.closure_tolerance);
    row.closure.from.mission.robot = names.at(row.closure.from.mission);
    row.closure.to.mission.robot = names.at(row.closure.to.mission);
    result_.closures.push_back(std::move(row));
  }
  return absl::OkStatus();
}

}  // namespace overtone
