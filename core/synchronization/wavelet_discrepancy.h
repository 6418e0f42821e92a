// SPDX-License-Identifier: Apache-2.0
// Where and at which scale do the server's and the robot's estimate disagree?
// Bernreiter et al. 2024, "Discrepancy detection".
#ifndef OVERTONE_CORE_SYNCHRONIZATION_WAVELET_DISCREPANCY_H_
#define OVERTONE_CORE_SYNCHRONIZATION_WAVELET_DISCREPANCY_H_

#include <vector>

#include "absl/status/statusor.h"
#include "overtone/core/common/ids.h"
#include "overtone/core/graph/map_graph.h"
#include "overtone/core/synchronization/discrepancy_filter.h"
#include "overtone/core/synchronization/node_association.h"
#include "overtone/core/synchronization/synchronization_options.h"
#include "overtone/core/synchronization/trajectory_comparison.h"

namespace overtone {

// Band of scale s out of S >= 3: thirds, {0,1} {2,3} {4,5} for S = 6; the wider bands first where 3
// does not divide S.
Band BandOfScale(int scale, int num_scales);

// n x 3: for each node and Band the sum over the band's scales of |W|, the norm over the channels.
// coefficients: per scale, n x channels.
Eigen::MatrixXd BandSums(const std::vector<Eigen::MatrixXd>& coefficients);

// n x 3: BandSums of W_server - W_robot, which is (g_s(L) (f - h))_n since both share psi: one
// filtering of the one difference f - h (n x channels).
absl::StatusOr<Eigen::MatrixXd> WaveletDiscrepancy(const SparseMatrix& laplacian,
                                                   const Eigen::MatrixXd& signal_difference,
                                                   const WaveletOptions& options);

// Compares a mission of the server's graph with the robot's own trajectory, revision after
// revision.
class TrajectoryComparator {
 public:
  explicit TrajectoryComparator(const SynchronizationOptions& options);

  // `onboard` in any order. What a comparison has in common with the one before it, of the same
  // mission, is not computed again (discrepancy_filter.h).
  //
  // psi lives on the server's poses: on the mission's associated nodes, or with
  // options.multi_robot_graph on all nodes of the mission's component, where the difference of
  // nodes without a counterpart is 0. Weights are graph.edges where present (Kron-reduced), else
  // those of the radius graph. The origin of both signals is the first associated node.
  //
  // InvalidArgument: options, a bad keyframe (named by its index) or pose, graph.edges out of
  // range. NotFound: the graph has no such mission. FailedPrecondition: fewer than three nodes in
  // common, or none of them within radius_m of another.
  absl::StatusOr<TrajectoryComparison> Compare(const MapGraph& graph, const MissionId& mission,
                                               const std::vector<NodePose>& onboard);

  const DiscrepancyFilter& filter() const { return filter_; }

 private:
  absl::StatusOr<Eigen::MatrixXd> Discrepancy(const MapGraph& graph,
                                              const std::vector<int>& node_of_position,
                                              const std::vector<Rigid3d>& nodes,
                                              const Eigen::MatrixXd& signal_difference);

  const SynchronizationOptions options_;
  DiscrepancyFilter filter_;
};

// One comparison alone.
absl::StatusOr<TrajectoryComparison> CompareTrajectories(const MapGraph& graph,
                                                         const MissionId& mission,
                                                         const std::vector<NodePose>& onboard,
                                                         const SynchronizationOptions& options);

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_WAVELET_DISCREPANCY_H_
