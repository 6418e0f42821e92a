// SPDX-License-Identifier: Apache-2.0
// The collaborative map: missions of odometry, tied into components by loop closures, common
// landmarks, sightings of each other and absolute poses, optimised together.
//
// Design: one gauge per component (the first keyframe of its oldest mission stays where its
// odometry put it). The root component defines the map frame: where there are absolute poses it is
// what they tie down, else the component of the map's oldest mission. A mission that nothing in use
// ties to the root stays UNANCHORED in its own component's frame. Odometry is trusted, and less
// where the robot says so; everything else has to prove itself (loop_closure.h).
#ifndef OVERTONE_CORE_MAPPING_MULTI_ROBOT_MAP_H_
#define OVERTONE_CORE_MAPPING_MULTI_ROBOT_MAP_H_

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "overtone/core/graph/submap.h"
#include "overtone/core/mapping/map_checkpoint.h"
#include "overtone/core/mapping/map_snapshot.h"
#include "overtone/core/mapping/revision_history.h"

namespace overtone {

struct MultiRobotMapOptions {
  // How closures and sightings are kept from spoiling the map.
  enum class Robust { kNone, kHuber, kGnc };
  Robust robust = Robust::kGnc;
  // A closure whose weighted squared residual stays above this chi-square quantile is an outlier.
  // Default: 6 degrees of freedom, 99.9 %.
  double closure_chi_square_limit = 22.46;
  // The same for sightings: 3 degrees of freedom, 99.9 %.
  double sighting_chi_square_limit = 16.27;
  // Between two missions, closures whose cycle with their odometry has a larger chi square disagree
  // (6 degrees of freedom, one in a million; pairwise_consistency.h says why so wide). Pairwise
  // consistency runs only with kGnc.
  double consistency_chi_square_limit = 38.26;
  // The first tie between two components is believed when so many closures agree.
  int min_consistent_closures = 3;
  // Two frames are aligned by common points (landmarks, robots that see each other) when these lie
  // so near each other in the two; drift inside the frames must be smaller.
  double point_alignment_tolerance_m = 0.5;
  // A motion flagged degenerate: standard deviation along the named direction (or all), as a share
  // of its length.
  double degenerate_motion_share = 1;
  // A scored pair without a relative pose: what it must score, and how near the two then are.
  double min_candidate_score = 0.5;
  double scored_position_sigma_m = 1;
  // Of one solve; GNC makes several.
  int max_iterations = 50;
  int num_threads = 1;

  absl::Status Validate() const;
};

// The motion into a keyframe from the one before it, measured a second time: by registering what
// their sensors saw.
struct MotionMeasurement {
  NodeId to;
  Rigid3d previous_from_this;
  Matrix6d covariance = Matrix6d::Identity();  // right tangent of previous_from_this
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
  // closures are added as by AddLoopClosure; its clouds and scored candidates are left to who looks
  // at clouds (AddCandidate, AddScoredCandidate). OutOfRange when sequence or first_index does not
  // follow the mission's last; InvalidArgument, naming the field, for empty submaps, stamps that do
  // not increase, poses that are not finite and covariances that are not positive definite. Then
  // nothing is changed.
  absl::Status AddSubmap(const MissionId& mission, const Submap& submap);

  // Takes a closure between any two missions; waits as PENDING until both ends are in the map. A
  // closure equal to one already there changes nothing. InvalidArgument, naming the field: both
  // ends are the same keyframe, a negative index, values as in AddSubmap. Then nothing is changed.
  absl::Status AddLoopClosure(const LoopClosure& closure);

  // The same for a candidate that was looked at closer. One that fails on its figures is kept with
  // its verdict, for those who ask.
  absl::Status AddCandidate(const LoopCandidate& candidate);

  // A pair that only looks alike, and that nobody can measure: used as a weak tie of positions
  // where its ends share a frame already; it joins no frames.
  absl::Status AddScoredCandidate(const ScoredCandidate& candidate);

  // Fuses it with odometry, by their covariances; one that contradicts odometry is left out.
  // NotFound: no such keyframe, or it is its mission's first. InvalidArgument: a covariance that is
  // not positive definite.
  absl::Status AddMotion(const MotionMeasurement& motion);

  // An operator's word on a candidate. NotFound: no such id. Force: FailedPrecondition when it has
  // no relative pose.
  absl::Status Veto(const std::string& id);
  absl::Status Force(const std::string& id);

  // Vetoes every closure in use that was not in use at `revision` of this epoch, lifts vetoes from
  // those that were (forcing again those whose figures would keep them out), and starts
  // `new_epoch`. Gives the number of closures vetoed. NotFound: the revision is not kept.
  absl::StatusOr<int64_t> RollBack(uint64_t revision, uint64_t new_epoch);

  // True when something was added or decided since the last Optimise.
  bool dirty() const;

  // Of the last snapshot; 0: none yet.
  uint64_t revision() const;

  const RevisionHistory& history() const;

  // Optimises what is there and freezes it under the next revision number (the first is 1), from
  // the previous result on: only what is not at rest any more where that is the smaller part, else
  // one sparse solve of all; with GNC some tens of short ones when a closure contradicts the
  // others. `give_up` is read between the solvers' iterations, whichever thread sets it: once it is
  // true the result is null, the estimate and the revision are as before, and the map is dirty.
  std::shared_ptr<const MapSnapshot> Optimise(const std::atomic<bool>* give_up = nullptr);

  // What has to be kept to have the map again as it is after Optimise.
  MapCheckpoint Checkpoint() const;
  // Into a map that got the same submaps, closures, candidates and motions as the one of the
  // checkpoint, in the same order, and was not optimised. Gives that map's last snapshot.
  // FailedPrecondition: it is of another map; then nothing is changed.
  absl::StatusOr<std::shared_ptr<const MapSnapshot>> Restore(const MapCheckpoint& checkpoint);

  MapDecisions Decisions() const;
  // In place of those made so far; closures that are not there are passed over.
  void SetDecisions(const MapDecisions& decisions);

  // The next revision comes after this one.
  void StartAfter(uint64_t revision);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_MAPPING_MULTI_ROBOT_MAP_H_
