// SPDX-License-Identifier: Apache-2.0
// Everything that steers a comparison, in one place. Defaults after Bernreiter et al. 2024 where it
// states them.
#ifndef OVERTONE_CORE_SYNCHRONIZATION_SYNCHRONIZATION_OPTIONS_H_
#define OVERTONE_CORE_SYNCHRONIZATION_SYNCHRONIZATION_OPTIONS_H_

#include <cstdint>
#include <limits>

#include "absl/status/status.h"
#include "overtone/core/spectral/edge_weights.h"
#include "overtone/core/spectral/wavelet_transform.h"
#include "overtone/core/synchronization/correction_blend.h"
#include "overtone/core/synchronization/odometry_model.h"

namespace overtone {

// What is compared at each node.
enum class SignalKind {
  kDistance,  // paper: distance from the mission's origin (its first associated node) in the signal
              // metric
  kSe3Log,    // ours: the six channels of Log(T_origin^-1 T_n); sees drift tangential to the sphere
              // around the origin
};

enum class SelectionStrategy {
  kNone,              // never correct
  kTopN,              // paper: the n largest entries of the N x 3 discrepancy table
  kThreshold,         // the earlier paper: every entry above a threshold
  kUniform,           // n chords that cut the mission into stretches of equal path length
  kRandom,            // n chords between random nodes, seeded
  kLargestEdgeError,  // the n consecutive node pairs whose relative pose differs most
  kAll,               // every consecutive pair
  kKnots,             // ours: the chords whose predicted result is nearest to the server's estimate
};

struct SelectionOptions {
  SelectionStrategy strategy = SelectionStrategy::kKnots;
  // Labels (node, band) for kTopN, each of which becomes a few constraints; constraints for
  // kUniform, kRandom and kLargestEdgeError. Paper: 15 per comparison. kKnots: constraints in
  // force, at most.
  int n = 15;
  double min_discrepancy =
      0.1;            // floor of kTopN and threshold of kThreshold, in units of the signal
  uint64_t seed = 1;  // kRandom
  // kKnots: near enough. A third of what a constraint is good to by default.
  double tolerance_m = 0.01;

  absl::Status Validate() const;  // InvalidArgument naming the member
};

struct ConstraintOptions {
  int mid_hops = 10;  // mid band: to nodes i - hops and i + hops
  // Large band: to the pivots (middle nodes) of other submaps. All distances are taken from the
  // pivot of the node's own submap, on the server's poses:
  double large_min_distance_m = 5;  // no nearer than this, ...
  double large_min_path_m = 20;     // ... at least so far along the path (arc length) ...
  // ... and no further than this (unbounded: submaps of a car lie hundreds of metres apart; the
  // prototype's configurations have 50 to 75 m for drones indoors);
  double large_max_distance_m = std::numeric_limits<double>::infinity();
  int large_neighbors = 3;  // of those the k nearest
  // Standard deviations of a constraint, for hosts to weigh it against their odometry.
  double sigma_translation_m = 0.03;
  double sigma_rotation_rad = 0.01;

  // A known constraint is sent again only when it moved by more than either.
  double min_translation_change_m = 0.02;
  double min_rotation_change_rad = 0.005;

  absl::Status Validate() const;  // InvalidArgument naming the member
};

// Do no harm: what a batch must be like to be sent.
struct GateOptions {
  bool enabled = true;
  // A batch goes out when it is predicted to bring the host nearer to the server's estimate by more
  // than this, or by a tenth of how far it is; less is noise.
  double min_gain_m = 0.01;
  // A constraint that contradicts the odometry it bridges by more than this (chi square of six
  // degrees of freedom; default: three times the standard deviations of 99.9 %) is either a slip of
  // odometry's or a false loop closure of the server's ...
  double odometry_chi_square_limit = 202;
  // ... and believed when so many revisions, one after the other, have asked for such a one.
  int revisions_to_believe = 3;
  // No pose may move further by one batch, relative to the mission's first.
  double max_correction_m = std::numeric_limits<double>::infinity();
  double max_correction_rad = std::numeric_limits<double>::infinity();

  absl::Status Validate() const;  // InvalidArgument naming the member
};

// Is anything wrong at all (noise_floor.h)? Where not, no constraint is looked for.
struct NoiseFloorOptions {
  bool enabled = true;
  // Of one comparison in which nothing is wrong, at most.
  double false_alarm_probability = 1e-3;
  // Largest error of a published pose: the server's graph.position_tolerance_m and
  // rotation_tolerance_rad.
  double published_tolerance_m = 2e-3;
  double published_tolerance_rad = 5e-4;

  absl::Status Validate() const;  // InvalidArgument naming the member
};

struct SynchronizationOptions {
  RadiusGraphOptions graph;  // metric of the edges
  WaveletOptions wavelets;
  SignalKind signal = SignalKind::kDistance;
  MetricWeights
      signal_weights;  // isotropic by default; the prototype's is PrototypeSignalWeights()
  // Largest difference of stamps for association by time, where the server's nodes carry no known
  // index.
  double association_tolerance_s = 0.5;
  // True: build psi on the whole multi-robot graph instead of on the robot's own nodes.
  bool multi_robot_graph = false;
  SelectionOptions selection;
  ConstraintOptions constraints;
  NoiseFloorOptions noise_floor;
  GateOptions gate;
  BlendLimits blend;
  OdometryModel odometry;  // of steps whose covariance is not known

  absl::Status Validate() const;  // InvalidArgument naming the member
};

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_SYNCHRONIZATION_OPTIONS_H_
