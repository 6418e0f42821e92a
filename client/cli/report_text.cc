// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/report_text.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "overtone/client/cli/report_page.h"
#include "overtone/client/cli/report_summary.h"

namespace overtone {
namespace {

std::string Row(absl::string_view cell, const std::vector<std::string>& cells) {
  std::string row = "<tr>";
  for (const std::string& text : cells) {
    absl::StrAppend(&row, "<", cell, cell == "th" ? " scope=\"col\"" : "", ">", text, "</", cell,
                    ">");
  }
  return row + "</tr>\n";
}

std::string Table(absl::string_view caption, const std::vector<std::string>& head,
                  const std::vector<std::vector<std::string>>& rows) {
  std::string table = absl::StrCat("<div class=\"scroll\"><table><caption>", caption,
                                   "</caption><thead>", Row("th", head), "</thead><tbody>\n");
  for (const auto& row : rows) absl::StrAppend(&table, Row("td", row));
  return table + "</tbody></table></div>\n";
}

std::string SummaryTable(const RunResult& result) {
  std::vector<std::vector<std::string>> rows = SummaryRows(result);
  for (auto& row : rows) {
    for (std::string& cell : row) cell = EscapeHtml(cell);
  }
  return Table(
      "RMSE: root mean square position error after rigid alignment (ATE), in metres. Constraints: "
      "in force at the end, small/mid/large scale. Rates are per second of data time.",
      rows.front(), {rows.begin() + 1, rows.end()});
}

// A bar for one estimate, on a scale common to all robots.
std::string Bar(absl::string_view estimate, const std::optional<TrajectoryError>& error,
                double full_scale_m) {
  if (!error) return "";
  const double percent = full_scale_m > 0 ? 100 * error->rmse_m / full_scale_m : 0;
  return absl::StrFormat(
      "<div class=\"bar\"><span>%s</span><span class=\"track\"><i class=\"%s\" "
      "style=\"width:%.1f%%\"></i></span><b>%.3f m</b></div>",
      estimate, estimate, std::clamp(percent, 0.5, 100.0), error->rmse_m);
}

std::string Card(const RobotResult& robot, double full_scale_m) {
  std::string card = absl::StrCat("<div class=\"card\"><h3>", EscapeHtml(robot.name), "</h3>",
                                  Bar("onboard", robot.onboard_error, full_scale_m),
                                  Bar("server", robot.server_error, full_scale_m),
                                  Bar("corrected", robot.corrected_error, full_scale_m));
  if (robot.onboard_error && robot.corrected_error && robot.onboard_error->rmse_m > 0) {
    const double change = 1 - robot.corrected_error->rmse_m / robot.onboard_error->rmse_m;
    absl::StrAppendFormat(&card, "<p>Position error %.0f %% %s after correction.</p>",
                          100 * std::abs(change), change >= 0 ? "smaller" : "larger");
  } else {
    absl::StrAppend(&card, "<p>No ground truth to measure against.</p>");
  }
  return card + "</div>\n";
}

std::string Cards(const RunResult& result) {
  double full_scale_m = 0;
  for (const RobotResult& robot : result.robots) {
    for (const auto* error : {&robot.onboard_error, &robot.server_error, &robot.corrected_error}) {
      if (*error && std::isfinite((*error)->rmse_m)) {
        full_scale_m = std::max(full_scale_m, (*error)->rmse_m);
      }
    }
  }
  std::string cards = "<div class=\"cards\">\n";
  for (const RobotResult& robot : result.robots) {
    absl::StrAppend(&cards, Card(robot, full_scale_m));
  }
  return cards + "</div>\n";
}

// Of a live map.
std::string MissionTable(const RunResult& result) {
  std::vector<std::vector<std::string>> rows;
  for (const RobotResult& robot : result.robots) {
    rows.push_back({EscapeHtml(robot.name), robot.anchored ? "yes" : "no",
                    absl::StrCat(robot.stamps.size()), absl::StrFormat("%.1f", robot.path_m),
                    absl::StrFormat("%.0f", robot.duration_s),
                    absl::StrCat(robot.active_constraints.size())});
  }
  return Table(
      "Anchored: tied to the map's root component. Constraints: those of the last comparison, as "
      "far "
      "as the robot reported them.",
      {"mission", "anchored", "keyframes", "path [m]", "duration [s]", "constraints"}, rows);
}

std::string ClosuresNote(const RunResult& result) {
  if (result.closures_note.empty()) return "";
  return absl::StrCat("<p class=\"note\"><strong>",
                      result.closures_simulated ? "Simulated loop closures." : "Loop closures.",
                      "</strong> ", EscapeHtml(result.closures_note), "</p>\n");
}

std::string ClosureTable(const RunResult& result) {
  struct Count {
    int total = 0, by_server = 0, inter_robot = 0, outliers = 0, wrong = 0;
  };
  std::map<std::string, Count> counts;
  for (const ClosureResult& closure : result.closures) {
    Count& count = counts[closure.verdict];
    ++count.total;
    count.inter_robot += closure.closure.from.mission != closure.closure.to.mission;
    count.outliers += closure.outlier;
    count.by_server += closure.proposer == "scan_context";
    count.wrong += closure.measured && closure.truth.has_value() && !closure.truth->right;
  }
  if (counts.empty()) {
    return absl::StrCat("<p>This ", result.live ? "map has" : "run had",
                        " no loop closures.</p>\n");
  }
  std::vector<std::vector<std::string>> rows;
  for (const auto& [verdict, count] : counts) {
    std::string words = EscapeHtml(verdict);
    std::replace(words.begin(), words.end(), '_', ' ');
    rows.push_back({words, absl::StrCat(count.total), absl::StrCat(count.total - count.inter_robot),
                    absl::StrCat(count.inter_robot), absl::StrCat(count.by_server)});
    if (result.live) continue;  // nobody knows the truth
    rows.back().push_back(absl::StrCat(count.outliers));
    rows.back().push_back(absl::StrCat(count.wrong));
  }
  std::vector<std::string> head = {"verdict", "closures", "within a robot", "between robots",
                                   "the server's own"};
  if (!result.live) head.insert(head.end(), {"wrong on purpose", "wrong by ground truth"});
  return Table("The server's verdict on each loop closure.", head, rows);
}

}  // namespace

std::string EscapeHtml(absl::string_view text) {
  return absl::StrReplaceAll(
      text, {{"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}, {"\"", "&quot;"}, {"'", "&#39;"}});
}

std::string ReportTitle(const RunResult& result) {
  return absl::StrCat("Overtone: ", EscapeHtml(result.dataset));
}

std::string TeamNote(const RunResult& result) {
  if (result.live) {
    return "Seen from above, in the map frame. The odometry that each mission uploaded is laid on "
           "the "
           "server's estimate by a rigid motion of its own. Missions that nothing ties to the "
           "map's "
           "root component are shown further down, each in a frame of its own.";
  }
  return "Seen from above, in the map frame of the server. Each estimate is laid on the ground "
         "truth "
         "by a rigid motion of its own (on the server's estimate where there is no ground truth), "
         "as "
         "for the RMSE.";
}

std::string BeforeCaption(const RunResult& result) {
  return result.live ? "Before: odometry as uploaded" : "Before: onboard estimates";
}

std::string AfterCaption(const RunResult& result) {
  return result.live ? "After: the server's estimate" : "After: corrected estimates";
}

std::string ReportOverview(const RunResult& result) {
  size_t keyframes = 0;
  double path_m = 0;
  for (const RobotResult& robot : result.robots) {
    keyframes += robot.stamps.size();
    path_m += robot.path_m;
  }
  if (result.live) {
    return absl::StrCat(
        absl::StrFormat("<p class=\"lead\">%d mission%s in %d component%s · %d keyframes · %.0f m "
                        "driven · server revision %d</p>\n",
                        result.robots.size(), result.robots.size() == 1 ? "" : "s",
                        result.components, result.components == 1 ? "" : "s", keyframes, path_m,
                        result.revision),
        MissionTable(result));
  }
  return absl::StrCat(
      absl::StrFormat("<p class=\"lead\">%d robot%s · %d keyframes · %.0f m driven · server "
                      "revision %d · replayed in %.1f s</p>\n",
                      result.robots.size(), result.robots.size() == 1 ? "" : "s", keyframes, path_m,
                      result.revision, result.wall_time_s),
      ClosuresNote(result), Cards(result), SummaryTable(result));
}

std::string ReportDetails(const RunResult& result) {
  std::string settings;
  for (const auto& [name, value] : result.settings) {
    absl::StrAppend(&settings, "<dt>", EscapeHtml(name), "</dt><dd>", EscapeHtml(value), "</dd>\n");
  }
  return absl::StrCat("<section><h2>Loop closures</h2>\n<p>", EscapeHtml(result.closures_note),
                      "</p>\n", ClosureTable(result), "</section>\n",
                      result.live ? "<section><h2>Where this is from</h2>\n<pre>"
                                  : "<section><h2>How this run was made</h2>\n<pre>",
                      EscapeHtml(result.command), "</pre>\n<dl>\n", settings,
                      "<dt>Overtone version</dt><dd>", ReportVersion(), "</dd>\n</dl></section>\n");
}

}  // namespace overtone
