// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/report_heat_map.h"

#include <algorithm>
#include <cmath>

#include "overtone/client/cli/report_decimation.h"

namespace overtone {
namespace {

bool IsDrawable(const ComparisonRecord& record, int64_t num_keyframes) {
  const std::vector<int64_t>& nodes = record.keyframe_index;
  return !nodes.empty() && record.discrepancy.cols() == 3 &&
         record.discrepancy.rows() == static_cast<Eigen::Index>(nodes.size()) &&
         record.discrepancy.allFinite() && std::is_sorted(nodes.begin(), nodes.end()) &&
         nodes.front() >= 0 && nodes.back() < num_keyframes;
}

// Each node stands for the path from half-way to the one before it to half-way to the one after.
std::vector<double> SpreadOverColumns(const ComparisonRecord& record, int band,
                                      const std::vector<double>& path_m, int columns) {
  std::vector<double> values(columns, -1);
  const std::vector<int64_t>& nodes = record.keyframe_index;
  const auto column_at = [&](size_t a, size_t b) {
    const double middle_m = (path_m[nodes[a]] + path_m[nodes[b]]) / 2;
    return std::clamp(static_cast<int>(middle_m / path_m.back() * columns), 0, columns - 1);
  };
  for (size_t i = 0; i < nodes.size(); ++i) {
    const int first = column_at(i == 0 ? 0 : i - 1, i);
    const int last = column_at(i, i + 1 == nodes.size() ? i : i + 1);
    for (int column = first; column <= last; ++column) {
      values[column] = std::max(values[column], record.discrepancy(i, band));
    }
  }
  return values;
}

}  // namespace

HeatMap MakeHeatMap(const std::vector<ComparisonRecord>& comparisons,
                    const std::vector<double>& path_m, int max_rows, int columns) {
  HeatMap map;
  if (path_m.empty() || !(path_m.back() > 0)) return map;
  std::vector<const ComparisonRecord*> drawable;
  for (const ComparisonRecord& record : comparisons) {
    if (IsDrawable(record, static_cast<int64_t>(path_m.size()))) drawable.push_back(&record);
  }
  if (drawable.empty()) return map;
  map.columns = columns;
  const std::vector<int> rows = EvenlySpread(drawable.size(), max_rows);
  for (int row : rows) {
    map.row_time.push_back(drawable[row]->time_s);
    map.max = std::max(map.max, drawable[row]->discrepancy.maxCoeff());
  }
  for (int band = 0; band < 3; ++band) {
    for (int row : rows) {
      for (double value : SpreadOverColumns(*drawable[row], band, path_m, columns)) {
        const double relative = map.max > 0 ? std::sqrt(std::max(0.0, value) / map.max) : 0;
        map.cells[band] += value < 0 ? ' ' : kHeatLevels[std::lround(63 * relative)];
      }
    }
  }
  return map;
}

}  // namespace overtone
