// SPDX-License-Identifier: Apache-2.0
// What the host has been asked to apply so far, and what of it must change.
#ifndef OVERTONE_CORE_SYNCHRONIZATION_CONSTRAINT_HISTORY_H_
#define OVERTONE_CORE_SYNCHRONIZATION_CONSTRAINT_HISTORY_H_

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "overtone/core/synchronization/constraint.h"
#include "overtone/core/synchronization/synchronization_options.h"
#include "overtone/core/synchronization/trajectory_comparison.h"

namespace overtone {

// Known constraints that a comparison does not propose any more.
enum class Unproposed {
  kKeep,     // and refresh: proposals add up from comparison to comparison
  kRetract,  // proposals are all that should be in force
};

// Keyed by constraint id, for one mission. (The prototype keys by position in a list and compares
// matrix entries with one threshold for metres and rotation.) Not thread-safe.
class ConstraintHistory {
 public:
  // The changes that bring the host from what was committed to what the comparison supports:
  //   add      proposals with a new id, in their order;
  //   update   known constraints, proposed again or not, whose transform on the server moved by
  //   more than
  //            min_translation_change_m or min_rotation_change_rad;
  //   retract  known constraints with a keyframe that the server's graph no longer holds. A
  //   keyframe between two that
  //            it holds has only been thinned out; its server pose is taken from the nearer of the
  //            two and the robot's own motion between them.
  // A new map_epoch is a different map: all that is not proposed again is retracted, as with
  // Unproposed::kRetract. Of a chord, the rotation counts by what it moves at its own length.
  ConstraintBatch Reconcile(const std::vector<Constraint>& proposals,
                            const TrajectoryComparison& comparison,
                            const ConstraintOptions& options,
                            Unproposed unproposed = Unproposed::kKeep) const;

  // Takes back those of `ids` that are in force.
  ConstraintBatch Retraction(const std::vector<std::string>& ids,
                             const TrajectoryComparison& comparison) const;

  // In force: what was committed. By id.
  std::vector<Constraint> Active() const;
  // What would be in force with the batch applied.
  std::vector<Constraint> ActiveAfter(const ConstraintBatch& batch) const;

  // The host applied the batch.
  void Commit(const ConstraintBatch& batch);

  // The host starts afresh and holds no constraint.
  void Clear();

  int size() const { return static_cast<int>(constraints_.size()); }

 private:
  std::map<std::string, Constraint> constraints_;
  uint64_t map_epoch_ = 0;  // of the last batch committed
};

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_CONSTRAINT_HISTORY_H_
