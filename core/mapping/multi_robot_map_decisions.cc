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

void MultiRobotMap::State::Veto(int closure) {
  const bool forced = decisions[closure] == ClosureDecision::kForced ||
                      decisions[closure] == ClosureDecision::kVetoedAfterForced;
  decisions[closure] = forced ? ClosureDecision::kVetoedAfterForced : ClosureDecision::kVetoed;
}

bool MultiRobotMap::State::IsVetoed(int closure) const {
  return decisions[closure] == ClosureDecision::kVetoed ||
         decisions[closure] == ClosureDecision::kVetoedAfterForced;
}

bool MultiRobotMap::State::WouldUse(int closure) const {
  return !IsVetoed(closure) &&
         (InUse(closures[closure].verdict) || decisions[closure] == ClosureDecision::kForced);
}

absl::Status MultiRobotMap::Veto(const std::string& id) {
  const auto found = state_->closure_of_id.find(id);
  if (found == state_->closure_of_id.end()) return NoSuchClosure(id);
  state_->Veto(found->second);
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
  state_->decisions[found->second] = ClosureDecision::kForced;
  state_->dirty = true;
  return absl::OkStatus();
}

absl::StatusOr<int64_t> MultiRobotMap::RollBack(uint64_t revision, uint64_t new_epoch) {
  State& state = *state_;
  ASSIGN_OR_RETURN(const std::set<std::string> in_use_then, state.history.InUseAt(revision));
  int64_t vetoed = 0;
  for (int k = 0; k < static_cast<int>(state.closures.size()); ++k) {
    const bool used_then = in_use_then.count(state.closures[k].id) > 0;
    ClosureDecision& decision = state.decisions[k];
    if (used_then && state.IsVetoed(k)) {
      decision =
          decision == ClosureDecision::kVetoed ? ClosureDecision::kNone : ClosureDecision::kForced;
    } else if (!used_then && state.WouldUse(k)) {
      state.Veto(k);
      ++vetoed;
    }
  }
  state.map_epoch = new_epoch;
  state.dirty = true;
  return vetoed;
}

}  // namespace overtone
