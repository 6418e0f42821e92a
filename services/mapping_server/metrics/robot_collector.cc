// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/string_view.h"
#include "absl/strings/strip.h"
#include "absl/time/clock.h"
#include "overtone/services/mapping_server/metrics/collectors.h"

namespace overtone {
namespace {

using Labels = std::vector<std::string>;

template <typename Message>
double ToSeconds(const Message& message) {  // Duration or Timestamp
  return static_cast<double>(message.seconds()) + 1e-9 * message.nanos();
}

double SinceEpoch(absl::Time time) { return absl::ToDoubleSeconds(time - absl::UnixEpoch()); }

const RobotCounters kNone;

void CollectTraffic(const Labels& robot, const RobotCounters& counters, MetricSet& set) {
  set.Add("overtone_robot_bytes_total", {robot[0], robot[1], "received"},
          static_cast<double>(counters.bytes_received));
  set.Add("overtone_robot_bytes_total", {robot[0], robot[1], "sent"},
          static_cast<double>(counters.bytes_sent));
  set.Add("overtone_robot_watching", robot, counters.watches > 0 ? 1 : 0);
  set.Add("overtone_robot_revision_sent", robot, static_cast<double>(counters.revision_sent));
}

void CollectReport(const Labels& robot, const v1::StatusReport& report, MetricSet& set) {
  const v1::LinkReport& link = report.link();
  set.Add("overtone_robot_report_age_seconds", robot,
          std::max(0.0, SinceEpoch(absl::Now()) - ToSeconds(report.received())));
  set.Add("overtone_robot_outbox_submaps", robot, static_cast<double>(link.submaps_waiting()));
  set.Add("overtone_robot_outbox_clouds", robot, static_cast<double>(link.blobs_waiting()));
  set.Add("overtone_robot_outbox_bytes", robot, static_cast<double>(link.bytes_waiting()));
  set.Add("overtone_robot_reconnects_total", robot, static_cast<double>(link.reconnects()));
  set.Add("overtone_robot_clouds_dropped_total", robot, static_cast<double>(link.clouds_dropped()));
  if (!link.has_clock_offset()) return;
  set.Add("overtone_robot_clock_offset_seconds", robot, ToSeconds(link.clock_offset()));
  set.Add("overtone_robot_clock_offset_uncertainty_seconds", robot,
          ToSeconds(link.clock_offset_uncertainty()));
}

// "small" of CONSTRAINT_KIND_SMALL.
std::string KindName(int kind) {
  const std::string& name = v1::ConstraintKind_Name(static_cast<v1::ConstraintKind>(kind));
  return absl::AsciiStrToLower(absl::StripPrefix(name, "CONSTRAINT_KIND_"));
}

void CollectConstraints(const Labels& robot, const StatusReports::Totals& totals, MetricSet& set) {
  for (size_t kind = 0; kind < totals.constraints.size(); ++kind) {
    if (!v1::ConstraintKind_IsValid(static_cast<int>(kind))) continue;
    set.Add("overtone_robot_constraints_total",
            {robot[0], robot[1], KindName(static_cast<int>(kind))},
            static_cast<double>(totals.constraints[kind]));
  }
}

}  // namespace

void CollectRobots(HostedMap& map, const UploadSessions& sessions, MetricSet& set) {
  std::map<std::string, absl::Time> stored_at;
  for (const auto& [id, state] : map.store().Missions()) {
    absl::Time& latest = stored_at.emplace(id.robot, absl::InfinitePast()).first->second;
    latest = std::max(latest, state.stored_at);
  }
  const std::map<std::string, StatusReports::Totals> totals = map.reports().TotalsByRobot();
  for (const auto& [name, latest] : stored_at) {
    const Labels robot = {map.id(), name};
    set.Add("overtone_robot_uploading", robot, sessions.IsOpen(map.id(), name) ? 1 : 0);
    set.Add("overtone_robot_last_upload_timestamp_seconds", robot, SinceEpoch(latest));
    const auto counters = map.traffic().Find(name);
    CollectTraffic(robot, counters == nullptr ? kNone : *counters, set);
    if (const auto report = map.reports().Newest(name)) CollectReport(robot, *report, set);
    const auto total = totals.find(name);
    if (total != totals.end()) CollectConstraints(robot, total->second, set);
  }
}

}  // namespace overtone
