// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "overtone/client/cli/curve_table.h"

namespace overtone {
namespace {

constexpr double kWidth = 320, kHeight = 220, kMargin = 36;  // of a panel, pixels
constexpr int kColumns = 3;
constexpr double kMostEdges = 50;

const std::vector<std::pair<std::string, std::string>>& Colours() {
  static const auto* const colours =
      new std::vector<std::pair<std::string, std::string>>{{"knots", "#0b6e4f"},
                                                           {"uniform", "#3a6ea5"},
                                                           {"random", "#999999"},
                                                           {"largest_edge_error", "#b5651d"},
                                                           {"top_n", "#a4243b"}};
  return *colours;
}

// One robot's curves, merit from 1 to what onboard has.
class Panel {
 public:
  Panel(const std::vector<CurveRow>& rows, double left, double top)
      : rows_(rows), left_(left), top_(top) {
    for (const CurveRow& row : rows_)
      most_ = std::max(most_, row.onboard_rmse_m / row.server_rmse_m);
  }

  std::string Draw() const {
    std::string text = absl::StrFormat(
        "<rect x='%.0f' y='%.0f' width='%.0f' height='%.0f' fill='none' stroke='#bbb'/>"
        "<text x='%.0f' y='%.0f'>%s %s, onboard %.1f</text>\n",
        left_ + kMargin, top_ + kMargin, kWidth - 2 * kMargin, kHeight - 2 * kMargin,
        left_ + kMargin, top_ + kMargin - 6, rows_[0].sequence, rows_[0].robot, most_);
    for (const int edges : {1, 5, 15, 50}) {
      absl::StrAppendFormat(&text, "<text x='%.0f' y='%.0f' text-anchor='middle'>%d</text>",
                            X(edges), top_ + kHeight - kMargin + 14, edges);
    }
    for (const auto& [strategy, colour] : Colours()) {
      std::string points;
      for (const CurveRow& row : rows_) {
        if (row.strategy != strategy || row.mode != "once") continue;
        absl::StrAppendFormat(&points, "%.1f,%.1f ", X(row.budget), Y(Merit(row)));
      }
      absl::StrAppendFormat(&text,
                            "<polyline fill='none' stroke='%s' stroke-width='1.5' points='%s'/>\n",
                            colour, points);
    }
    return text;
  }

 private:
  double X(double edges) const {
    return left_ + kMargin + (kWidth - 2 * kMargin) * std::log(edges) / std::log(kMostEdges);
  }
  double Y(double merit) const {
    const double share = std::log(std::max(merit, 1.0)) / std::log(std::max(most_, 1.1));
    return top_ + kHeight - kMargin - (kHeight - 2 * kMargin) * std::min(share, 1.0);
  }

  const std::vector<CurveRow> rows_;
  const double left_, top_;
  double most_ = 1;
};

}  // namespace

std::string CurveSvg(const std::vector<CurveRow>& rows) {
  std::vector<std::vector<CurveRow>> robots;
  for (const CurveRow& row : rows) {
    const auto same = std::find_if(robots.begin(), robots.end(), [&](const auto& robot) {
      return robot[0].sequence == row.sequence && robot[0].robot == row.robot;
    });
    if (same == robots.end()) {
      robots.push_back({row});
    } else {
      same->push_back(row);
    }
  }
  const int lines = (static_cast<int>(robots.size()) + kColumns - 1) / kColumns;
  std::string text = absl::StrFormat(
      "<svg xmlns='http://www.w3.org/2000/svg' width='%.0f' height='%.0f' "
      "font-family='sans-serif' font-size='11'>\n<rect width='100%%' height='100%%' "
      "fill='white'/>\n",
      kColumns * kWidth, lines * kHeight + 24);
  double x = kMargin;
  for (const auto& [strategy, colour] : Colours()) {
    absl::StrAppendFormat(&text, "<text x='%.0f' y='14' fill='%s'>%s</text>", x, colour, strategy);
    x += 9.0 * static_cast<double>(strategy.size()) + 12;
  }
  absl::StrAppend(&text, "<text x='", x,
                  "' y='14'>RMSE / server's against edges, log-log</text>\n");
  for (int i = 0; i < robots.size(); ++i) {
    text += Panel(robots[i], kWidth * (i % kColumns), 24 + kHeight * (i / kColumns)).Draw();
  }
  return text + "</svg>\n";
}

}  // namespace overtone
