// SPDX-License-Identifier: Apache-2.0
#include <set>
#include <string>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/mapping/multi_robot_map_state.h"

namespace overtone {
namespace {

absl::Status NoSuchClosure(const std::string& id) {
  return absl::NotFoundError(absl::StrCat("id: no loop closure \"", id, "\""));
}

}  // namespace

absl::Status MultiRobotMap::Veto(const std::string& id) {
  const auto found = state_->closure_of_id.find(id);
  if (found == state_->closure_of_id.end()) return NoSuchClosure(id);
  state_->decisions[found->second] = State::Decision::kVetoed;
  state_->dirty = true;
  return absl::OkStatus();
}

absl::Status MultiRobotMap::Force(const std::string& id) {
  const auto found = state_->closure_of_id.find(id);
  if (found == state_->closure_of_id.end()) return NoSuchClosure(id);
  if (!state_->closures[found->second].candidate.measured) {
    return absl::FailedPreconditionError(
        absl::StrCat("id: \"", id, "\" has no relative pose that could be used"));
  }
  state_->decisions[found->second] = State::Decision::kForced;
  state_->dirty = true;
  return absl::OkStatus();
}

absl::StatusOr<int64_t> MultiRobotMap::RollBack(uint64_t revision, uint64_t new_epoch) {
  State& state = *state_;
  ASSIGN_OR_RETURN(const std::set<std::string> in_use_then, state.history.InUseAt(revision));
  int64_t vetoed = 0;
  for (size_t k = 0; k < state.closures.size(); ++k) {
    const bool used_then = in_use_then.count(state.closures[k].id) > 0;
    State::Decision& decision = state.decisions[k];
    if (used_then && decision == State::Decision::kVetoed) {
      // What its figures keep out was in use by an operator's word.
      const bool fits = JudgeFigures(state.closures[k].candidate) == ClosureVerdict::kPending;
      decision = fits ? State::Decision::kNone : State::Decision::kForced;
    } else if (!used_then && InUse(state.closures[k].verdict)) {
      decision = State::Decision::kVetoed;
      ++vetoed;
    }
  }
  state.map_epoch = new_epoch;
  state.dirty = true;
  return vetoed;
}

}  // namespace overtone
