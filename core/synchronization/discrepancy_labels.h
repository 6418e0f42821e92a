// SPDX-License-Identifier: Apache-2.0
// Which nodes to correct, and at which scale: entries of the n x 3 discrepancy table.
#ifndef OVERTONE_CORE_SYNCHRONIZATION_DISCREPANCY_LABELS_H_
#define OVERTONE_CORE_SYNCHRONIZATION_DISCREPANCY_LABELS_H_

#include <vector>

#include "Eigen/Core"
#include "overtone/core/synchronization/trajectory_comparison.h"

namespace overtone {

struct DiscrepancyLabel {
  int node = 0;  // row of the comparison
  Band band = Band::kSmall;
  double discrepancy = 0;
};

// The n largest entries above `floor`. By node, small band first; equal entries: the earlier node,
// the smaller scale. (The prototype also caps n at the number of nodes.) Bernreiter et al. 2024,
// "Constraint selection".
std::vector<DiscrepancyLabel> LargestDiscrepancies(const Eigen::MatrixXd& discrepancy, int n,
                                                   double floor);

// Every entry above `threshold`, in the same order. Bernreiter et al., MRS 2021.
std::vector<DiscrepancyLabel> DiscrepanciesAbove(const Eigen::MatrixXd& discrepancy,
                                                 double threshold);

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_DISCREPANCY_LABELS_H_
