// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/map_tables.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/time/time.h"
#include "overtone/client/cli/closure_names.h"

namespace overtone {
namespace {

int64_t InUse(const v1::MapSummary& map) {
  int64_t in_use = 0;
  for (const v1::VerdictCount& count : map.verdicts()) {
    if (count.verdict() == v1::LOOP_CLOSURE_VERDICT_ACCEPTED ||
        count.verdict() == v1::LOOP_CLOSURE_VERDICT_FORCED_BY_OPERATOR) {
      in_use += count.count();
    }
  }
  return in_use;
}

std::string Counted(int64_t count, const char* what) {
  return absl::StrCat(count, " ", what, count == 1 ? "" : "s");
}

double Milliseconds(const google::protobuf::Duration& duration) {
  return 1e3 * static_cast<double>(duration.seconds()) + 1e-6 * duration.nanos();
}

}  // namespace

TableRows MapRows(const std::vector<v1::MapSummary>& maps) {
  TableRows rows = {{"map", "revision", "missions", "components", "keyframes", "in use/candidates",
                     "landmarks", "clouds", "backlog", "cost", "solve [s]"}};
  for (const v1::MapSummary& map : maps) {
    rows.push_back({map.map(), absl::StrCat(map.revision()), absl::StrCat(map.missions()),
                    absl::StrCat(map.components()), absl::StrCat(map.keyframes()),
                    absl::StrCat(InUse(map), "/", map.loop_closures()),
                    absl::StrCat(map.landmarks()), absl::StrCat(map.clouds()),
                    absl::StrCat(map.front_end_backlog()), absl::StrFormat("%.4g", map.cost()),
                    absl::StrFormat("%.3f", map.optimisation_s())});
  }
  return rows;
}

TableRows RobotRows(const std::vector<v1::Robot>& robots) {
  TableRows rows = {{"robot", "link", "missions", "keyframes", "last upload", "backlog", "received",
                     "sent", "revision sent", "clock offset", "last comparison"}};
  for (const v1::Robot& robot : robots) {
    rows.push_back({robot.robot(), LinkText(robot), absl::StrCat(robot.missions()),
                    absl::StrCat(robot.keyframes()), ClockTimeText(robot.last_upload()),
                    BacklogText(robot), BytesText(robot.bytes_received()),
                    BytesText(robot.bytes_sent()),
                    robot.revision_sent() > 0 ? absl::StrCat(robot.revision_sent()) : "-",
                    ClockText(robot), ComparisonText(robot)});
  }
  return rows;
}

std::string VerdictsText(const google::protobuf::RepeatedPtrField<v1::VerdictCount>& verdicts) {
  std::vector<std::string> words;
  for (const v1::VerdictCount& count : verdicts) {
    words.push_back(absl::StrCat(count.count(), " ", VerdictName(count.verdict())));
  }
  return words.empty() ? "none" : absl::StrJoin(words, ", ");
}

std::string LinkText(const v1::Robot& robot) {
  if (robot.uploading()) return robot.watching() ? "up and down" : "up";
  return robot.watching() ? "down" : "away";
}

std::string BacklogText(const v1::Robot& robot) {
  if (!robot.report().has_link()) return "?";
  const v1::LinkReport& link = robot.report().link();
  std::vector<std::string> words;
  if (link.submaps_waiting() > 0) words.push_back(Counted(link.submaps_waiting(), "submap"));
  if (link.blobs_waiting() > 0) words.push_back(Counted(link.blobs_waiting(), "cloud"));
  if (link.bytes_waiting() > 0) words.push_back(BytesText(link.bytes_waiting()));
  return words.empty() ? "nothing" : absl::StrJoin(words, ", ");
}

std::string ClockText(const v1::Robot& robot) {
  const v1::LinkReport& link = robot.report().link();
  if (!link.has_clock_offset()) return "?";
  std::string text = absl::StrFormat("%+.0f ms", Milliseconds(link.clock_offset()));
  if (link.has_clock_offset_uncertainty()) {
    absl::StrAppendFormat(&text, " (within %.0f ms)",
                          std::ceil(Milliseconds(link.clock_offset_uncertainty())));
  }
  return text;
}

std::string ComparisonText(const v1::Robot& robot) {
  if (!robot.has_report()) return "?";
  if (!robot.report().has_comparison()) return "none";
  const v1::ComparisonReport& comparison = robot.report().comparison();
  std::string text = absl::StrCat("revision ", comparison.revision(), ": ");
  if (!comparison.held_back().empty()) return absl::StrCat(text, comparison.held_back());
  int added = 0;
  for (const v1::ConstraintCount& count : comparison.constraints()) added += count.added();
  if (added + comparison.updated() + comparison.retracted() == 0) return text + "agrees";
  absl::StrAppend(&text, Counted(added, "constraint"));
  if (comparison.updated() > 0) absl::StrAppend(&text, ", ", comparison.updated(), " updated");
  if (comparison.retracted() > 0) {
    absl::StrAppend(&text, ", ", comparison.retracted(), " retracted");
  }
  if (comparison.has_rmse_before_m() && comparison.has_predicted_rmse_m()) {
    absl::StrAppendFormat(&text, ", %.2f to %.2f m", comparison.rmse_before_m(),
                          comparison.predicted_rmse_m());
  }
  if (!comparison.applied()) absl::StrAppend(&text, ", not applied");
  return text;
}

std::string BytesText(int64_t bytes) {
  if (bytes < 1000) return absl::StrCat(bytes, " B");
  if (bytes < 1'000'000) return absl::StrFormat("%.1f kB", 1e-3 * static_cast<double>(bytes));
  return absl::StrFormat("%.1f MB", 1e-6 * static_cast<double>(bytes));
}

std::string ClockTimeText(const google::protobuf::Timestamp& time) {
  if (time.seconds() == 0) return "-";
  return absl::FormatTime("%H:%M:%S", absl::FromUnixSeconds(time.seconds()), absl::UTCTimeZone());
}

}  // namespace overtone
