// SPDX-License-Identifier: Apache-2.0
// First alignment of two parts of the map that measurements newly tie together.
#ifndef OVERTONE_CORE_MAPPING_FRAME_JOINING_H_
#define OVERTONE_CORE_MAPPING_FRAME_JOINING_H_

#include <optional>
#include <vector>

#include "overtone/core/geometry/se3.h"

namespace overtone {

// A measured relative pose between a pose of one frame and a pose of another.
struct FrameTie {
  Rigid3d older_from_i;  // where its ends are now, each in its own frame
  Rigid3d younger_from_j;
  Rigid3d i_from_j;  // as measured
  Matrix6d information;
};

// One point known in both frames: a landmark, a robot seen by another, a surveyed position.
struct PointTie {
  Eigen::Vector3d point_in_older;
  Eigen::Vector3d point_in_younger;
  double tolerance_m = 0;  // how far apart the two may come to lie and still agree
};

struct FrameAlignment {
  Rigid3d older_from_younger;
  double agreement = 0;  // from 0 to the number of ties
  int tie = -1;          // the pose tie that proposed it; -1: the points did
  int points = 0;        // that agree
};

// Every pose tie proposes an alignment (of many, an even sample), and the points together one; the
// one that the others agree with most wins, so a wrong closure does not decide when there are two
// right ones. Agreement is the sum of the Geman-McClure-like weights 1 / (1 + chi^2 / limit) of all
// ties: drift makes right ones disagree gradually. Agreement 0: there is nothing to align by.
FrameAlignment AlignFrames(const std::vector<FrameTie>& ties, const std::vector<PointTie>& points,
                           double chi_square_limit);

// The alignment that most points agree with, by random samples of two (rotation about z only:
// most odometry knows where gravity points) and, when clearly more agree, of three (any rotation);
// refined over those that agree. Fischler & Bolles, CACM 24(6), 1981. Absent: fewer than three
// agree, or they lie too near one place (or one vertical; for any rotation: one line) to tell the
// rotation. The same points give the same result.
std::optional<FrameAlignment> AlignPoints(const std::vector<PointTie>& points);

}  // namespace overtone

#endif  // OVERTONE_CORE_MAPPING_FRAME_JOINING_H_
