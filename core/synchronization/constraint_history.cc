// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/constraint_history.h"

#include <algorithm>
#include <optional>
#include <set>

namespace overtone {
namespace {

// A chord may be hundreds of metres long, and the next one begins where it ends.
bool HasMoved(const Constraint& known, const Rigid3d& after, const ConstraintOptions& options) {
  const Rigid3d motion = known.from_tform_to.Inverse() * after;
  const double angle = LogSO3(motion.rotation).norm();
  const double lever = known.kind == ConstraintKind::kChord ? after.translation.norm() : 0;
  return motion.translation.norm() > options.min_translation_change_m ||
         angle > options.min_rotation_change_rad ||
         angle * lever > options.min_translation_change_m;
}

// The server's pose of a keyframe; none where the server's graph does not hold it, nor one on both
// sides of it.
std::optional<Rigid3d> ServerPose(const TrajectoryComparison& comparison, int64_t index) {
  const std::vector<int64_t>& held = comparison.keyframe_index;
  const auto above = std::lower_bound(held.begin(), held.end(), index);
  if (above == held.end()) return std::nullopt;
  if (*above == index) return comparison.server[above - held.begin()];
  const auto thinned =
      std::lower_bound(comparison.unmatched.begin(), comparison.unmatched.end(), index,
                       [](const NodePose& node, int64_t i) { return node.index < i; });
  if (above == held.begin() || thinned == comparison.unmatched.end() || thinned->index != index) {
    return std::nullopt;
  }
  const auto below = above - 1;
  const auto near = index - *below <= *above - index ? below : above;
  const int row = static_cast<int>(near - held.begin());
  return comparison.server[row] * (comparison.onboard[row].Inverse() * thinned->estimate_from_body);
}

// What the server says about a known constraint now; none where it no longer supports it.
std::optional<Rigid3d> ServerTransform(const TrajectoryComparison& comparison,
                                       const Constraint& known) {
  const std::optional<Rigid3d> from = ServerPose(comparison, known.from);
  const std::optional<Rigid3d> to = ServerPose(comparison, known.to);
  if (!from.has_value() || !to.has_value()) return std::nullopt;
  return from->Inverse() * *to;
}

}  // namespace

ConstraintBatch ConstraintHistory::Reconcile(const std::vector<Constraint>& proposals,
                                             const TrajectoryComparison& comparison,
                                             const ConstraintOptions& options,
                                             Unproposed unproposed) const {
  ConstraintBatch batch;
  batch.revision = comparison.revision;
  batch.map_epoch = comparison.map_epoch;
  std::set<std::string> proposed;
  for (const Constraint& proposal : proposals) {
    if (!proposed.insert(proposal.id).second) continue;
    const auto known = constraints_.find(proposal.id);
    if (known == constraints_.end()) {
      batch.add.push_back(proposal);
    } else if (HasMoved(known->second, proposal.from_tform_to, options)) {
      batch.update.push_back(proposal);
    }
  }
  const bool keep = unproposed == Unproposed::kKeep && comparison.map_epoch == map_epoch_;
  for (const auto& [id, known] : constraints_) {
    if (proposed.count(id) > 0) continue;
    const std::optional<Rigid3d> from_tform_to =
        keep ? ServerTransform(comparison, known) : std::nullopt;
    if (!from_tform_to.has_value()) {
      batch.retract.push_back(id);
    } else if (HasMoved(known, *from_tform_to, options)) {
      batch.update.push_back(known);
      batch.update.back().from_tform_to = *from_tform_to;
      batch.update.back().revision = comparison.revision;
    }
  }
  return batch;
}

void ConstraintHistory::Commit(const ConstraintBatch& batch) {
  for (const Constraint& constraint : batch.add) constraints_[constraint.id] = constraint;
  for (const Constraint& constraint : batch.update) constraints_[constraint.id] = constraint;
  for (const std::string& id : batch.retract) constraints_.erase(id);
  map_epoch_ = batch.map_epoch;
}

ConstraintBatch ConstraintHistory::Retraction(const std::vector<std::string>& ids,
                                              const TrajectoryComparison& comparison) const {
  ConstraintBatch batch;
  batch.revision = comparison.revision;
  batch.map_epoch = comparison.map_epoch;
  for (const std::string& id : ids) {
    if (constraints_.count(id) > 0) batch.retract.push_back(id);
  }
  return batch;
}

std::vector<Constraint> ConstraintHistory::Active() const {
  std::vector<Constraint> active;
  active.reserve(constraints_.size());
  for (const auto& [id, constraint] : constraints_) active.push_back(constraint);
  return active;
}

std::vector<Constraint> ConstraintHistory::ActiveAfter(const ConstraintBatch& batch) const {
  ConstraintHistory after = *this;
  after.Commit(batch);
  return after.Active();
}

void ConstraintHistory::Clear() {
  constraints_.clear();
  map_epoch_ = 0;
}

}  // namespace overtone
