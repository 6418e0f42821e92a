// SPDX-License-Identifier: Apache-2.0
// The signal on the graph: how far each node is from the mission's origin.
#ifndef OVERTONE_CORE_SYNCHRONIZATION_TRAJECTORY_SIGNAL_H_
#define OVERTONE_CORE_SYNCHRONIZATION_TRAJECTORY_SIGNAL_H_

#include <vector>

#include "Eigen/Core"
#include "overtone/core/spectral/edge_weights.h"
#include "overtone/core/synchronization/synchronization_options.h"

namespace overtone {

// One row per pose; the origin T_o is the first pose. Bernreiter et al. 2024, "Signals".
//
// kDistance: n x 1, f(n) = Delta(T_o, T_n) in `metric` (kSo3Trace: the trace).
// kSe3Log:   n x 6, ours: the channels [rho; phi] of Log(T_o^-1 T_n), scaled such that the norm of
// a row is the se3
//            distance under `weights`. A scalar distance cannot see drift tangential to the sphere
//            around the origin.
//
// The same motion of all poses changes nothing: frames of server and robot may differ.
Eigen::MatrixXd TrajectorySignal(const std::vector<Rigid3d>& poses, SignalKind kind,
                                 DistanceMetric metric, const MetricWeights& weights);

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_TRAJECTORY_SIGNAL_H_
