// SPDX-License-Identifier: Apache-2.0
// Registration from a guess that is metres and degrees off: coarse clouds and long reach first,
// each result being the guess of the next finer resolution, where the first guess does not fit
// better.
#ifndef OVERTONE_CORE_REGISTRATION_COARSE_TO_FINE_H_
#define OVERTONE_CORE_REGISTRATION_COARSE_TO_FINE_H_

#include <memory>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "overtone/core/graph/point_cloud.h"
#include "overtone/core/registration/registration_cloud.h"
#include "overtone/core/registration/registration_covariance.h"
#include "overtone/core/registration/registration_result.h"

namespace overtone {

struct CoarseToFineOptions {
  // Coarse to fine, strictly decreasing. Outdoor LiDAR; IndoorLaserOptions() for planar lasers.
  std::vector<double> voxel_sizes_m = {2.0, 1.0, 0.5, 0.25};
  // Points have a say on counterparts within `reach` voxels; within kernel_width / 2 voxels it is
  // undiminished (gicp.h).
  double reach = 4;
  double kernel_width = 1;
  // Further starts at the coarsest resolution, the guess turned by these about the source's z; the
  // start that overlaps most there is refined.
  std::vector<double> yaw_offsets_rad = {0.5, -0.5};
  int max_iterations = 30;      // at each resolution
  double overlap_distance = 2;  // in finest voxels
  int num_neighbors = 15;  // for a normal: two rings of a LiDAR, where 10 are of one and say little
  double planar_thickness_m = 0.02;
  double correlation_length_m = 1.0;
  CovarianceOptions covariance;

  absl::Status Validate() const;  // InvalidArgument naming the member
  double OverlapDistance() const { return overlap_distance * voxel_sizes_m.back(); }  // metres
};

// For planar lasers. Not for LiDAR: in voxels this small the normals of its sparse rings are
// chance, and hold a corridor along its axis.
CoarseToFineOptions IndoorLaserOptions();

// One cloud at all resolutions of the options. Immutable; any number of threads may use it at once.
class RegistrationPyramid {
 public:
  // InvalidArgument: options; as RegistrationCloud::Create.
  static absl::StatusOr<RegistrationPyramid> Create(const PointCloud& cloud,
                                                    const CoarseToFineOptions& options);

  const std::vector<std::shared_ptr<const RegistrationCloud>>& levels() const { return levels_; }
  const RegistrationCloud& finest() const { return *levels_.back(); }

 private:
  std::vector<std::shared_ptr<const RegistrationCloud>> levels_;  // coarse to fine
};

// Where both clouds are planar, the guess's z, roll and pitch are held.
// InvalidArgument: the options are not valid or not those of the pyramids, the guess is not finite.
// Otherwise there is a result, which says itself what it is worth.
absl::StatusOr<RegistrationResult> RegisterCoarseToFine(const RegistrationPyramid& source,
                                                        const RegistrationPyramid& target,
                                                        const Rigid3d& guess,
                                                        const CoarseToFineOptions& options);

}  // namespace overtone

#endif  // OVERTONE_CORE_REGISTRATION_COARSE_TO_FINE_H_
