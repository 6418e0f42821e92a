// SPDX-License-Identifier: Apache-2.0
// How much of a place two clouds have in common.
#ifndef OVERTONE_CORE_REGISTRATION_OVERLAP_H_
#define OVERTONE_CORE_REGISTRATION_OVERLAP_H_

#include "overtone/core/geometry/se3.h"
#include "overtone/core/registration/registration_cloud.h"

namespace overtone {

// Share of the points of the smaller cloud with one of the other nearer than `distance_m`, [0, 1].
// Of the smaller: a scan inside a large submap overlaps it fully.
double Overlap(const RegistrationCloud& source, const RegistrationCloud& target,
               const Rigid3d& target_from_source, double distance_m);

}  // namespace overtone

#endif  // OVERTONE_CORE_REGISTRATION_OVERLAP_H_
