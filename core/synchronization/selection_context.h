// SPDX-License-Identifier: Apache-2.0
// What a selection may know beside the comparison.
#ifndef OVERTONE_CORE_SYNCHRONIZATION_SELECTION_CONTEXT_H_
#define OVERTONE_CORE_SYNCHRONIZATION_SELECTION_CONTEXT_H_

#include <vector>

#include "overtone/core/synchronization/constraint.h"

namespace overtone {

struct SelectionContext {
  // Of the comparison's rows: where odometry alone puts them (any fixed frame), and the covariance
  // of the motion from the row before (right tangent; [0] is not read). Empty: the host's estimate
  // and SynchronizationOptions::odometry.
  std::vector<Rigid3d> odometry;
  std::vector<Matrix6d> step_covariance;
  // What the host holds already.
  std::vector<Constraint> active;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_SELECTION_CONTEXT_H_
