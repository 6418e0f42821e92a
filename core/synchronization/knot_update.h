// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_CORE_SYNCHRONIZATION_KNOT_UPDATE_H_
#define OVERTONE_CORE_SYNCHRONIZATION_KNOT_UPDATE_H_

#include <vector>

#include "overtone/core/synchronization/chord_prediction.h"
#include "overtone/core/synchronization/knot_search.h"

namespace overtone {

// From `known` knots towards `target`, by as few changes as bring the predicted RMSE within
// `allowed_loss_m` of target's: knots of the target come in, the best first, and where there would
// be more than target has, others go, the least missed first. `known` itself when that is near
// enough.
std::vector<int> UpdateKnots(const ChordPrediction& prediction, const std::vector<int>& known,
                             const KnotSet& target, double allowed_loss_m);

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_KNOT_UPDATE_H_
