// SPDX-License-Identifier: Apache-2.0
// The results of registration_basin as a table, CSV and SVG.
#ifndef OVERTONE_BENCHMARK_BASIN_PLOT_H_
#define OVERTONE_BENCHMARK_BASIN_PLOT_H_

#include <string>
#include <vector>

#include "absl/status/status.h"

namespace overtone {

// All starts of one size in one scenario. Overlaps are NaN without such starts.
struct BasinRow {
  std::string scenario;
  double start_m = 0;
  double start_deg = 0;
  double success_rate = 0;
  double median_error_m = 0;
  double median_error_deg = 0;
  double milliseconds = 0;  // of CPU per pair, the clouds' preparation not included
  double least_overlap_of_successes = 0;
  double largest_overlap_of_failures = 0;
};

void PrintHeader();
void PrintRow(const BasinRow& row);

// Unavailable: cannot be written.
absl::Status WriteCsv(const std::string& path, const std::vector<BasinRow>& rows);
// One line for each scenario, whose rows follow each other. Needs nothing but a browser.
absl::Status WriteSvg(const std::string& path, const std::vector<BasinRow>& rows);

}  // namespace overtone

#endif  // OVERTONE_BENCHMARK_BASIN_PLOT_H_
