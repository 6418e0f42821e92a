// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/correction_blend.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"

namespace overtone {
namespace {

// In the axes of the frame that both are seen from.
Eigen::Vector3d Turn(const Rigid3d& before, const Rigid3d& after) {
  return LogSO3(after.rotation * before.rotation.conjugate());
}

}  // namespace

absl::Status BlendLimits::Validate() const {
  for (const auto& [member, value] : {std::pair("max_velocity_m_per_s", max_velocity_m_per_s),
                                      std::pair("max_turn_rad_per_s", max_turn_rad_per_s)}) {
    if (value > 0) continue;
    return absl::InvalidArgumentError(
        absl::StrCat("blend.", member, ": ", value, " is not positive"));
  }
  return absl::OkStatus();
}

double BlendSeconds(const Rigid3d& before, const Rigid3d& after, const BlendLimits& limits) {
  return std::max((after.translation - before.translation).norm() / limits.max_velocity_m_per_s,
                  Turn(before, after).norm() / limits.max_turn_rad_per_s);
}

void CorrectionBlender::Corrected(const Rigid3d& before, const Rigid3d& after, Timestamp now) {
  const Rigid3d shown = Blend(before, now);
  translation_ = after.translation - shown.translation;
  rotation_ = Turn(shown, after);
  start_ = now;
  seconds_ = BlendSeconds(shown, after, limits_);
}

Rigid3d CorrectionBlender::Blend(const Rigid3d& estimate_from_body, Timestamp now) const {
  const double elapsed_s = SecondsBetween(start_, now);
  if (!(elapsed_s < seconds_)) return estimate_from_body;
  const double left = 1 - std::max(elapsed_s, 0.0) / seconds_;
  return Rigid3d(ExpSO3(-left * rotation_) * estimate_from_body.rotation,
                 estimate_from_body.translation - left * translation_);
}

}  // namespace overtone
