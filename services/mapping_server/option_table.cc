// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/option_table.h"

#include <cstdint>

#include "absl/strings/str_format.h"
#include "yaml-cpp/yaml.h"

namespace overtone {
namespace {

using Robust = MultiRobotMapOptions::Robust;

const std::map<std::string, Robust>& RobustNames() {
  static const auto* const names = new std::map<std::string, Robust>{
      {"none", Robust::kNone}, {"huber", Robust::kHuber}, {"gnc", Robust::kGnc}};
  return *names;
}

bool FromText(const std::string& text, Robust& option) {
  const auto it = RobustNames().find(text);
  if (it == RobustNames().end()) return false;
  option = it->second;
  return true;
}
std::string ToText(Robust option) {
  return option == Robust::kNone ? "none" : option == Robust::kHuber ? "huber" : "gnc";
}

// Any text is one, also what YAML would take for nothing.
bool FromText(const std::string& text, std::string& option) {
  option = text;
  return true;
}

// Also 1 and 0, as the command's variables (OVERTONE_INSECURE is both its and ours) take them.
bool FromText(const std::string& text, bool& option) {
  if (text == "1" || text == "0") {
    option = text == "1";
    return true;
  }
  return YAML::convert<bool>::decode(YAML::Node(text), option);
}

template <typename T>
bool FromText(const std::string& text, T& option) {
  return YAML::convert<T>::decode(YAML::Node(text), option);
}
std::string ToText(double option) { return absl::StrFormat("%.15g", option); }
template <typename T>
std::string ToText(const T& option) {
  return YAML::convert<T>::encode(option).Scalar();
}

const char* TypeOf(const std::string&) { return "text"; }
const char* TypeOf(bool) { return "true or false"; }
const char* TypeOf(double) { return "number"; }
const char* TypeOf(int) { return "integer"; }
const char* TypeOf(int64_t) { return "integer"; }
const char* TypeOf(Robust) { return "none, huber or gnc"; }

template <typename T>
Option Into(const char* key, T& option) {
  return {key, TypeOf(option),
          [&option](const std::string& text) { return FromText(text, option); },
          [&option] { return ToText(option); }};
}

}  // namespace

std::vector<Option> OptionTable(ServerOptions& options) {
  SecurityOptions& security = options.security;
  ServerLimits& limits = options.limits;
  QuotaOptions& quotas = options.quotas;
  PublisherOptions& publisher = options.publisher;
  GraphMonitorOptions& graph = options.graph;
  MultiRobotMapOptions& map = options.map;
  LoopDetectorOptions& loops = options.loop_closures;
  return {
      Into("listen", options.listen),
      Into("data_dir", options.data_dir),
      Into("metrics_listen", options.metrics_listen),
      Into("log_level", options.log_level),
      Into("log_format", options.log_format),
      Into("reflection", options.reflection),
      Into("keepalive_s", options.keepalive_s),
      Into("shutdown_s", options.shutdown_s),
      Into("tls.ca_file", security.files.ca_file),
      Into("tls.certificate_file", security.files.certificate_file),
      Into("tls.key_file", security.files.key_file),
      Into("tls.accept_dns_names", security.accept_dns_names),
      Into("tls.reload_s", security.reload_s),
      Into("access_file", security.access_file),
      Into("insecure", security.insecure),
      Into("limits.max_message_bytes", limits.max_message_bytes),
      Into("limits.upload_window_bytes", limits.upload_window_bytes),
      Into("limits.max_maps", limits.max_maps),
      Into("limits.max_missions_per_map", limits.max_missions_per_map),
      Into("limits.max_keyframes_per_mission", limits.max_keyframes_per_mission),
      Into("limits.max_loop_closures_per_map", limits.max_loop_closures_per_map),
      Into("limits.max_submaps_per_map", limits.max_submaps_per_map),
      Into("limits.max_keyframes_per_map", limits.max_keyframes_per_map),
      Into("limits.max_blob_bytes", limits.max_blob_bytes),
      Into("limits.max_stored_blob_bytes", limits.max_stored_blob_bytes),
      Into("limits.max_blobs_per_map", limits.max_blobs_per_map),
      Into("limits.max_restore_bytes", limits.max_restore_bytes),
      Into("limits.max_watchers_per_map", limits.max_watchers_per_map),
      Into("limits.max_concurrent_streams", limits.max_concurrent_streams),
      Into("limits.max_connection_age_s", limits.max_connection_age_s),
      Into("quotas.max_streams", quotas.max_streams),
      Into("quotas.max_messages_per_s", quotas.max_messages_per_s),
      Into("quotas.messages_burst", quotas.messages_burst),
      Into("quotas.max_bytes_per_s", quotas.max_bytes_per_s),
      Into("quotas.bytes_burst", quotas.bytes_burst),
      Into("quotas.max_calls_per_s", quotas.max_calls_per_s),
      Into("quotas.calls_burst", quotas.calls_burst),
      Into("publisher.heartbeat_s", publisher.heartbeat_s),
      Into("publisher.history", publisher.history),
      Into("publisher.max_variants", publisher.max_variants),
      Into("publisher.position_tolerance_m", publisher.tolerance.position_m),
      Into("publisher.rotation_tolerance_rad", publisher.tolerance.rotation_rad),
      Into("publisher.position_resolution_m", publisher.units.position_m),
      Into("publisher.rotation_resolution_rad", publisher.units.rotation_rad),
      Into("publisher.stamp_resolution_ns", publisher.units.stamp_ns),
      Into("graph.min_distance_m", graph.min_distance_m),
      Into("graph.min_rotation_rad", graph.min_rotation_rad),
      Into("graph.max_nodes", graph.max_nodes),
      Into("graph.reduction_tolerance", graph.reduction_tolerance),
      Into("graph.radius_m", graph.radius_graph.radius_m),
      Into("graph.sigma", graph.radius_graph.sigma),
      Into("map.robust", map.robust),
      Into("map.closure_chi_square_limit", map.closure_chi_square_limit),
      Into("map.sighting_chi_square_limit", map.sighting_chi_square_limit),
      Into("map.consistency_chi_square_limit", map.consistency_chi_square_limit),
      Into("map.min_consistent_closures", map.min_consistent_closures),
      Into("map.point_alignment_tolerance_m", map.point_alignment_tolerance_m),
      Into("map.degenerate_motion_share", map.degenerate_motion_share),
      Into("map.min_candidate_score", map.min_candidate_score),
      Into("map.scored_position_sigma_m", map.scored_position_sigma_m),
      Into("map.max_iterations", map.max_iterations),
      Into("map.num_threads", map.num_threads),
      Into("loop_closures.enabled", loops.enabled),
      Into("loop_closures.num_threads", loops.num_threads),
      Into("loop_closures.gather_length_m", loops.gather_length_m),
      Into("loop_closures.refine_planar_motion", loops.refine_planar_motion),
      Into("loop_closures.max_views", loops.max_views),
      Into("loop_closures.min_range_m", loops.proposer.context.min_range_m),
      Into("loop_closures.max_range_m", loops.proposer.context.max_range_m),
      Into("loop_closures.min_similarity", loops.proposer.min_similarity),
      Into("loop_closures.max_candidates", loops.proposer.max_candidates),
      Into("loop_closures.min_separation_m", loops.proposer.min_separation_m),
      Into("loop_closures.min_loop_length_m", loops.proposer.min_loop_length_m),
      Into("loop_closures.min_overlap", loops.verifier.required.min_overlap),
      Into("loop_closures.max_residual_m", loops.verifier.required.max_residual_m),
      Into("loop_closures.planar_min_overlap", loops.verifier.planar_required.min_overlap),
      Into("loop_closures.planar_max_residual_m", loops.verifier.planar_required.max_residual_m),
      Into("loop_closures.max_translation_m", loops.verifier.max_translation_m),
  };
}

const std::vector<std::string>& OptionKeys() {
  static const auto* const keys = [] {
    ServerOptions options;
    auto* all = new std::vector<std::string>();
    for (const Option& option : OptionTable(options)) all->push_back(option.key);
    return all;
  }();
  return *keys;
}

std::map<std::string, std::string> OptionValues(ServerOptions options) {
  std::map<std::string, std::string> values;
  for (const Option& option : OptionTable(options)) values[option.key] = option.get();
  return values;
}

}  // namespace overtone
