// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/mapping/cloud_verifier.h"

#include <utility>

#include "overtone/core/common/status_macros.h"

namespace overtone {

absl::Status CloudVerifierOptions::Validate() const {
  if (!(min_overlap >= 0 && min_overlap <= 1)) {
    return absl::InvalidArgumentError("min_overlap must be in [0, 1]");
  }
  if (!(max_residual_m > 0)) return absl::InvalidArgumentError("max_residual_m must be positive");
  if (!(max_translation_m > 0)) {
    return absl::InvalidArgumentError("max_translation_m must be positive");
  }
  return registration.Validate();
}

absl::StatusOr<std::shared_ptr<const RegistrationPyramid>> CloudVerifier::Pyramid(
    const PlaceView& view) const {
  {
    absl::MutexLock lock(&mutex_);
    std::shared_ptr<const RegistrationPyramid> known = pyramids_.Find(view.node);
    if (known != nullptr) return known;
  }
  ASSIGN_OR_RETURN(RegistrationPyramid made,
                   RegistrationPyramid::Create(*view.cloud, options_.registration));
  auto pyramid = std::make_shared<const RegistrationPyramid>(std::move(made));
  absl::MutexLock lock(&mutex_);
  pyramids_.Insert(view.node, pyramid);
  return pyramid;
}

absl::Status CloudVerifier::Verify(const PlaceView& from, const PlaceView& to,
                                   LoopCandidate& candidate) const {
  ASSIGN_OR_RETURN(const auto target, Pyramid(from));
  ASSIGN_OR_RETURN(const auto source, Pyramid(to));
  ASSIGN_OR_RETURN(
      const RegistrationResult result,
      RegisterCoarseToFine(*source, *target, candidate.from_tform_to, options_.registration));
  RegistrationFigures figures;
  figures.converged = result.converged &&
                      result.target_from_source.translation.norm() <= options_.max_translation_m;
  figures.overlap = result.overlap;
  figures.overlap_threshold = options_.min_overlap;
  figures.residual_m = result.residual_m;
  figures.residual_limit_m = options_.max_residual_m;
  figures.open_directions = result.open_directions;
  candidate.registration = figures;
  candidate.from_tform_to = result.target_from_source;
  candidate.covariance = result.covariance;
  candidate.measured = true;
  return absl::OkStatus();
}

}  // namespace overtone
