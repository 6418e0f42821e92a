// SPDX-License-Identifier: Apache-2.0
// The collaborative map: missions of odometry, tied into components by loop closures, optimised together.
//
// Design: one gauge per component (the first keyframe of its oldest mission stays where its odometry put it);
// the component of the map's oldest mission is the root and defines the map frame; a mission that no closure
// ties to the root stays UNANCHORED in its own component's frame.
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
  // A closure whose weighted squared residual stays above this chi-square quantile is an outlier. Default: 6
  // degrees of freedom, 99.9 %.
  double closure_chi_square_limit = 22.46;
  int max_iterations = 50;

  absl::Status Validate() const;
};

// Not thread-safe: one mapping thread owns it.
class MultiRobotMap {
 public:
  explicit MultiRobotMap(const MultiRobotMapOptions& options, uint64_t map_epoch = 1);
  ~MultiRobotMap();
  MultiRobotMap(MultiRobotMap&&) noexcept;
  MultiRobotMap& operator=(MultiRobotMap&&) noexcept;

  // Appends a submap to its mission, starting the mission with sequence 0. The submap's own closures are added as
  // by AddLoopClosure. OutOfRange when first_index does not follow the mission's last keyframe; InvalidArgument
  // for empty submaps and for stamps that do not increase. Then nothing is changed.
  absl::Status AddSubmap(const MissionId& mission, const Submap& submap);

  // Takes a closure between any two missions; waits as PENDING until both ends are in the map. A closure equal to
  // one already there changes nothing. InvalidArgument: both ends are the same keyframe.
  absl::Status AddLoopClosure(const LoopClosure& closure);

  // True when something was added since the last Optimise.
  bool dirty() const;

  // Optimises what is there and freezes it under the next revision number (the first is 1). Complexity: one or a
  // few sparse Gauss-Newton runs, warm-started from the previous result.
  std::shared_ptr<const MapSnapshot> Optimise();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_MAPPING_MULTI_ROBOT_MAP_H_
