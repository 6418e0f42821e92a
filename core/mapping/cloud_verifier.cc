// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/mapping/cloud_verifier.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/place_recognition/field_of_view.h"

namespace overtone {
namespace {

absl::Status CheckRequirements(const CloudRequirements& required, absl::string_view prefix) {
  if (!(required.min_overlap >= 0 && required.min_overlap <= 1)) {
    return absl::InvalidArgumentError(absl::StrCat(prefix, "min_overlap must be in [0, 1]"));
  }
  if (!(required.max_residual_m > 0)) {
    return absl::InvalidArgumentError(absl::StrCat(prefix, "max_residual_m must be positive"));
  }
  return absl::OkStatus();
}

}  // namespace

CoarseToFineOptions CloudVerifierOptions::PlanarRegistration() {
  CoarseToFineOptions options = IndoorLaserOptions();
  options.yaw_offsets_rad = {M_PI};
  return options;
}

absl::Status CloudVerifierOptions::Validate() const {
  RETURN_IF_ERROR(CheckRequirements(required, ""));
  RETURN_IF_ERROR(CheckRequirements(planar_required, "planar_"));
  if (!(max_translation_m > 0)) {
    return absl::InvalidArgumentError("max_translation_m must be positive");
  }
  RETURN_IF_ERROR(planar_registration.Validate());
  return registration.Validate();
}

absl::StatusOr<std::shared_ptr<const RegistrationPyramid>> CloudVerifier::Pyramid(
    const PlaceView& view) const {
  {
    absl::MutexLock lock(&mutex_);
    std::shared_ptr<const RegistrationPyramid> known =
        pyramids_.Find({view.node, view.single_scan});
    if (known != nullptr) return known;
  }
  const bool planar = IsPlanar(*view.cloud, options_.planar_registration.planar_thickness_m);
  ASSIGN_OR_RETURN(RegistrationPyramid made,
                   RegistrationPyramid::Create(*view.cloud, OptionsFor(planar)));
  auto pyramid = std::make_shared<const RegistrationPyramid>(std::move(made));
  absl::MutexLock lock(&mutex_);
  pyramids_.Insert({view.node, view.single_scan}, pyramid);
  return pyramid;
}

const CoarseToFineOptions& CloudVerifier::OptionsFor(bool planar) const {
  return planar ? options_.planar_registration : options_.registration;
}

absl::Status CloudVerifier::Verify(const PlaceView& from, const PlaceView& to,
                                   LoopCandidate& candidate) const {
  ASSIGN_OR_RETURN(const auto target, Pyramid(from));
  ASSIGN_OR_RETURN(const auto source, Pyramid(to));
  const bool planar = target->finest().planar();
  if (source->finest().planar() != planar) {
    return absl::InvalidArgumentError("one of the clouds is planar and the other is not");
  }
  const CloudRequirements& required = planar ? options_.planar_required : options_.required;
  ASSIGN_OR_RETURN(
      const RegistrationResult result,
      RegisterCoarseToFine(*source, *target, candidate.from_tform_to, OptionsFor(planar)));
  if (!result.covariance.allFinite()) {
    return absl::InvalidArgumentError("the clouds leave the relative pose without a covariance");
  }
  RegistrationFigures figures;
  figures.converged = result.converged &&
                      result.target_from_source.translation.norm() <= options_.max_translation_m;
  figures.overlap = result.overlap;
  figures.overlap_threshold = required.min_overlap;
  figures.residual_m = result.residual_m;
  figures.residual_limit_m = required.max_residual_m;
  figures.open_directions = result.open_directions;
  candidate.registration = figures;
  candidate.from_tform_to = result.target_from_source;
  candidate.covariance = result.covariance;
  candidate.measured = true;
  return absl::OkStatus();
}

}  // namespace overtone
