// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/mapping_client_options.h"

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/limits.h"

namespace overtone {
namespace {

// Below it a submap of a megabyte takes more than a quarter of an hour.
constexpr int64_t kMinUploadBytesPerS = 1000;

absl::Status CheckPositive(absl::Duration duration, absl::string_view field) {
  if (duration > absl::ZeroDuration() && duration < absl::InfiniteDuration())
    return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(field, ": must be positive and finite, got ", absl::FormatDuration(duration)));
}

}  // namespace

absl::Status MappingClientOptions::Validate() const {
  if (server.empty()) return absl::InvalidArgumentError("server: empty, expected host:port");
  const absl::Status tls_status = tls.Validate(server);
  if (!tls_status.ok()) {
    return absl::Status(tls_status.code(), absl::StrCat("tls.", tls_status.message()));
  }
  RETURN_IF_ERROR(ValidateId(map, "map"));
  RETURN_IF_ERROR(ValidateId(mission.robot, "mission.robot"));
  RETURN_IF_ERROR(ValidateId(mission.mission, "mission.mission"));
  if (outbox_capacity_bytes < limits::kMaxSubmapBytes) {
    return absl::InvalidArgumentError(absl::StrCat("outbox_capacity_bytes: at least ",
                                                   limits::kMaxSubmapBytes, " (one submap), got ",
                                                   outbox_capacity_bytes));
  }
  RETURN_IF_ERROR(CheckPositive(outbox_sync_interval, "outbox_sync_interval"));
  if (max_upload_bytes_per_s != 0 && max_upload_bytes_per_s < kMinUploadBytesPerS) {
    return absl::InvalidArgumentError(absl::StrCat("max_upload_bytes_per_s: 0 or at least ",
                                                   kMinUploadBytesPerS, ", got ",
                                                   max_upload_bytes_per_s));
  }
  const absl::Status cloud_status = clouds.Validate();
  if (!cloud_status.ok()) {
    return absl::Status(cloud_status.code(), absl::StrCat("clouds.", cloud_status.message()));
  }
  if (max_nodes < 0 || max_nodes > limits::kMaxGraphNodes) {
    return absl::InvalidArgumentError(
        absl::StrCat("max_nodes: within 0 and ", limits::kMaxGraphNodes, ", got ", max_nodes));
  }
  if (min_time_between_comparisons < absl::ZeroDuration()) {
    return absl::InvalidArgumentError("min_time_between_comparisons: negative");
  }
  RETURN_IF_ERROR(CheckPositive(initial_backoff, "initial_backoff"));
  RETURN_IF_ERROR(CheckPositive(max_backoff, "max_backoff"));
  RETURN_IF_ERROR(CheckPositive(stale_after, "stale_after"));
  RETURN_IF_ERROR(CheckPositive(clock_offset_warning, "clock_offset_warning"));
  RETURN_IF_ERROR(CheckPositive(report_interval, "report_interval"));
  if (initial_backoff > max_backoff) {
    return absl::InvalidArgumentError("initial_backoff: larger than max_backoff");
  }
  if (synchronization.multi_robot_graph && !whole_map) {
    return absl::InvalidArgumentError("synchronization.multi_robot_graph: needs whole_map");
  }
  const absl::Status status = synchronization.Validate();
  if (!status.ok()) {
    return absl::Status(status.code(), absl::StrCat("synchronization.", status.message()));
  }
  return absl::OkStatus();
}

}  // namespace overtone
