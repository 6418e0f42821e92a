// SPDX-License-Identifier: Apache-2.0
// A graph as a network of conductances: what current flows, and what resistance it meets, between
// two of its nodes.
//     R_ij = (e_i - e_j)^T L^+ (e_i - e_j)
// Kron reduction to nodes among which are i and j leaves R_ij as it is (Doerfler & Bullo, IEEE
// TCAS-I 60(1), 2013). Weights that are information (1 / variance) make R_ij the variance of the
// difference of the two nodes' values, estimated from all edges.
#ifndef OVERTONE_CORE_SPECTRAL_EFFECTIVE_RESISTANCE_H_
#define OVERTONE_CORE_SPECTRAL_EFFECTIVE_RESISTANCE_H_

#include <memory>
#include <vector>

#include "Eigen/Core"
#include "Eigen/SparseCholesky"
#include "absl/status/statusor.h"
#include "overtone/core/spectral/edge_weights.h"

namespace overtone {

// Factorised once; each pair is a sparse solve.
class EffectiveResistance {
 public:
  // laplacian: n x n (graph_laplacian.h). InvalidArgument: not a Laplacian. Internal: the
  // factorisation failed.
  static absl::StatusOr<EffectiveResistance> Create(const SparseMatrix& laplacian);

  // 0 between a node and itself, infinite between nodes that no path joins.
  double Between(int i, int j) const;

  // Of a current of 1 from i to j, which some path joins: what flows along an edge is the
  // difference of its ends' potentials times its weight.
  Eigen::VectorXd Potentials(int i, int j) const;

 private:
  EffectiveResistance() = default;

  std::vector<int> component_;  // of each node
  std::vector<int> row_;        // of each node in the factor, -1: grounded, its component's first
  // Eigen's factor cannot be moved.
  std::shared_ptr<const Eigen::SimplicialLDLT<SparseMatrix>> factor_;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_SPECTRAL_EFFECTIVE_RESISTANCE_H_
