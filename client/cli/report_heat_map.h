// SPDX-License-Identifier: Apache-2.0
// The discrepancies of all comparisons of one robot, small enough to be drawn.
#ifndef OVERTONE_CLIENT_CLI_REPORT_HEAT_MAP_H_
#define OVERTONE_CLIENT_CLI_REPORT_HEAT_MAP_H_

#include <array>
#include <string>
#include <vector>

#include "overtone/client/cli/run_result.h"

namespace overtone {

// One row per comparison, in time order and thinned out evenly, one column per stretch of the path.
struct HeatMap {
  int columns = 0;
  double max = 0;                // largest discrepancy, units of the signal
  std::vector<double> row_time;  // data time of the comparison, seconds
  // Band by band (large, mid, small), row by row: a character per cell. ' ': not compared;
  // otherwise the largest discrepancy on that stretch, v, as kHeatLevels[63 * sqrt(v / max)].
  std::array<std::string, 3> cells;
};

inline constexpr char kHeatLevels[] =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

// path_m: arc length at each keyframe, not decreasing. Empty without comparisons or without path.
// Rows whose shape is not one discrepancy per node and band are skipped, as are unknown keyframes.
HeatMap MakeHeatMap(const std::vector<ComparisonRecord>& comparisons,
                    const std::vector<double>& path_m, int max_rows, int columns);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_REPORT_HEAT_MAP_H_
