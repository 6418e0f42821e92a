// SPDX-License-Identifier: Apache-2.0
// The collaborative map: missions of odometry, tied into components by loop closures, optimised
// together.
//
// Design: one gauge per component (the first keyframe of its oldest mission stays where its
// odometry put it); the component of the map's oldest mission is the root and defines the map
// frame; a mission that no closure in use ties to the root stays UNANCHORED in its own component's
// frame. Odometry is trusted; closures have to prove themselves.
#ifndef OVERTONE_CORE_MAPPING_MULTI_ROBOT_MAP_H_
#define OVERTONE_CORE_MAPPING_MULTI_ROBOT_MAP_H_

#include <memory>

#include "absl/status/status.h"
#include "overtone/core/graph/submap.h"
#include "overtone/core/mapping/map_snapshot.h"

namespace overtone {

struct MultiRobotMapOptions {
  // How closures are kept from spoiling the map.
  enum class Robust { kNone, kHuber, kGnc };
  Robust robust = Robust::kGnc;
  // A closure whose weighted squared residual stays above this chi-square quantile is an outlier.
  // Default: 6 degrees of freedom, 99.9 %.
  double closure_chi_square_limit = 22.46;
  // Of one solve; GNC makes several.
  int max_iterations = 50;
  int num_threads = 1;

  absl::Status Validate() const;
};

// Not thread-safe: one mapping thread owns it.
class MultiRobotMap {
 public:
  // `options` must be valid.
  explicit MultiRobotMap(const MultiRobotMapOptions& options, uint64_t map_epoch = 1);
  ~MultiRobotMap();
  MultiRobotMap(MultiRobotMap&&) noexcept;
  MultiRobotMap& operator=(MultiRobotMap&&) noexcept;

  // Appends a submap to its mission, starting the mission with sequence 0. The submap's own
  // closures are added as by AddLoopClosure. OutOfRange when sequence or first_index does not
  // follow the mission's last; InvalidArgument, naming the field, for empty submaps, stamps that do
  // not increase, poses that are not finite and covariances that are not positive definite. Then
  // nothing is changed.
  absl::Status AddSubmap(const MissionId& mission, const Submap& submap);

  // Takes a closure between any two missions; waits as PENDING until both ends are in the map. A
  // closure equal to one already there changes nothing. InvalidArgument, naming the field: both
  // ends are the same keyframe, a negative index, values as in AddSubmap. Then nothing is changed.
  absl::Status AddLoopClosure(const LoopClosure& closure);

  // True when something was added since the last Optimise.
  bool dirty() const;

  // Optimises what is there and freezes it under the next revision number (the first is 1). One
  // sparse solve, warm-started from the previous result; with GNC some tens of short ones when a
  // closure contradicts the others.
  std::shared_ptr<const MapSnapshot> Optimise();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_MAPPING_MULTI_ROBOT_MAP_H_
