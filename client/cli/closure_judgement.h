// SPDX-License-Identifier: Apache-2.0
// Loop closures against the ground truth.
#ifndef OVERTONE_CLIENT_CLI_CLOSURE_JUDGEMENT_H_
#define OVERTONE_CLIENT_CLI_CLOSURE_JUDGEMENT_H_

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "overtone/client/cli/robot_plan.h"
#include "overtone/client/cli/run_result.h"

namespace overtone {

// How far a closure may be from the truth.
struct ClosureTolerance {
  double translation_m = 1;
  double rotation_rad = 0.1745;  // 10 degrees
  double place_m = 5;            // two keyframes no further apart than this show the same place
};

// "translation=1,rotation=0.1745,place=5", any subset. InvalidArgument: not positive.
absl::StatusOr<ClosureTolerance> ParseClosureTolerance(absl::string_view text);

// What the ground truth says. Absent: it does not know an end, or the two are in frames of their
// own. Where only positions are known, the error is that of the distance and rotations are not
// judged.
std::optional<ClosureTruth> JudgeClosure(const LoopClosure& closure, bool measured,
                                         const std::vector<RobotPlan>& plans,
                                         const ClosureTolerance& tolerance);

// Of all closures that one proposer came up with.
struct ClosureScore {
  struct Count {
    int all = 0;
    int same_place = 0;  // of those judged
  };
  int proposed = 0;
  int judged = 0;
  int same_place = 0;  // the two ends truly are one place
  int accepted = 0;    // in use at the end: accepted, or forced by the operator
  int accepted_judged = 0;
  int accepted_wrong = 0;
  std::map<std::string, Count> verdicts;

  // Right ones among the accepted, and accepted right ones among the true places proposed; absent
  // when there are none to divide by.
  std::optional<double> Precision() const;
  std::optional<double> Recall() const;
};

// By proposer's name.
std::map<std::string, ClosureScore> ScoreClosures(const std::vector<ClosureResult>& closures);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_CLOSURE_JUDGEMENT_H_
