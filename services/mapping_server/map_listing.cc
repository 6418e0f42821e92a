// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/map_listing.h"

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/field_path.h"
#include "overtone/proto/conversion/geometry_conversion.h"
#include "overtone/proto/conversion/id_conversion.h"
#include "overtone/proto/conversion/proto_time.h"
#include "overtone/services/mapping_server/closure_messages.h"
#include "overtone/services/mapping_server/pagination.h"

namespace overtone {
namespace {

v1::MapSummary Summary(const HostedMap& map) {
  const int64_t backlog = map.backlog();  // before the revision: 0 must mean that it holds all
  const HostedMap::Published published = map.published();
  const MapSnapshot& snapshot = *published.snapshot;
  v1::MapSummary summary;
  summary.set_map(map.id());
  summary.set_map_epoch(snapshot.map_epoch);
  summary.set_revision(snapshot.revision);
  summary.set_missions(static_cast<int32_t>(snapshot.missions.size()));
  int64_t keyframes = 0;
  int components = 0;
  for (const SnapshotMission& mission : snapshot.missions) {
    keyframes += static_cast<int64_t>(mission.keyframes.size());
    components = std::max(components, mission.component + 1);
  }
  summary.set_keyframes(keyframes);
  summary.set_components(components);
  summary.set_loop_closures(static_cast<int64_t>(snapshot.closures.size()));
  if (snapshot.revision > 0) *summary.mutable_published() = ToProto(published.time);
  summary.set_cost(snapshot.final_cost);
  summary.set_optimisation_s(snapshot.optimisation_s);
  summary.set_front_end_backlog(backlog);
  summary.set_landmarks(static_cast<int32_t>(snapshot.landmarks.size()));
  std::map<ClosureVerdict, int64_t> verdicts;
  for (const ClosureRecord& record : snapshot.closures) ++verdicts[record.verdict];
  *summary.mutable_verdicts() = ToProto(verdicts);
  const CloudCounts clouds = map.store().Clouds();
  summary.set_clouds(clouds.stored);
  summary.set_missing_blobs(clouds.missing);
  return summary;
}

struct RobotTotals {
  int missions = 0;
  int64_t keyframes = 0;
  absl::Time stored_at = absl::InfinitePast();
};

std::map<std::string, RobotTotals> TotalsByRobot(const HostedMap& map) {
  std::map<std::string, RobotTotals> robots;
  for (const auto& [id, state] : map.store().Missions()) {
    RobotTotals& totals = robots[id.robot];
    ++totals.missions;
    totals.keyframes += state.next_index;
    totals.stored_at = std::max(totals.stored_at, state.stored_at);
  }
  return robots;
}

// Traffic and the last report, without the columns of the comparison.
void AddLink(HostedMap& map, v1::Robot& robot) {
  if (const auto counters = map.traffic().Find(robot.robot())) {
    robot.set_bytes_received(counters->bytes_received);
    robot.set_bytes_sent(counters->bytes_sent);
    robot.set_watching(counters->watches > 0);
    robot.set_revision_sent(counters->revision_sent);
  }
  if (const StatusReports::Report report = map.reports().Newest(robot.robot())) {
    *robot.mutable_report() = *report;
    if (!report->has_comparison()) return;
    v1::ComparisonReport& comparison = *robot.mutable_report()->mutable_comparison();
    comparison.clear_index();
    comparison.clear_small();
    comparison.clear_mid();
    comparison.clear_large();
    comparison.clear_largest();
  }
}

double PathLengthM(const SnapshotMission& mission) {
  double length_m = 0;
  for (size_t i = 1; i < mission.map_from_body.size(); ++i) {
    length_m +=
        (mission.map_from_body[i].translation - mission.map_from_body[i - 1].translation).norm();
  }
  return length_m;
}

v1::Mission Describe(const SnapshotMission& mission) {
  v1::Mission message;
  *message.mutable_id() = ToProto(mission.id);
  message.set_anchored(mission.anchored);
  message.set_component(mission.component);
  message.set_submaps(static_cast<int64_t>(mission.submap_starts.size()));
  message.set_keyframes(static_cast<int64_t>(mission.keyframes.size()));
  if (!mission.keyframes.empty()) {
    message.set_first_stamp_ns(mission.keyframes.front().stamp.ns);
    message.set_last_stamp_ns(mission.keyframes.back().stamp.ns);
  }
  message.set_path_m(PathLengthM(mission));
  *message.mutable_map_tform_mission() = ToProto(mission.map_from_mission);
  return message;
}

// "robot mission": the blank sorts before every character of an id, so keys sort as ids do.
std::string Key(const MissionId& id) { return absl::StrCat(id.robot, " ", id.mission); }

absl::Status ValidateRobotFilter(const std::string& robot) {
  return robot.empty() ? absl::OkStatus() : ValidateId(robot, "robot");
}

v1::Node Describe(const SnapshotMission& mission, size_t index, bool submap_start) {
  v1::Node node;
  node.set_index(static_cast<int64_t>(index));
  node.set_stamp_ns(mission.keyframes[index].stamp.ns);
  *node.mutable_map_tform_body() = ToProto(mission.map_from_body[index]);
  node.set_submap_start(submap_start);
  node.set_degenerate(mission.keyframes[index].degenerate);
  return node;
}

}  // namespace

absl::StatusOr<v1::ListMapsResponse> ListMaps(
    const MapRegistry& registry, const std::function<bool(const std::string& map)>& visible,
    const v1::ListMapsRequest& request) {
  std::vector<std::shared_ptr<HostedMap>> maps = registry.List();
  const auto is_hidden = [&](const auto& map) { return !visible(map->id()); };
  maps.erase(std::remove_if(maps.begin(), maps.end(), is_hidden), maps.end());
  std::vector<std::string> keys;
  for (const std::shared_ptr<HostedMap>& map : maps) keys.push_back(map->id());
  ASSIGN_OR_RETURN(Page page, SelectPage(keys, request.page_size(), request.page_token()));
  v1::ListMapsResponse response;
  for (size_t i = page.begin; i < page.end; ++i) *response.add_maps() = Summary(*maps[i]);
  response.set_next_page_token(page.next_page_token);
  return response;
}

absl::StatusOr<v1::ListRobotsResponse> ListRobots(const MapRegistry& registry,
                                                  const UploadSessions& sessions,
                                                  const v1::ListRobotsRequest& request) {
  ASSIGN_OR_RETURN(const std::shared_ptr<HostedMap> map, registry.Find(request.map()));
  const std::map<std::string, RobotTotals> robots = TotalsByRobot(*map);
  std::vector<std::string> keys;
  for (const auto& [robot, totals] : robots) keys.push_back(robot);
  ASSIGN_OR_RETURN(Page page, SelectPage(keys, request.page_size(), request.page_token()));
  v1::ListRobotsResponse response;
  for (size_t i = page.begin; i < page.end; ++i) {
    const RobotTotals& totals = robots.at(keys[i]);
    v1::Robot& robot = *response.add_robots();
    robot.set_robot(keys[i]);
    robot.set_missions(totals.missions);
    robot.set_keyframes(totals.keyframes);
    robot.set_uploading(sessions.IsOpen(map->id(), keys[i]));
    *robot.mutable_last_upload() = ToProto(totals.stored_at);
    AddLink(*map, robot);
  }
  response.set_next_page_token(page.next_page_token);
  return response;
}

absl::StatusOr<v1::ListMissionsResponse> ListMissions(const MapRegistry& registry,
                                                      const v1::ListMissionsRequest& request) {
  ASSIGN_OR_RETURN(const std::shared_ptr<HostedMap> map, registry.Find(request.map()));
  RETURN_IF_ERROR(ValidateRobotFilter(request.robot()));
  const std::shared_ptr<const MapSnapshot> snapshot = map->published().snapshot;
  std::vector<const SnapshotMission*> missions;
  std::vector<std::string> keys;
  for (const SnapshotMission& mission : snapshot->missions) {
    if (!request.robot().empty() && mission.id.robot != request.robot()) continue;
    missions.push_back(&mission);
    keys.push_back(Key(mission.id));
  }
  ASSIGN_OR_RETURN(Page page, SelectPage(keys, request.page_size(), request.page_token()));
  v1::ListMissionsResponse response;
  for (size_t i = page.begin; i < page.end; ++i) *response.add_missions() = Describe(*missions[i]);
  response.set_next_page_token(page.next_page_token);
  return response;
}

absl::StatusOr<v1::GetTrajectoryResponse> GetTrajectory(const MapRegistry& registry,
                                                        const v1::GetTrajectoryRequest& request,
                                                        int64_t max_message_bytes) {
  ASSIGN_OR_RETURN(const std::shared_ptr<HostedMap> map, registry.Find(request.map()));
  ASSIGN_OR_RETURN(const MissionId id, AtField("mission", FromProto(request.mission())));
  const std::shared_ptr<const MapSnapshot> snapshot = map->published().snapshot;
  const auto mission =
      std::find_if(snapshot->missions.begin(), snapshot->missions.end(),
                   [&](const SnapshotMission& candidate) { return candidate.id == id; });
  if (mission == snapshot->missions.end()) {
    return absl::NotFoundError(
        absl::StrCat("mission: no ", ToString(id), " in revision ", snapshot->revision));
  }
  v1::GetTrajectoryResponse response;
  response.set_map_epoch(snapshot->map_epoch);
  response.set_revision(snapshot->revision);
  response.set_anchored(mission->anchored);
  auto next_start = mission->submap_starts.begin();
  for (size_t i = 0; i < mission->map_from_body.size(); ++i) {
    const bool start =
        next_start != mission->submap_starts.end() && *next_start == static_cast<int64_t>(i);
    if (start) ++next_start;
    *response.add_nodes() = Describe(*mission, i, start);
    if (request.odometry()) {
      *response.add_odometry() = ToProto(mission->keyframes[i].mission_from_body);
    }
  }
  if (static_cast<int64_t>(response.ByteSizeLong()) > max_message_bytes) {
    return absl::ResourceExhaustedError(absl::StrCat("mission: ", response.nodes_size(),
                                                     " poses do not fit into a message of ",
                                                     max_message_bytes, " bytes; use ExportMap"));
  }
  return response;
}

}  // namespace overtone
