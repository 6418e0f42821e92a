// SPDX-License-Identifier: Apache-2.0
// Generalized-ICP: lays one cloud on another, surface on surface. Segal, Haehnel & Thrun, RSS 2009.
// Minimises over T = target_from_source, by Gauss-Newton on SE(3),
//
//     sum_i w_i d_i^T (C_i^target + R C_i^source R^T)^-1 d_i,   d_i = target_i - T source_i,
//
// target_i the nearest to T source_i, C = I - (1 - eps) n n^T, and w_i Geman & McClure's weight for
// the distance along the normals, which lets go of what the other cloud has not seen.
#ifndef OVERTONE_CORE_REGISTRATION_GICP_H_
#define OVERTONE_CORE_REGISTRATION_GICP_H_

#include <vector>

#include "absl/status/status.h"
#include "overtone/core/geometry/se3.h"
#include "overtone/core/registration/registration_cloud.h"

namespace overtone {

struct GicpOptions {
  // Points with no counterpart nearer than this have no say.
  double max_correspondence_distance_m = 1.0;
  // A counterpart this far off along the normals has a quarter of its say.
  double kernel_width_m = 0.3;
  int max_iterations = 30;
  // Converged: a step moves the points by less than this along the normals (rms). Sliding along
  // an axis that nothing holds does not count.
  double tolerance_m = 5e-4;

  absl::Status Validate() const;  // InvalidArgument naming the member
};

struct GicpEstimate {
  Rigid3d target_from_source;
  bool converged = false;
  int iterations = 0;
  // For each source point the index of its counterpart at the last iteration, or -1.
  std::vector<int> target_of_source;
};

// Planar clouds move in their level only, x, y and yaw, when the guess has no z, roll or pitch:
// nothing then pulls out of it. With fewer than 3 counterparts the guess stays as it is, not
// converged. `options` are valid.
GicpEstimate Gicp(const RegistrationCloud& source, const RegistrationCloud& target,
                  const Rigid3d& guess, const GicpOptions& options);

}  // namespace overtone

#endif  // OVERTONE_CORE_REGISTRATION_GICP_H_
