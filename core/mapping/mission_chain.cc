// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/mapping/mission_chain.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace overtone {
namespace {

// Chi square of how far the ends may be from where their stretch was relaxed: moved by less, it is
// carried along as it is.
constexpr double kStillChiSquare = 1e-7;

// A stretch whose best path costs more is looked at again from odometry's.
constexpr double kTornChiSquare = 100;

void FollowOdometry(int first, int last, const ChainMotions& motions, std::vector<Rigid3d>& poses) {
  for (int k = first + 1; k <= last; ++k) {
    poses[k] = poses[k - 1] * motions[k].previous_from_this;
  }
}

// Where what tore the poses apart is gone (a wrong closure, vetoed), the way back from there may
// lead nowhere: then from odometry's own path. And where the ends lie too far apart even for that,
// the edge is odometry's, undisturbed, which brings them together.
MissionChain::Stretch Relaxed(int first, int last, const ChainMotions& motions,
                              std::vector<Rigid3d>& poses) {
  MissionChain::Stretch stretch;
  stretch.first = first;
  stretch.last = last;
  stretch.edge = RelaxChain(motions, first, last, poses);
  if (!stretch.edge.converged || stretch.edge.chi_square > kTornChiSquare) {
    const std::vector<Rigid3d> bent(poses.begin() + first, poses.begin() + last + 1);
    FollowOdometry(first, last, motions, poses);
    const MissionChain::Stretch undisturbed = {first, last, poses[first].Inverse() * poses[last],
                                               RelaxChain(motions, first, last, poses)};
    poses[last] = bent.back();
    const CompoundMotion again = RelaxChain(motions, first, last, poses);
    if (!again.converged && !stretch.edge.converged) return undisturbed;
    if (!again.converged || again.chi_square > stretch.edge.chi_square) {
      std::copy(bent.begin(), bent.end(), poses.begin() + first);
    } else {
      stretch.edge = again;
    }
  }
  stretch.first_from_last = poses[first].Inverse() * poses[last];
  return stretch;
}

double EdgeChiSquare(const CompoundMotion& edge, const Rigid3d& first_from_last) {
  const Vector6d error = Log(edge.first_from_last.Inverse() * first_from_last);
  return error.dot(edge.information * error);
}

bool Same(const Rigid3d& a, const Rigid3d& b) {
  return a.rotation.coeffs() == b.rotation.coeffs() && a.translation == b.translation;
}

}  // namespace

void MissionChain::SetJoints(std::vector<int> joints, const ChainMotions& motions,
                             std::vector<Rigid3d>& poses) {
  std::vector<Stretch> old = std::exchange(stretches_, {});
  joints_ = std::move(joints);
  stretches_.reserve(joints_.size() - 1);
  auto candidate = old.begin();
  for (size_t j = 0; j + 1 < joints_.size(); ++j) {
    const int first = joints_[j], last = joints_[j + 1];
    while (candidate != old.end() && candidate->first < first) ++candidate;
    const bool is_there =
        candidate != old.end() && candidate->first == first && candidate->last == last;
    stretches_.push_back(is_there ? std::move(*candidate) : Relaxed(first, last, motions, poses));
  }
  FollowLast(motions, poses);
}

void MissionChain::FollowLast(const ChainMotions& motions, std::vector<Rigid3d>& poses) const {
  for (size_t k = joints_.back() + 1; k < poses.size(); ++k) {
    poses[k] = poses[k - 1] * motions[k].previous_from_this;
  }
}

void MissionChain::Forget(int from) {
  const auto gone = std::find_if(stretches_.begin(), stretches_.end(),
                                 [&](const Stretch& stretch) { return stretch.last >= from; });
  stretches_.erase(gone, stretches_.end());
}

double MissionChain::Move(const Rigid3d* pose_of_joint, const ChainMotions& motions,
                          std::vector<Rigid3d>& poses) {
  double surprise = 0;
  for (size_t j = 0; j < joints_.size(); ++j) {
    const Rigid3d new_from_old = pose_of_joint[j] * poses[joints_[j]].Inverse();
    const bool moves = !Same(pose_of_joint[j], poses[joints_[j]]);
    poses[joints_[j]] = pose_of_joint[j];
    if (j == stretches_.size()) break;
    Stretch& stretch = stretches_[j];
    for (int k = stretch.first + 1; moves && k < stretch.last; ++k) {
      poses[k] = new_from_old * poses[k];
    }
    const Rigid3d first_from_last = pose_of_joint[j].Inverse() * pose_of_joint[j + 1];
    const Vector6d moved = Log(stretch.first_from_last.Inverse() * first_from_last);
    if (moved.dot(stretch.edge.information * moved) <= kStillChiSquare) continue;
    const double expected = EdgeChiSquare(stretch.edge, first_from_last);
    const Rigid3d last = std::exchange(poses[stretch.last], pose_of_joint[j + 1]);
    stretch = Relaxed(stretch.first, stretch.last, motions, poses);
    poses[stretch.last] = last;  // its turn comes: what follows it moves with it
    surprise += std::abs(stretch.edge.chi_square - expected);
  }
  FollowLast(motions, poses);
  return surprise;
}

int MissionChain::JointOf(int keyframe) const {
  return static_cast<int>(std::lower_bound(joints_.begin(), joints_.end(), keyframe) -
                          joints_.begin());
}

}  // namespace overtone
