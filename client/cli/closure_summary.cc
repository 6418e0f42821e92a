// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/closure_summary.h"

#include <cmath>
#include <optional>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "overtone/client/cli/closure_judgement.h"
#include "overtone/client/cli/table.h"

namespace overtone {
namespace {

std::string CountVerdicts(const ClosureScore& score) {
  std::vector<std::string> parts;
  for (const auto& [verdict, count] : score.verdicts) {
    parts.push_back(absl::StrCat(count.all, " ", verdict));
    if (score.judged > 0 && verdict != "accepted") {
      absl::StrAppend(&parts.back(), " (", count.same_place, " of one place)");
    }
  }
  return absl::StrJoin(parts, ", ");
}

std::string FormatShare(const std::optional<double>& share) {
  return share.has_value() ? absl::StrFormat("%.3f", *share) : "-";
}

Json ShareToJson(const std::optional<double>& share) {
  return share.has_value() ? Json(*share) : Json(nullptr);
}

std::string Degrees(double angle_rad) { return absl::StrFormat("%.3f", angle_rad * 180 / M_PI); }

}  // namespace

std::string FormatClosures(const RunResult& result) {
  std::string text;
  for (const auto& [proposer, score] : ScoreClosures(result.closures)) {
    absl::StrAppend(&text, "Loop closures by ", proposer, ": ", score.proposed, " proposed, ",
                    score.accepted, " in use; ", CountVerdicts(score), ".\n");
    if (score.judged == 0) continue;
    absl::StrAppend(&text, "  Against ground truth: ", score.accepted_wrong, " of ",
                    score.accepted_judged, " in use are wrong, ", score.same_place, " of ",
                    score.judged, " proposed truly are one place; precision ",
                    FormatShare(score.Precision()), ", recall ", FormatShare(score.Recall()),
                    ".\n");
  }
  return text;
}

Json ClosuresToJson(const RunResult& result) {
  Json json = Json::object();
  for (const auto& [proposer, score] : ScoreClosures(result.closures)) {
    Json verdicts = Json::object();
    for (const auto& [verdict, count] : score.verdicts) {
      verdicts[verdict] = {{"count", count.all}, {"same_place", count.same_place}};
    }
    json[proposer] = {{"proposed", score.proposed},
                      {"judged", score.judged},
                      {"same_place", score.same_place},
                      {"accepted", score.accepted},
                      {"accepted_judged", score.accepted_judged},
                      {"accepted_wrong", score.accepted_wrong},
                      {"precision", ShareToJson(score.Precision())},
                      {"recall", ShareToJson(score.Recall())},
                      {"verdicts", verdicts}};
  }
  return json;
}

std::string FormatRelations(const RunResult& result) {
  if (result.relations.empty()) return "";
  std::vector<std::vector<std::string>> rows = {
      {"relations of", "count", "median [m]", "mean [m]", "median [deg]", "mean [deg]"}};
  for (const RelationErrors& errors : result.relations) {
    std::vector<std::string> row = {
        errors.estimate, absl::StrCat(errors.count), "-", "-", "-", "-"};
    if (errors.count > 0) {
      row = {errors.estimate,
             absl::StrCat(errors.count),
             absl::StrFormat("%.3f", errors.translation_median_m),
             absl::StrFormat("%.3f", errors.translation_mean_m),
             Degrees(errors.rotation_median_rad),
             Degrees(errors.rotation_mean_rad)};
    }
    rows.push_back(row);
  }
  return absl::StrCat(FormatTable(rows), "\n");
}

Json RelationsToJson(const RunResult& result) {
  Json json = Json::object();
  for (const RelationErrors& errors : result.relations) {
    json[errors.estimate] = nullptr;
    if (errors.count == 0) continue;
    json[errors.estimate] = {{"count", errors.count},
                             {"translation_mean_m", errors.translation_mean_m},
                             {"translation_median_m", errors.translation_median_m},
                             {"rotation_mean_rad", errors.rotation_mean_rad},
                             {"rotation_median_rad", errors.rotation_median_rad}};
  }
  return json;
}

}  // namespace overtone
