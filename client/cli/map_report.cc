// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/map_report.h"

#include <algorithm>
#include <optional>
#include <sstream>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "overtone/client/cli/closure_names.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/geometry/trajectory_io.h"
#include "overtone/proto/conversion/geometry_conversion.h"
#include "overtone/proto/conversion/id_conversion.h"

namespace overtone {
namespace {

absl::Status AddPoses(const v1::GetTrajectoryResponse& response, RobotResult& robot) {
  for (const v1::Node& node : response.nodes()) {
    robot.stamps.push_back({node.stamp_ns()});
    ASSIGN_OR_RETURN(Rigid3d pose, FromProto(node.map_tform_body()));
    robot.server.push_back(std::move(pose));
  }
  for (const v1::Pose& odometry : response.odometry()) {
    ASSIGN_OR_RETURN(Rigid3d pose, FromProto(odometry));
    robot.onboard.push_back(std::move(pose));
  }
  return absl::OkStatus();
}

// The way for those that do not fit into a message.
absl::Status AddExportedPoses(AdminClient& client, const std::string& map, const MissionId& mission,
                              RobotResult& robot) {
  v1::ExportMapRequest request;
  request.set_map(map);
  request.set_format(v1::EXPORT_FORMAT_EUROC);
  *request.mutable_mission() = ToProto(mission);
  std::stringstream text;
  RETURN_IF_ERROR(client.ExportMap(request, [&text](const std::string& chunk) {
    text << chunk;
    return absl::OkStatus();
  }));
  ASSIGN_OR_RETURN(const Trajectory trajectory,
                   ReadTrajectory(text, ToString(mission), TrajectoryFormat::kEuroc));
  robot.stamps = Stamps(trajectory);
  robot.server = Poses(trajectory);
  return absl::OkStatus();
}

// Nothing of it must be right: it is a robot's word, and only shown.
void AddReport(const v1::StatusReport& report, RobotResult& robot) {
  if (!report.has_comparison()) return;
  const v1::ComparisonReport& said = report.comparison();
  ComparisonRecord record;
  const Timestamp time = {said.time().seconds() * 1'000'000'000 + said.time().nanos()};
  if (!robot.stamps.empty()) record.time_s = SecondsBetween(robot.stamps.front(), time);
  record.revision = said.revision();
  record.compare_ms = 1e3 * said.duration_s();
  const int rows =
      std::min({said.index_size(), said.small_size(), said.mid_size(), said.large_size()});
  record.discrepancy.resize(rows, 3);
  for (int row = 0; row < rows; ++row) {
    record.keyframe_index.push_back(said.index(row));
    record.discrepancy.row(row) << said.large(row), said.mid(row), said.small(row);
  }
  robot.comparisons.push_back(std::move(record));
  static constexpr ConstraintKind kKinds[] = {ConstraintKind::kSmall, ConstraintKind::kMid,
                                              ConstraintKind::kLarge, ConstraintKind::kDegenerate,
                                              ConstraintKind::kChord};
  for (const v1::ConstraintEnds& ends : said.largest()) {
    if (ends.kind() < v1::CONSTRAINT_KIND_SMALL || ends.kind() > v1::CONSTRAINT_KIND_CHORD) {
      continue;  // a newer robot's
    }
    Constraint constraint;
    constraint.kind = kKinds[ends.kind() - v1::CONSTRAINT_KIND_SMALL];
    constraint.from = ends.from();
    constraint.to = ends.to();
    constraint.score = ends.score();
    constraint.id = ConstraintId(constraint.kind, constraint.from, constraint.to);
    robot.active_constraints.push_back(std::move(constraint));
  }
}

absl::StatusOr<RobotResult> FetchMission(AdminClient& client, const std::string& map,
                                         const v1::Mission& mission, uint64_t& revision) {
  ASSIGN_OR_RETURN(const MissionId id, FromProto(mission.id()));
  RobotResult robot;
  robot.name = ToString(id);
  robot.anchored = mission.anchored();
  robot.path_m = mission.path_m();
  robot.duration_s =
      SecondsBetween(Timestamp{mission.first_stamp_ns()}, Timestamp{mission.last_stamp_ns()});
  const absl::StatusOr<v1::GetTrajectoryResponse> trajectory =
      client.GetTrajectory(map, id, /*odometry=*/true);
  if (trajectory.ok()) {
    RETURN_IF_ERROR(AddPoses(*trajectory, robot));
    revision = std::max(revision, trajectory->revision());
  } else if (absl::IsResourceExhausted(trajectory.status())) {
    RETURN_IF_ERROR(AddExportedPoses(client, map, id, robot));
  } else {
    return trajectory.status();
  }
  const absl::StatusOr<v1::StatusReport> report = client.GetStatusReport(map, id);
  if (report.ok()) {
    AddReport(*report, robot);
  } else if (!absl::IsNotFound(report.status()) && !absl::IsUnimplemented(report.status())) {
    return report.status();
  }
  return robot;
}

absl::StatusOr<ClosureResult> ClosureOf(const v1::LoopClosureStatus& status) {
  ClosureResult closure;
  ASSIGN_OR_RETURN(closure.closure.from, FromProto(status.loop_closure().from()));
  ASSIGN_OR_RETURN(closure.closure.to, FromProto(status.loop_closure().to()));
  for (NodeId* node : {&closure.closure.from, &closure.closure.to}) {
    node->mission.robot = ToString(node->mission);  // RobotResult::name
  }
  closure.proposer = ProposerName(status.proposer());
  closure.measured = status.measured();
  closure.score = status.score();
  closure.verdict = VerdictName(status.verdict());
  closure.weight = status.weight();
  closure.chi_square = status.chi_square();
  return closure;
}

std::string TimeText(const google::protobuf::Timestamp& time) {
  return absl::FormatTime("%Y-%m-%d %H:%M:%S UTC", absl::FromUnixSeconds(time.seconds()),
                          absl::UTCTimeZone());
}

}  // namespace

absl::StatusOr<RunResult> FetchMap(AdminClient& client, const std::string& map) {
  ASSIGN_OR_RETURN(const v1::MapSummary summary, client.GetMap(map));
  RunResult result;
  result.live = true;
  result.dataset = absl::StrCat("map ", map);
  result.revision = summary.revision();
  result.components = summary.components();
  ASSIGN_OR_RETURN(const std::vector<v1::Mission> missions, client.ListMissions(map));
  for (const v1::Mission& mission : missions) {
    ASSIGN_OR_RETURN(RobotResult robot, FetchMission(client, map, mission, result.revision));
    result.robots.push_back(std::move(robot));
  }
  ASSIGN_OR_RETURN(const std::vector<v1::LoopClosureStatus> closures, client.ListLoopClosures(map));
  for (const v1::LoopClosureStatus& status : closures) {
    ASSIGN_OR_RETURN(ClosureResult closure, ClosureOf(status));
    result.closures.push_back(std::move(closure));
  }
  result.settings = {{"map", map},
                     {"map epoch", absl::StrCat(summary.map_epoch())},
                     {"revision", absl::StrCat(summary.revision())},
                     {"published", TimeText(summary.published())},
                     {"clouds", absl::StrCat(summary.clouds())},
                     {"landmarks", absl::StrCat(summary.landmarks())}};
  return result;
}

}  // namespace overtone
