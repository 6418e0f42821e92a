// SPDX-License-Identifier: Apache-2.0
// Distances between poses and the weighted radius graph they span.
#ifndef OVERTONE_CORE_SPECTRAL_EDGE_WEIGHTS_H_
#define OVERTONE_CORE_SPECTRAL_EDGE_WEIGHTS_H_

#include <vector>

#include "Eigen/SparseCore"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "overtone/core/geometry/se3.h"

namespace overtone {

using SparseMatrix = Eigen::SparseMatrix<double>;  // column-major

enum class DistanceMetric {
  kSe3,       // sqrt(tr(Xi M Xi^T)), Xi = wedge(Log(a^-1 b)); with M = I: sqrt(|rho|^2 + 2 |phi|^2)
  kR3,        // |p_a - p_b|
  kSo3,       // geodesic angle
  kSo3Trace,  // tr(R_a R_b^T): a similarity (3 when equal, negative beyond 90 deg), kept to compare
              // with the paper; its edge weight is the trace's magnitude itself
};

// M = diag(m0, m1, m2, m3) of the se3 metric: three for the columns of phi^x, one for rho.
struct MetricWeights {
  Eigen::Vector4d diagonal = Eigen::Vector4d::Ones();
};

// The prototype's signal metric, diag(10, 10, 0.001, 0.001), kept for the golden vectors: 1 m
// counts 0.03, 1 rad 3 to 4.5.
MetricWeights PrototypeSignalWeights();

struct RadiusGraphOptions {
  double radius_m = 7;  // closed ball (the paper's; its prototype has 6)
  double sigma = 1;     // weight = exp(-distance / (2 sigma^2)), the distance not squared
  DistanceMetric metric = DistanceMetric::kSe3;
  MetricWeights weights;

  absl::Status Validate() const;
};

// Log is never formed: |rho| follows from the lengths of the translation along and across the
// rotation axis.
double PoseDistance(const Rigid3d& a, const Rigid3d& b, DistanceMetric metric,
                    const MetricWeights& weights);

// Symmetric adjacency, n x n, no self loops; both (i, j) and (j, i) stored. O(n log n + edges).
// InvalidArgument: options invalid, or a pose is not finite. ResourceExhausted: more than 30
// million edges (a robot that stood still for hours without keyframing; 360 MB).
absl::StatusOr<SparseMatrix> RadiusGraphAdjacency(const std::vector<Rigid3d>& poses,
                                                  const RadiusGraphOptions& options);

}  // namespace overtone

#endif  // OVERTONE_CORE_SPECTRAL_EDGE_WEIGHTS_H_
