// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/mapping/frame_joining.h"

#include <algorithm>

namespace overtone {
namespace {

constexpr size_t kMaxProposals = 200;

double Agreement(const std::vector<FrameTie>& ties, const Rigid3d& older_from_younger,
                 double chi_square_limit) {
  double agreement = 0;
  for (const FrameTie& tie : ties) {
    const Rigid3d i_from_j = tie.older_from_i.Inverse() * older_from_younger * tie.younger_from_j;
    const Vector6d error = Log(tie.i_from_j.Inverse() * i_from_j);
    agreement += 1 / (1 + error.dot(tie.information * error) / chi_square_limit);
  }
  return agreement;
}

}  // namespace

FrameAlignment AlignFrames(const std::vector<FrameTie>& ties, double chi_square_limit) {
  FrameAlignment best;
  const size_t stride = std::max<size_t>(1, (ties.size() + kMaxProposals - 1) / kMaxProposals);
  for (size_t k = 0; k < ties.size(); k += stride) {
    const FrameTie& tie = ties[k];
    const Rigid3d proposal = tie.older_from_i * tie.i_from_j * tie.younger_from_j.Inverse();
    const double agreement = Agreement(ties, proposal, chi_square_limit);
    if (agreement > best.agreement) best = {proposal, agreement, static_cast<int>(k)};
  }
  return best;
}

}  // namespace overtone
