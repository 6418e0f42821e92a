// SPDX-License-Identifier: Apache-2.0
#include "overtone/benchmark/basin_plot.h"

#include <algorithm>
#include <cstdio>
#include <fstream>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace overtone {
namespace {

constexpr double kLeft = 60, kTop = 30, kWidth = 560, kHeight = 300, kLegend = 170;
constexpr const char* kColors[] = {"#1b6ca8", "#d1495b", "#2e8b57",
                                   "#b8860b", "#6a4c93", "#444444"};

absl::Status WriteFile(const std::string& path, const std::string& text) {
  std::ofstream file(path);
  file << text;
  file.close();
  if (file.fail()) return absl::UnavailableError(absl::StrCat(path, ": cannot be written"));
  return absl::OkStatus();
}

std::string Text(double x, double y, absl::string_view anchor, absl::string_view text) {
  return absl::StrFormat("<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">%s</text>\n", x, y, anchor,
                         text);
}

std::string Line(double x1, double y1, double x2, double y2, absl::string_view color) {
  return absl::StrFormat("<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" stroke=\"%s\"/>\n",
                         x1, y1, x2, y2, color);
}

double YOf(double success_rate) { return kTop + kHeight * (1 - success_rate); }

std::string Axes(double largest_m) {
  std::string svg;
  for (int tenths = 0; tenths <= 10; tenths += 2) {
    const double y = YOf(tenths / 10.0);
    svg += Line(kLeft, y, kLeft + kWidth, y, "#dddddd");
    svg += Text(kLeft - 8, y + 4, "end", absl::StrCat(tenths * 10, " %"));
  }
  for (int metres = 0; metres <= largest_m; ++metres) {
    const double x = kLeft + kWidth * metres / largest_m;
    svg += Text(x, kTop + kHeight + 18, "middle", absl::StrCat(metres));
  }
  svg += Text(kLeft + kWidth / 2, kTop + kHeight + 38, "middle",
              "error of the start, m (its yaw: see the table)");
  svg += Text(kLeft, kTop - 12, "start", "starts that end within 0.1 m and 1 degree");
  return svg;
}

}  // namespace

void PrintHeader() {
  std::printf("%-18s %8s %8s %8s %10s %10s %8s %12s %12s\n", "scenario", "start m", "deg",
              "success", "median mm", "median deg", "ms", "overlap ok>=", "failed<=");
}

void PrintRow(const BasinRow& row) {
  std::printf("%-18s %8.3g %8.3g %7.1f%% %10.1f %10.3f %8.2f %12.3f %12.3f\n", row.scenario.c_str(),
              row.start_m, row.start_deg, 100 * row.success_rate, 1e3 * row.median_error_m,
              row.median_error_deg, row.milliseconds, row.least_overlap_of_successes,
              row.largest_overlap_of_failures);
  std::fflush(stdout);
}

absl::Status WriteCsv(const std::string& path, const std::vector<BasinRow>& rows) {
  std::string csv =
      "scenario,start_m,start_deg,success_rate,median_error_m,median_error_deg,milliseconds,"
      "least_overlap_of_successes,largest_overlap_of_failures\n";
  for (const BasinRow& row : rows) {
    absl::StrAppendFormat(&csv, "\"%s\",%g,%g,%g,%g,%g,%g,%g,%g\n", row.scenario, row.start_m,
                          row.start_deg, row.success_rate, row.median_error_m, row.median_error_deg,
                          row.milliseconds, row.least_overlap_of_successes,
                          row.largest_overlap_of_failures);
  }
  return WriteFile(path, csv);
}

absl::Status WriteSvg(const std::string& path, const std::vector<BasinRow>& rows) {
  double largest_m = 0;
  for (const BasinRow& row : rows) largest_m = std::max(largest_m, row.start_m);
  std::string svg = absl::StrFormat(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %g %g\" font-family=\"sans-serif\" "
      "font-size=\"12\">\n<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n",
      kLeft + kWidth + kLegend, kTop + kHeight + 50);
  svg += Axes(largest_m);
  int series = 0;
  for (size_t begin = 0, end = 0; begin < rows.size(); begin = end, ++series) {
    const char* const color = kColors[series % std::size(kColors)];
    std::string points;
    while (end < rows.size() && rows[end].scenario == rows[begin].scenario) {
      absl::StrAppendFormat(&points, "%.1f,%.1f ", kLeft + kWidth * rows[end].start_m / largest_m,
                            YOf(rows[end].success_rate));
      ++end;
    }
    absl::StrAppendFormat(
        &svg, "<polyline points=\"%s\" fill=\"none\" stroke=\"%s\" stroke-width=\"2\"/>\n", points,
        color);
    const double y = kTop + 20 * series + 10;
    svg += Line(kLeft + kWidth + 12, y - 4, kLeft + kWidth + 36, y - 4, color);
    svg += Text(kLeft + kWidth + 42, y, "start", rows[begin].scenario);
  }
  return WriteFile(path, svg + "</svg>\n");
}

}  // namespace overtone
