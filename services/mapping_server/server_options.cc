// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/server_options.h"

#include <algorithm>
#include <initializer_list>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/string_view.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/field_path.h"
#include "overtone/proto/conversion/limits.h"

namespace overtone {
namespace {

template <typename T>
absl::Status InRange(absl::string_view name, T value, T smallest, T largest) {
  if (value >= smallest && value <= largest) return absl::OkStatus();  // false for NaN
  return InvalidField(name, absl::StrCat(value, " is not in [", smallest, ", ", largest, "]"));
}

absl::Status ValidateListen(absl::string_view name, absl::string_view listen) {
  const size_t colon = listen.rfind(':');
  const bool host_and_port = colon != absl::string_view::npos && colon > 0;
  int port = -1;
  if (host_and_port && absl::SimpleAtoi(listen.substr(colon + 1), &port) && port >= 0 &&
      port <= 65535) {
    return absl::OkStatus();
  }
  return InvalidField(name, absl::StrCat("'", listen, "' is not host:port"));
}

absl::Status ValidateWord(absl::string_view name, absl::string_view word,
                          std::initializer_list<absl::string_view> words) {
  if (std::find(words.begin(), words.end(), word) != words.end()) return absl::OkStatus();
  return InvalidField(name, absl::StrCat("'", word, "' is none of ", absl::StrJoin(words, ", ")));
}

}  // namespace

absl::Status ServerLimits::Validate() const {
  constexpr int64_t kGiB = int64_t{1} << 30;
  // A frame around the largest submap takes a few bytes more.
  RETURN_IF_ERROR(InRange<int64_t>("max_message_bytes", max_message_bytes,
                                   limits::kMaxSubmapBytes + 1024, kGiB));
  RETURN_IF_ERROR(
      InRange<int64_t>("upload_window_bytes", upload_window_bytes, limits::kMaxSubmapBytes, kGiB));
  RETURN_IF_ERROR(InRange("max_maps", max_maps, 1, 10000));
  RETURN_IF_ERROR(InRange("max_missions_per_map", max_missions_per_map, 1, 1'000'000));
  RETURN_IF_ERROR(InRange<int64_t>("max_keyframes_per_mission", max_keyframes_per_mission, 1,
                                   limits::kMaxKeyframeIndex));
  RETURN_IF_ERROR(InRange<int64_t>("max_loop_closures_per_map", max_loop_closures_per_map, 0,
                                   limits::kMaxKeyframeIndex));
  RETURN_IF_ERROR(
      InRange<int64_t>("max_submaps_per_map", max_submaps_per_map, 0, limits::kMaxSequence));
  RETURN_IF_ERROR(InRange<int64_t>("max_keyframes_per_map", max_keyframes_per_map, 0,
                                   limits::kMaxKeyframeIndex));
  RETURN_IF_ERROR(
      InRange<int64_t>("max_blobs_per_map", max_blobs_per_map, 0, limits::kMaxKeyframeIndex));
  RETURN_IF_ERROR(InRange<int64_t>("max_blob_bytes", max_blob_bytes, 1, limits::kMaxBlobBytes));
  RETURN_IF_ERROR(InRange<int64_t>("max_stored_blob_bytes", max_stored_blob_bytes, 0, 1024 * kGiB));
  RETURN_IF_ERROR(InRange<int64_t>("max_restore_bytes", max_restore_bytes, 1 << 20, 1024 * kGiB));
  RETURN_IF_ERROR(InRange("max_watchers_per_map", max_watchers_per_map, 1, 1'000'000));
  RETURN_IF_ERROR(InRange("max_concurrent_streams", max_concurrent_streams, 1, 1'000'000));
  return InRange("max_connection_age_s", max_connection_age_s, 0.0, 1e6);
}

absl::Status PublisherOptions::Validate() const {
  RETURN_IF_ERROR(InRange("heartbeat_s", heartbeat_s, 0.01, 3600.0));
  RETURN_IF_ERROR(InRange("history", history, 1, 1000));
  RETURN_IF_ERROR(InRange("max_variants", max_variants, 1, 1000));
  RETURN_IF_ERROR(units.Validate());
  return tolerance.Validate(units);
}

absl::Status ServerOptions::Validate() const {
  RETURN_IF_ERROR(ValidateListen("listen", listen));
  if (data_dir.empty()) return InvalidField("data_dir", "must name a folder, or :memory:");
  if (!metrics_listen.empty()) RETURN_IF_ERROR(ValidateListen("metrics_listen", metrics_listen));
  RETURN_IF_ERROR(ValidateWord("log_level", log_level,
                               {"trace", "debug", "info", "warning", "error", "critical", "off"}));
  RETURN_IF_ERROR(ValidateWord("log_format", log_format, {"text", "json"}));
  RETURN_IF_ERROR(security.Validate(listen));
  RETURN_IF_ERROR(InRange("keepalive_s", keepalive_s, 1.0, 3600.0));
  RETURN_IF_ERROR(InRange("shutdown_s", shutdown_s, 0.0, 600.0));
  RETURN_IF_ERROR(AtField("limits", limits.Validate()));
  RETURN_IF_ERROR(AtField("quotas", quotas.Validate()));
  RETURN_IF_ERROR(AtField("publisher", publisher.Validate()));
  RETURN_IF_ERROR(AtField("graph", graph.Validate()));
  RETURN_IF_ERROR(AtField("map", map.Validate()));
  return AtField("loop_closures", loop_closures.Validate());
}

}  // namespace overtone
