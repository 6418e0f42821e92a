// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/registration/overlap.h"

namespace overtone {
namespace {

double ShareWithNeighbor(const RegistrationCloud& of, const RegistrationCloud& in,
                         const Rigid3d& in_from_of, double distance_m) {
  const Eigen::Matrix3f rotation = in_from_of.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f translation = in_from_of.translation.cast<float>();
  const float max_squared_distance = static_cast<float>(distance_m * distance_m);
  int num_found = 0;
  for (const Eigen::Vector3f& point : of.points()) {
    num_found += in.tree().Nearest(rotation * point + translation, max_squared_distance).index >= 0;
  }
  return static_cast<double>(num_found) / of.size();
}

}  // namespace

double Overlap(const RegistrationCloud& source, const RegistrationCloud& target,
               const Rigid3d& target_from_source, double distance_m) {
  return source.size() <= target.size()
             ? ShareWithNeighbor(source, target, target_from_source, distance_m)
             : ShareWithNeighbor(target, source, target_from_source.Inverse(), distance_m);
}

}  // namespace overtone
