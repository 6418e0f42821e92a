// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/options_file.h"

#include <algorithm>
#include <fstream>
#include <functional>
#include <map>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/string_view.h"
#include "overtone/core/common/status_macros.h"
#include "yaml-cpp/yaml.h"

namespace overtone {
namespace {

using Robust = MultiRobotMapOptions::Robust;

bool FromScalar(const YAML::Node& scalar, Robust& option) {
  const std::map<std::string, Robust> values = {
      {"none", Robust::kNone}, {"huber", Robust::kHuber}, {"gnc", Robust::kGnc}};
  const auto it = values.find(scalar.Scalar());
  if (it == values.end()) return false;
  option = it->second;
  return true;
}
std::string ToScalar(Robust option) {
  return option == Robust::kNone ? "none" : option == Robust::kHuber ? "huber" : "gnc";
}

template <typename T>
bool FromScalar(const YAML::Node& scalar, T& option) {
  return YAML::convert<T>::decode(scalar, option);
}
std::string ToScalar(double option) { return absl::StrFormat("%.15g", option); }
template <typename T>
std::string ToScalar(const T& option) {
  return YAML::convert<T>::encode(option).Scalar();
}

struct Key {
  std::function<bool(const YAML::Node&)> set;  // false: not of the option's type
  std::function<std::string()> get;
};

template <typename T>
Key Into(T& option) {
  return {[&option](const YAML::Node& scalar) { return FromScalar(scalar, option); },
          [&option] { return ToScalar(option); }};
}

// The one list of keys.
std::map<std::string, Key> Keys(ServerOptions& options) {
  SecurityOptions& security = options.security;
  ServerLimits& limits = options.limits;
  QuotaOptions& quotas = options.quotas;
  PublisherOptions& publisher = options.publisher;
  GraphMonitorOptions& graph = options.graph;
  MultiRobotMapOptions& map = options.map;
  LoopDetectorOptions& loops = options.loop_closures;
  return {
      {"listen", Into(options.listen)},
      {"data_dir", Into(options.data_dir)},
      {"metrics_listen", Into(options.metrics_listen)},
      {"log_level", Into(options.log_level)},
      {"log_format", Into(options.log_format)},
      {"reflection", Into(options.reflection)},
      {"keepalive_s", Into(options.keepalive_s)},
      {"shutdown_s", Into(options.shutdown_s)},
      {"tls.ca_file", Into(security.files.ca_file)},
      {"tls.certificate_file", Into(security.files.certificate_file)},
      {"tls.key_file", Into(security.files.key_file)},
      {"tls.accept_dns_names", Into(security.accept_dns_names)},
      {"tls.reload_s", Into(security.reload_s)},
      {"access_file", Into(security.access_file)},
      {"insecure", Into(security.insecure)},
      {"limits.max_message_bytes", Into(limits.max_message_bytes)},
      {"limits.upload_window_bytes", Into(limits.upload_window_bytes)},
      {"limits.max_maps", Into(limits.max_maps)},
      {"limits.max_missions_per_map", Into(limits.max_missions_per_map)},
      {"limits.max_keyframes_per_mission", Into(limits.max_keyframes_per_mission)},
      {"limits.max_loop_closures_per_map", Into(limits.max_loop_closures_per_map)},
      {"limits.max_submaps_per_map", Into(limits.max_submaps_per_map)},
      {"limits.max_keyframes_per_map", Into(limits.max_keyframes_per_map)},
      {"limits.max_blob_bytes", Into(limits.max_blob_bytes)},
      {"limits.max_stored_blob_bytes", Into(limits.max_stored_blob_bytes)},
      {"limits.max_blobs_per_map", Into(limits.max_blobs_per_map)},
      {"limits.max_restore_bytes", Into(limits.max_restore_bytes)},
      {"limits.max_watchers_per_map", Into(limits.max_watchers_per_map)},
      {"limits.max_concurrent_streams", Into(limits.max_concurrent_streams)},
      {"limits.max_connection_age_s", Into(limits.max_connection_age_s)},
      {"quotas.max_streams", Into(quotas.max_streams)},
      {"quotas.max_messages_per_s", Into(quotas.max_messages_per_s)},
      {"quotas.messages_burst", Into(quotas.messages_burst)},
      {"quotas.max_bytes_per_s", Into(quotas.max_bytes_per_s)},
      {"quotas.bytes_burst", Into(quotas.bytes_burst)},
      {"quotas.max_calls_per_s", Into(quotas.max_calls_per_s)},
      {"quotas.calls_burst", Into(quotas.calls_burst)},
      {"publisher.heartbeat_s", Into(publisher.heartbeat_s)},
      {"publisher.history", Into(publisher.history)},
      {"publisher.max_variants", Into(publisher.max_variants)},
      {"publisher.position_tolerance_m", Into(publisher.tolerance.position_m)},
      {"publisher.rotation_tolerance_rad", Into(publisher.tolerance.rotation_rad)},
      {"publisher.position_resolution_m", Into(publisher.units.position_m)},
      {"publisher.rotation_resolution_rad", Into(publisher.units.rotation_rad)},
      {"publisher.stamp_resolution_ns", Into(publisher.units.stamp_ns)},
      {"graph.min_distance_m", Into(graph.min_distance_m)},
      {"graph.min_rotation_rad", Into(graph.min_rotation_rad)},
      {"graph.max_nodes", Into(graph.max_nodes)},
      {"graph.reduction_tolerance", Into(graph.reduction_tolerance)},
      {"graph.radius_m", Into(graph.radius_graph.radius_m)},
      {"graph.sigma", Into(graph.radius_graph.sigma)},
      {"map.robust", Into(map.robust)},
      {"map.closure_chi_square_limit", Into(map.closure_chi_square_limit)},
      {"map.sighting_chi_square_limit", Into(map.sighting_chi_square_limit)},
      {"map.consistency_chi_square_limit", Into(map.consistency_chi_square_limit)},
      {"map.min_consistent_closures", Into(map.min_consistent_closures)},
      {"map.point_alignment_tolerance_m", Into(map.point_alignment_tolerance_m)},
      {"map.degenerate_motion_share", Into(map.degenerate_motion_share)},
      {"map.min_candidate_score", Into(map.min_candidate_score)},
      {"map.scored_position_sigma_m", Into(map.scored_position_sigma_m)},
      {"map.max_iterations", Into(map.max_iterations)},
      {"map.num_threads", Into(map.num_threads)},
      {"loop_closures.enabled", Into(loops.enabled)},
      {"loop_closures.num_threads", Into(loops.num_threads)},
      {"loop_closures.gather_length_m", Into(loops.gather_length_m)},
      {"loop_closures.refine_planar_motion", Into(loops.refine_planar_motion)},
      {"loop_closures.max_views", Into(loops.max_views)},
      {"loop_closures.min_range_m", Into(loops.proposer.context.min_range_m)},
      {"loop_closures.max_range_m", Into(loops.proposer.context.max_range_m)},
      {"loop_closures.min_similarity", Into(loops.proposer.min_similarity)},
      {"loop_closures.max_candidates", Into(loops.proposer.max_candidates)},
      {"loop_closures.min_separation_m", Into(loops.proposer.min_separation_m)},
      {"loop_closures.min_loop_length_m", Into(loops.proposer.min_loop_length_m)},
      {"loop_closures.min_overlap", Into(loops.verifier.required.min_overlap)},
      {"loop_closures.max_residual_m", Into(loops.verifier.required.max_residual_m)},
      {"loop_closures.planar_min_overlap", Into(loops.verifier.planar_required.min_overlap)},
      {"loop_closures.planar_max_residual_m", Into(loops.verifier.planar_required.max_residual_m)},
      {"loop_closures.max_translation_m", Into(loops.verifier.max_translation_m)},
  };
}

// Levenshtein distance.
int EditDistance(absl::string_view a, absl::string_view b) {
  std::vector<int> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (size_t i = 0; i < a.size(); ++i) {
    int diagonal = row[0]++;
    for (size_t j = 0; j < b.size(); ++j) {
      const int replaced = diagonal + (a[i] != b[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

std::string NearestKey(const std::map<std::string, Key>& keys, const std::string& wanted) {
  return std::min_element(keys.begin(), keys.end(),
                          [&](const auto& a, const auto& b) {
                            return EditDistance(a.first, wanted) < EditDistance(b.first, wanted);
                          })
      ->first;
}

class Reader {
 public:
  Reader(const std::string& path, std::map<std::string, Key> keys)
      : path_(path), keys_(std::move(keys)) {}

  // Walks a mapping; `prefix` is "" or "section.".
  absl::Status ReadMapping(const YAML::Node& mapping, const std::string& prefix) {
    for (const auto& entry : mapping) {
      const std::string key = prefix + entry.first.Scalar();
      const bool section = entry.second.IsMap() && prefix.empty();
      if (section && keys_.count(key) == 0) {
        RETURN_IF_ERROR(ReadMapping(entry.second, key + "."));
      } else {
        RETURN_IF_ERROR(ReadScalar(entry.first, key, entry.second));
      }
    }
    return absl::OkStatus();
  }

 private:
  absl::Status ReadScalar(const YAML::Node& name, const std::string& key, const YAML::Node& value) {
    const auto known = keys_.find(key);
    if (known == keys_.end()) {
      return Error(name.Mark(), absl::StrCat("unknown key '", key, "'; did you mean '",
                                             NearestKey(keys_, key), "'?"));
    }
    if (!seen_.insert(key).second) return Error(name.Mark(), absl::StrCat(key, " is given twice"));
    if (value.IsScalar() && known->second.set(value)) return absl::OkStatus();
    return Error(value.Mark(), absl::StrCat(key, " has a value of the wrong type"));
  }

  absl::Status Error(const YAML::Mark& mark, absl::string_view what) const {
    return absl::InvalidArgumentError(absl::StrCat(path_, ":", mark.line + 1, ": ", what));
  }

  const std::string path_;
  const std::map<std::string, Key> keys_;
  std::set<std::string> seen_;
};

}  // namespace

std::map<std::string, std::string> OptionValues(ServerOptions options) {
  std::map<std::string, std::string> values;
  for (const auto& [name, key] : Keys(options)) values[name] = key.get();
  return values;
}

absl::Status ReadOptionsFile(const std::string& path, ServerOptions& options) {
  std::ifstream in(path);
  if (!in) return absl::NotFoundError(absl::StrCat(path, ": cannot be read"));
  try {
    const YAML::Node root = YAML::Load(in);
    if (root.IsNull()) return absl::OkStatus();
    if (!root.IsMap()) return absl::InvalidArgumentError(absl::StrCat(path, ":1: not a mapping"));
    return Reader(path, Keys(options)).ReadMapping(root, "");
  } catch (const YAML::Exception& error) {
    return absl::InvalidArgumentError(
        absl::StrCat(path, ":", error.mark.line + 1, ": ", error.msg));
  }
}

}  // namespace overtone
