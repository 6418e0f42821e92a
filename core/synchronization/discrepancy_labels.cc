// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/discrepancy_labels.h"

#include <algorithm>
#include <tuple>

namespace overtone {
namespace {

bool NodeThenSmallestScale(const DiscrepancyLabel& a, const DiscrepancyLabel& b) {
  return std::make_tuple(a.node, -static_cast<int>(a.band)) <
         std::make_tuple(b.node, -static_cast<int>(b.band));
}

}  // namespace

std::vector<DiscrepancyLabel> DiscrepanciesAbove(const Eigen::MatrixXd& discrepancy,
                                                 double threshold) {
  std::vector<DiscrepancyLabel> labels;
  for (int node = 0; node < discrepancy.rows(); ++node) {
    for (const Band band : {Band::kSmall, Band::kMid, Band::kLarge}) {
      const double value = discrepancy(node, static_cast<int>(band));
      if (value > threshold) labels.push_back({node, band, value});
    }
  }
  return labels;
}

std::vector<DiscrepancyLabel> LargestDiscrepancies(const Eigen::MatrixXd& discrepancy, int n,
                                                   double floor) {
  std::vector<DiscrepancyLabel> labels = DiscrepanciesAbove(discrepancy, floor);
  std::stable_sort(labels.begin(), labels.end(),
                   [](const DiscrepancyLabel& a, const DiscrepancyLabel& b) {
                     return a.discrepancy > b.discrepancy;
                   });
  labels.resize(std::min<size_t>(labels.size(), std::max(n, 0)));
  std::sort(labels.begin(), labels.end(), NodeThenSmallestScale);
  return labels;
}

}  // namespace overtone
