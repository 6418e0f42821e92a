// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/synchronization_options.h"

#include <cmath>
#include <initializer_list>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

absl::Status NotInRange(absl::string_view member, double value, absl::string_view range) {
  return absl::InvalidArgumentError(absl::StrCat(member, ": ", value, " is not ", range));
}

using NamedValues = std::initializer_list<std::pair<absl::string_view, double>>;

absl::Status NonNegative(NamedValues values) {
  for (const auto& [member, value] : values) {
    if (!(value >= 0) || !std::isfinite(value)) {
      return NotInRange(member, value, "finite and non-negative");
    }
  }
  return absl::OkStatus();
}

absl::Status Positive(NamedValues values) {
  for (const auto& [member, value] : values) {
    if (!(value > 0) || !std::isfinite(value)) {
      return NotInRange(member, value, "finite and positive");
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status SelectionOptions::Validate() const {
  RETURN_IF_ERROR(Positive({{"selection.n", n}}));
  return NonNegative(
      {{"selection.min_discrepancy", min_discrepancy}, {"selection.tolerance_m", tolerance_m}});
}

absl::Status ConstraintOptions::Validate() const {
  RETURN_IF_ERROR(Positive({{"constraints.mid_hops", mid_hops},
                            {"constraints.sigma_translation_m", sigma_translation_m},
                            {"constraints.sigma_rotation_rad", sigma_rotation_rad}}));
  RETURN_IF_ERROR(NonNegative({{"constraints.large_min_distance_m", large_min_distance_m},
                               {"constraints.large_min_path_m", large_min_path_m},
                               {"constraints.large_neighbors", large_neighbors},
                               {"constraints.min_translation_change_m", min_translation_change_m},
                               {"constraints.min_rotation_change_rad", min_rotation_change_rad}}));
  if (!(large_max_distance_m >= large_min_distance_m)) {
    return NotInRange("constraints.large_max_distance_m", large_max_distance_m,
                      "at least large_min_distance_m");
  }
  return absl::OkStatus();
}

absl::Status GateOptions::Validate() const {
  RETURN_IF_ERROR(NonNegative({{"gate.min_gain_m", min_gain_m}}));
  RETURN_IF_ERROR(Positive({{"gate.odometry_chi_square_limit", odometry_chi_square_limit},
                            {"gate.revisions_to_believe", revisions_to_believe}}));
  for (const auto& [member, value] : {std::pair("gate.max_correction_m", max_correction_m),
                                      std::pair("gate.max_correction_rad", max_correction_rad)}) {
    if (!(value > 0)) return NotInRange(member, value, "positive");
  }
  return absl::OkStatus();
}

absl::Status NoiseFloorOptions::Validate() const {
  RETURN_IF_ERROR(Positive({{"noise_floor.published_tolerance_m", published_tolerance_m},
                            {"noise_floor.published_tolerance_rad", published_tolerance_rad}}));
  if (!(false_alarm_probability > 0 && false_alarm_probability < 1)) {
    return NotInRange("noise_floor.false_alarm_probability", false_alarm_probability, "in (0, 1)");
  }
  return absl::OkStatus();
}

absl::Status SynchronizationOptions::Validate() const {
  RETURN_IF_ERROR(graph.Validate());
  RETURN_IF_ERROR(wavelets.Validate());
  if (!signal_weights.diagonal.allFinite() || !(signal_weights.diagonal.minCoeff() >= 0)) {
    return absl::InvalidArgumentError("signal_weights.diagonal: not finite and non-negative");
  }
  RETURN_IF_ERROR(NonNegative({{"association_tolerance_s", association_tolerance_s}}));
  RETURN_IF_ERROR(selection.Validate());
  RETURN_IF_ERROR(noise_floor.Validate());
  RETURN_IF_ERROR(gate.Validate());
  RETURN_IF_ERROR(blend.Validate());
  RETURN_IF_ERROR(odometry.Validate());
  return constraints.Validate();
}

}  // namespace overtone
