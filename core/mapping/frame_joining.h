// SPDX-License-Identifier: Apache-2.0
// First alignment of two parts of the map that closures newly tie together.
#ifndef OVERTONE_CORE_MAPPING_FRAME_JOINING_H_
#define OVERTONE_CORE_MAPPING_FRAME_JOINING_H_

#include <vector>

#include "overtone/core/geometry/se3.h"

namespace overtone {

// A closure between a pose of one frame and a pose of another.
struct FrameTie {
  Rigid3d older_from_i;  // where its ends are now, each in its own frame
  Rigid3d younger_from_j;
  Rigid3d i_from_j;  // as measured
  Matrix6d information;
};

struct FrameAlignment {
  Rigid3d older_from_younger;
  double agreement = 0;  // from 1 to the number of ties
  int tie = -1;          // the one that proposed it
};

// Every tie proposes an alignment (of many, an even sample); the one that the others agree with
// most wins, so a wrong closure does not decide when there are two right ones. Agreement is the sum
// of the Geman-McClure-like weights 1 / (1 + chi^2 / limit) of all ties: drift makes right ones
// disagree gradually. `ties` must not be empty.
FrameAlignment AlignFrames(const std::vector<FrameTie>& ties, double chi_square_limit);

}  // namespace overtone

#endif  // OVERTONE_CORE_MAPPING_FRAME_JOINING_H_
