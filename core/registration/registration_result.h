// SPDX-License-Identifier: Apache-2.0
// Where one cloud lies in another, and how far that can be believed.
#ifndef OVERTONE_CORE_REGISTRATION_REGISTRATION_RESULT_H_
#define OVERTONE_CORE_REGISTRATION_REGISTRATION_RESULT_H_

#include "overtone/core/geometry/se3.h"

namespace overtone {

struct RegistrationResult {
  Rigid3d target_from_source;
  bool converged = false;
  int iterations = 0;  // over all resolutions of the winning start
  // Share of the points of the cloud with fewer of them (at the finest resolution) that have one of
  // the other within the overlap distance, [0, 1]. Swapping the clouds does not change it.
  double overlap = 0;
  // rms distance along the normals of the pairs within the overlap distance; infinite without any.
  double residual_m = 0;
  // Right tangent of target_from_source. See registration_covariance.h.
  Matrix6d covariance = Matrix6d::Identity();
  // Of the six directions of the tangent (x, y and yaw for planar clouds), those that the surfaces
  // do not determine. Their variance is so large that it says nothing.
  int open_directions = 6;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_REGISTRATION_REGISTRATION_RESULT_H_
