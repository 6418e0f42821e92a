// SPDX-License-Identifier: Apache-2.0
// How well the surfaces that two clouds share determine the motion between them.
//
// A pair of points on a surface measures the motion along its normal n (the mean of both clouds'):
// the sum over the pairs of J^T n n^T J, J = [I, -p^], is their information in units of
// measurements. Its eigenvalues, rotation scaled by how it moves the points, are the numbers of
// measurements along the eigenvectors. What a pair counts is little where its normals disagree or
// are uncertain, where neighbours say the same, and where points are so few that their neighbours
// are far: there normals are chance, and would hold the axis of a corridor that nothing holds.
#ifndef OVERTONE_CORE_REGISTRATION_REGISTRATION_COVARIANCE_H_
#define OVERTONE_CORE_REGISTRATION_REGISTRATION_COVARIANCE_H_

#include <limits>
#include <vector>

#include "overtone/core/geometry/se3.h"
#include "overtone/core/registration/registration_cloud.h"

namespace overtone {

struct CovarianceOptions {
  // A direction is open when less than this share of the measurements speaks for it. Stretches of a
  // simulated bare corridor taken for one another give up to 0.032 along its axis: the sensor draws
  // the same sparse pattern on all of them, so the errors of the normals do not cancel. The
  // recorded pair of recorded_registration_test has 0.049, and is right. Right pairs reach below
  // it, too.
  double min_share = 0.035;
  // What no number of points averages out: calibration, distortion of the scan.
  double systematic_m = 0.01;
  double systematic_rad = 0.002;
  // Standard deviation along an open direction; of a rotation, at the points' distance.
  double open_m = 100;
  // Of what planar clouds hold: z, roll and pitch.
  double held_m = 0.01;
  double held_rad = 0.002;

  absl::Status Validate() const;  // InvalidArgument naming the member
};

struct RegistrationCovariance {
  Matrix6d covariance = Matrix6d::Identity();  // right tangent of target_from_source
  int open_directions = 6;
  double residual_m = std::numeric_limits<double>::infinity();  // rms along the normals
};

// Of the pairs no further apart than max_distance_m. target_of_source: for each source point its
// counterpart or -1.
RegistrationCovariance EstimateCovariance(const RegistrationCloud& source,
                                          const RegistrationCloud& target,
                                          const Rigid3d& target_from_source,
                                          const std::vector<int>& target_of_source,
                                          double max_distance_m, const CovarianceOptions& options);

}  // namespace overtone

#endif  // OVERTONE_CORE_REGISTRATION_REGISTRATION_COVARIANCE_H_
