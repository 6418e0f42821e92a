// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/dashboard/view_json.h"

#include <algorithm>

#include "overtone/services/dashboard/proto_json.h"
#include "overtone/services/dashboard/track_frame.h"

namespace overtone {
namespace {

using nlohmann::json;

const VersionedTrack& TrackOf(const MissionView& mission, TrackKind kind) {
  if (kind == TrackKind::kPositions) return mission.positions;
  return kind == TrackKind::kOdometry ? mission.odometry : mission.discrepancy;
}

// Of the track that changed last. Not the view's: a later view may bring tracks of an earlier
// round.
uint64_t Newest(const MapView& view, TrackKind kind) {
  uint64_t newest = 0;
  for (const MissionView& mission : view.missions) {
    newest = std::max(newest, TrackOf(mission, kind).version);
  }
  return newest;
}

json Link(const MapView& view) {
  return {
      {"ok", view.link.ok()},
      {"code", absl::StatusCodeToString(view.link.code())},
      {"error", std::string(view.link.message())},
      {"refreshed_ms",
       view.refreshed == absl::InfinitePast() ? json() : json(absl::ToUnixMillis(view.refreshed))},
      {"server_version", view.server_version}};
}

json Summary(const MapView& view) {
  const v1::MapSummary& summary = view.summary;
  return {{"exists", view.map_exists},
          {"epoch", summary.map_epoch()},
          {"revision", summary.revision()},
          {"published_ms", Milliseconds(summary.has_published(), summary.published())},
          {"keyframes", summary.keyframes()},
          {"components", summary.components()},
          {"closures", summary.loop_closures()},
          {"cost", summary.cost()},
          {"optimisation_s", summary.optimisation_s()},
          {"backlog", summary.front_end_backlog()},
          {"verdicts", ToJson(summary.verdicts())},
          {"clouds", summary.clouds()},
          {"missing_blobs", summary.missing_blobs()},
          {"landmarks", summary.landmarks()}};
}

json Mission(const MissionView& view) {
  const v1::Mission& mission = view.mission;
  json message = {{"number", view.number},
                  {"robot", mission.id().robot()},
                  {"mission", mission.id().mission()},
                  {"anchored", mission.anchored()},
                  {"component", mission.component()},
                  {"keyframes", mission.keyframes()},
                  {"submaps", mission.submaps()},
                  {"path_m", mission.path_m()},
                  {"duration_s", 1e-9 * (mission.last_stamp_ns() - mission.first_stamp_ns())},
                  {"map_tform_mission", ToJson(mission.map_tform_mission())},
                  {"problem", view.problem}};
  if (view.report.has_comparison()) message["comparison"] = ToJson(view.report.comparison());
  return message;
}

json Robot(const RobotView& view) {
  const v1::Robot& robot = view.robot;
  json message = {{"robot", robot.robot()},
                  {"missions", robot.missions()},
                  {"keyframes", robot.keyframes()},
                  {"uploading", robot.uploading()},
                  {"watching", robot.watching()},
                  {"revision_sent", robot.revision_sent()},
                  {"last_upload_ms", Milliseconds(robot.has_last_upload(), robot.last_upload())},
                  {"bytes_received", robot.bytes_received()},
                  {"bytes_sent", robot.bytes_sent()},
                  {"received_bytes_per_s", view.received_bytes_per_s},
                  {"sent_bytes_per_s", view.sent_bytes_per_s}};
  if (!robot.has_report()) return message;
  const v1::StatusReport& report = robot.report();
  message["reported_ms"] = Milliseconds(report.has_received(), report.received());
  message["reporting_mission"] = report.mission().mission();
  if (report.has_link()) message["link"] = ToJson(report.link());
  if (report.has_comparison()) {
    message["comparison"] = ToJson(report.comparison());
    message["comparison"].erase("largest");  // they are the mission's
  }
  return message;
}

}  // namespace

json StateJson(const MapView& view) {
  json missions = json::array();
  for (const MissionView& mission : view.missions) missions.push_back(Mission(mission));
  json robots = json::array();
  for (const RobotView& robot : view.robots) robots.push_back(Robot(robot));
  return {{"version", view.version},
          {"link", Link(view)},
          {"maps", view.maps},
          {"summary", Summary(view)},
          {"missions", missions},
          {"robots", robots},
          {"versions",
           {{"positions", Newest(view, TrackKind::kPositions)},
            {"odometry", Newest(view, TrackKind::kOdometry)},
            {"discrepancy", Newest(view, TrackKind::kDiscrepancy)},
            {"closures", view.closures_version},
            {"revisions", view.revisions_version}}}};
}

json ClosuresJson(const MapView& view) {
  json closures = json::array();
  for (const v1::LoopClosureStatus& closure : *view.closures) closures.push_back(ToJson(closure));
  return {{"version", view.closures_version},
          {"total", view.summary.loop_closures()},
          {"closures", closures}};
}

json RevisionsJson(const MapView& view, const std::vector<SeenRevision>& seen) {
  json revisions = json::array();
  for (const v1::Revision& revision : *view.revisions) revisions.push_back(ToJson(revision));
  json shown = json::array();
  for (const SeenRevision& revision : seen) {
    shown.push_back({{"epoch", revision.map_epoch},
                     {"revision", revision.revision},
                     {"published_ms", absl::ToUnixMillis(revision.published)}});
  }
  return {{"version", view.revisions_version}, {"revisions", revisions}, {"seen", shown}};
}

std::string TracksSince(const MapView& view, TrackKind kind, uint64_t since) {
  TrackFrame frame(std::max(since, Newest(view, kind)), view.origin);
  for (const MissionView& mission : view.missions) {
    const VersionedTrack& versioned = TrackOf(mission, kind);
    if (versioned.version > since) frame.Add(mission.number, *versioned.track);
  }
  return frame.Release();
}

}  // namespace overtone
