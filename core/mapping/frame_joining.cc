// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/mapping/frame_joining.h"

#include <algorithm>

namespace overtone {
namespace {

constexpr size_t kMaxProposals = 200;

double PoseAgreement(const std::vector<FrameTie>& ties, const Rigid3d& older_from_younger,
                     double chi_square_limit) {
  double agreement = 0;
  for (const FrameTie& tie : ties) {
    const Rigid3d i_from_j = tie.older_from_i.Inverse() * older_from_younger * tie.younger_from_j;
    const Vector6d error = Log(tie.i_from_j.Inverse() * i_from_j);
    agreement += 1 / (1 + error.dot(tie.information * error) / chi_square_limit);
  }
  return agreement;
}

double PointAgreement(const std::vector<PointTie>& points, const Rigid3d& older_from_younger,
                      int* num_agreeing) {
  double agreement = 0;
  *num_agreeing = 0;
  for (const PointTie& point : points) {
    const double error =
        (older_from_younger * point.point_in_younger - point.point_in_older).norm() /
        point.tolerance_m;
    agreement += 1 / (1 + error * error);
    *num_agreeing += error <= 1;
  }
  return agreement;
}

}  // namespace

FrameAlignment AlignFrames(const std::vector<FrameTie>& ties, const std::vector<PointTie>& points,
                           double chi_square_limit) {
  FrameAlignment best;
  const auto consider = [&](const Rigid3d& proposal, int tie) {
    FrameAlignment alignment{proposal, 0, tie, 0};
    alignment.agreement = PoseAgreement(ties, proposal, chi_square_limit) +
                          PointAgreement(points, proposal, &alignment.points);
    if (alignment.agreement > best.agreement) best = alignment;
  };
  const size_t stride = std::max<size_t>(1, (ties.size() + kMaxProposals - 1) / kMaxProposals);
  for (size_t k = 0; k < ties.size(); k += stride) {
    const FrameTie& tie = ties[k];
    consider(tie.older_from_i * tie.i_from_j * tie.younger_from_j.Inverse(), static_cast<int>(k));
  }
  const std::optional<FrameAlignment> by_points = AlignPoints(points);
  if (by_points.has_value()) consider(by_points->older_from_younger, -1);
  return best;
}

}  // namespace overtone
