// SPDX-License-Identifier: Apache-2.0
// The wavelet discrepancy of one mission, revision after revision. Between two of them little
// changes, and what did not is not computed again:
//   - No node moved by more than a tolerance, seen from all of them together: psi stays, with its
//     graph and its lmax.
//   - Then filtering is linear: only the signals' change is filtered and added, and the smaller the
//     change, the coarser it may be filtered.
#ifndef OVERTONE_CORE_SYNCHRONIZATION_DISCREPANCY_FILTER_H_
#define OVERTONE_CORE_SYNCHRONIZATION_DISCREPANCY_FILTER_H_

#include <vector>

#include "Eigen/Core"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "overtone/core/geometry/se3.h"
#include "overtone/core/spectral/edge_weights.h"
#include "overtone/core/spectral/wavelet_transform.h"

namespace overtone {

// How far a node may be from where psi has it, after a rigid motion of all: what a constraint has
// to move by to be sent again, and a change of edge weights by 1 %.
struct GraphReuse {
  double translation_tolerance_m = 0.02;
  double rotation_tolerance_rad = 0.005;
};

// FailedPrecondition where a graph, whose Laplacian has all its diagonal stored, has no edge.
absl::Status CheckHasEdges(const SparseMatrix& laplacian);

// Between calls it keeps graph and coefficients: 12 bytes for each neighbour of each node, and 8
// for each node, scale and channel. Not thread-safe.
class DiscrepancyFilter {
 public:
  DiscrepancyFilter(const RadiusGraphOptions& rule, const WaveletOptions& wavelets,
                    const GraphReuse& reuse = GraphReuse());

  // As WaveletDiscrepancy on the radius graph of `poses`: n x 3. signal_difference: n x channels,
  // finite. FailedPrecondition: no edge; and the errors of RadiusGraphAdjacency and
  // WaveletCoefficients. After an error nothing is kept.
  absl::StatusOr<Eigen::MatrixXd> Filter(const std::vector<Rigid3d>& poses,
                                         const Eigen::MatrixXd& signal_difference);

  // What the last call could use again.
  bool reused_graph() const { return reused_graph_; }
  bool reused_coefficients() const { return reused_coefficients_; }

 private:
  bool StillFits(const std::vector<Rigid3d>& poses) const;
  absl::Status BuildGraph(const std::vector<Rigid3d>& poses);
  absl::Status FilterAll(const Eigen::MatrixXd& signal_difference);
  // False: the change is not small, or too many small errors would add up.
  absl::StatusOr<bool> FilterChange(const Eigen::MatrixXd& signal_difference);
  void Forget();

  const RadiusGraphOptions rule_;
  const WaveletOptions wavelets_;
  const GraphReuse reuse_;
  std::vector<Rigid3d> poses_;  // psi's
  SparseMatrix laplacian_;
  double lmax_ = 0;                            // 0: not known yet
  Eigen::MatrixXd difference_;                 // what coefficients_ belong to
  std::vector<Eigen::MatrixXd> coefficients_;  // per scale, n x channels; empty: none
  Eigen::RowVectorXd error_;                   // of the coefficients, per channel
  bool reused_graph_ = false, reused_coefficients_ = false;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_DISCREPANCY_FILTER_H_
