// SPDX-License-Identifier: Apache-2.0
// Where the onboard estimate begins to drift away from the server's, and at which scale.
#ifndef OVERTONE_CORE_SYNCHRONIZATION_DRIFT_ONSET_H_
#define OVERTONE_CORE_SYNCHRONIZATION_DRIFT_ONSET_H_

#include <cstdint>
#include <optional>

#include "overtone/core/synchronization/selection_context.h"
#include "overtone/core/synchronization/synchronization_options.h"
#include "overtone/core/synchronization/trajectory_comparison.h"

namespace overtone {

struct DriftOnset {
  int row = 0;  // of the comparison: the motion into the next one is the first bad one
  int64_t keyframe_index = 0;  // its
  int end_row = 0;             // where it ends
  Band band = Band::kSmall;    // in which it stands out most from the other nodes
  double log_likelihood_ratio = 0;
};

// A stretch of steps that are all off in the same way, by generalised likelihood ratio (Willsky &
// Jones, IEEE TAC 21(1), 1976): with step errors r_i of covariance Q_i, each in its step's own
// frame, that k+1..m share a bias in proportion to Q_i rather than none has the ratio
//     2 ln L = s^T C^-1 s,   s = sum r_i,   C = sum Q_i,
// and the onset is the k of the largest. Odometry's covariances are scaled first to what most steps
// show (their median), so that a robot with ordinary drift has no onset whatever they claim. At
// most some 400 nodes are looked at, and those around the answer one by one. None: below the limit.
std::optional<DriftOnset> FindDriftOnset(const TrajectoryComparison& comparison,
                                         const SynchronizationOptions& options,
                                         const SelectionContext& context);

// Which band stands out most at `row`: its entry over the band's noise floor, the median of the
// band's entries.
Band StandingOutBand(const Eigen::MatrixXd& discrepancy, int row);

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_DRIFT_ONSET_H_
