// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/watch.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "nlohmann/json.hpp"
#include "overtone/client/cli/admin_flags.h"
#include "overtone/client/cli/map_tables.h"
#include "overtone/client/cli/table.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

std::string MapWords(const v1::MapSummary& map) {
  return absl::StrFormat(
      "revision %d of %s, %d missions in %d components, %d keyframes, closures: %s, backlog %d",
      map.revision(), ClockTimeText(map.published()), map.missions(), map.components(),
      map.keyframes(), VerdictsText(map.verdicts()), map.front_end_backlog());
}

std::string RobotWords(const v1::Robot& robot) {
  return absl::StrFormat(
      "%s, %d missions, %d keyframes, backlog %s, clock %s, revision sent %d, compared %s",
      LinkText(robot), robot.missions(), robot.keyframes(), BacklogText(robot), ClockText(robot),
      robot.revision_sent(), ComparisonText(robot));
}

std::string Shortened(const std::string& text, int rows) {
  const std::vector<std::string> lines = absl::StrSplit(text, '\n');
  if (rows <= 0 || static_cast<int>(lines.size()) <= rows + 1) return text;
  std::string shortened;
  for (int i = 0; i + 1 < rows; ++i) absl::StrAppend(&shortened, lines[i], "\n");
  return absl::StrCat(shortened, "(", lines.size() - rows, " more lines; --map shows one map)\n");
}

}  // namespace

absl::StatusOr<std::vector<WatchedMap>> LookAt(AdminClient& client, const std::string& map) {
  ASSIGN_OR_RETURN(const std::vector<v1::MapSummary> summaries, client.ListMaps());
  std::vector<WatchedMap> maps;
  for (const v1::MapSummary& summary : summaries) {
    if (!map.empty() && summary.map() != map) continue;
    absl::StatusOr<std::vector<v1::Robot>> robots = client.ListRobots(summary.map());
    if (absl::IsNotFound(robots.status())) continue;  // deleted meanwhile
    RETURN_IF_ERROR(robots.status());
    maps.push_back({summary, *std::move(robots)});
  }
  return maps;
}

std::string Picture(const std::vector<WatchedMap>& maps, int rows) {
  if (maps.empty()) return "no map yet: one comes into being with its first submap\n";
  std::string text;
  for (const WatchedMap& map : maps) {
    absl::StrAppend(&text, text.empty() ? "" : "\n", map.summary.map(), ": ", MapWords(map.summary),
                    "\n", FormatTable(RobotRows(map.robots)));
  }
  return Shortened(text, rows);
}

std::string ChangeLog::Line(const std::string& key, const std::string& words,
                            const std::string& object, absl::Time now) {
  std::string& said = said_[key];
  if (said == words) return "";
  said = words;
  if (!json_) {
    return absl::StrCat(absl::FormatTime("%H:%M:%S ", now, absl::UTCTimeZone()), key, ": ", words,
                        "\n");
  }
  return absl::StrCat("{\"time\":\"", absl::FormatTime(absl::RFC3339_sec, now, absl::UTCTimeZone()),
                      "\",", object, "}\n");
}

std::string ChangeLog::Changes(const std::vector<WatchedMap>& maps, absl::Time now) {
  std::string lines;
  if (std::exchange(lost_, false)) {
    absl::StrAppend(&lines, Line("server", "is back", "\"error\":\"\"", now));
  }
  for (const WatchedMap& map : maps) {
    const std::string& name = map.summary.map();  // an id: nothing in it to escape
    absl::StrAppend(
        &lines,
        Line(name, MapWords(map.summary),
             absl::StrCat("\"map\":\"", name, "\",\"summary\":", ToJson(map.summary)), now));
    for (const v1::Robot& robot : map.robots) {
      absl::StrAppend(&lines,
                      Line(absl::StrCat(name, "/", robot.robot()), RobotWords(robot),
                           absl::StrCat("\"map\":\"", name, "\",\"robot\":", ToJson(robot)), now));
    }
  }
  return lines;
}

std::string ChangeLog::Lost(const absl::Status& status, absl::Time now) {
  if (std::exchange(lost_, true)) return "";
  const nlohmann::json error = std::string(status.message());
  return Line("server", absl::StrCat("lost, trying again: ", status.message()),
              absl::StrCat("\"error\":",
                           error.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace)),
              now);
}

}  // namespace overtone
