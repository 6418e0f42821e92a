// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/metrics/metric_set.h"

namespace overtone {
namespace {

using prometheus::MetricType;

constexpr MetricType kCounter = MetricType::Counter;
constexpr MetricType kGauge = MetricType::Gauge;
constexpr MetricType kHistogram = MetricType::Histogram;

std::vector<MetricDescription> OfTheServer() {
  return {
      {"overtone_build_info", kGauge, {"version"}, "Always 1"},
      {"overtone_maps", kGauge, {}, "Maps that are served"},
      {"overtone_data_directory_free_bytes",
       kGauge,
       {},
       "Room on the disk of data_dir; none in memory"},
      {"overtone_data_directory_size_bytes",
       kGauge,
       {},
       "Size of the disk of data_dir; none in memory"},
      {"overtone_rpc_started_total", kCounter, {"method"}, "Calls that came"},
      {"overtone_rpc_in_progress", kGauge, {"method"}, "Calls that have not ended: open streams"},
      {"overtone_rpc_handled_total", kCounter, {"method", "code"}, "Calls that ended"},
      {"overtone_rpc_duration_seconds",
       kHistogram,
       {"method", "code"},
       "From a call's beginning to its status"},
      {"overtone_quota_refusals_total",
       kCounter,
       {"kind"},
       "Calls and streams refused, and messages after which an upload was slowed (uploads)"},
      {"process_cpu_seconds_total", kCounter, {}, "User and system time"},
      {"process_resident_memory_bytes", kGauge, {}, "Resident memory"},
      {"process_virtual_memory_bytes", kGauge, {}, "Virtual memory"},
      {"process_open_fds", kGauge, {}, "Open file descriptors"},
      {"process_max_fds", kGauge, {}, "Most file descriptors that may be open"},
      {"process_start_time_seconds", kGauge, {}, "Since 1970"},
  };
}

std::vector<MetricDescription> OfMaps() {
  return {
      {"overtone_revision", kGauge, {"map"}, "Newest revision"},
      {"overtone_revision_age_seconds", kGauge, {"map"}, "Since it was published"},
      {"overtone_optimisation_seconds", kGauge, {"map"}, "What the solver took for it"},
      {"overtone_missions", kGauge, {"map", "anchored"}, "Missions in it"},
      {"overtone_components", kGauge, {"map"}, "Groups of missions that nothing ties together"},
      {"overtone_keyframes", kGauge, {"map"}, "Keyframes in it"},
      {"overtone_loop_closures", kGauge, {"map", "verdict"}, "Candidates in it"},
      {"overtone_front_end_backlog",
       kGauge,
       {"map"},
       "Clouds, candidates and submaps that are not in a revision yet"},
      {"overtone_queue_depth",
       kGauge,
       {"map", "queue"},
       "What waits for the disk (store), for the search for closures (detector) and for the "
       "optimiser (pipeline)"},
      {"overtone_cycle_stage_seconds", kHistogram, {"map", "stage"}, "Parts of mapping cycles"},
      {"overtone_store_commit_seconds", kHistogram, {"map"}, "From a batch to its fsync"},
      {"overtone_store_commit_entries", kHistogram, {"map"}, "Operations that shared an fsync"},
      {"overtone_store_errors_total", kCounter, {"map"}, "Batches of which nothing was stored"},
      {"overtone_store_bytes", kGauge, {"map"}, "All that its folder holds; 0 in memory"},
      {"overtone_clouds",
       kGauge,
       {"map", "state"},
       "Clouds that are stored, and those that are missing until their robot sends them"},
      {"overtone_comparison_seconds",
       kHistogram,
       {"map"},
       "Comparisons with the onboard estimate, as robots report them"},
  };
}

std::vector<MetricDescription> OfRobots() {
  const std::vector<std::string> robot = {"map", "robot"};
  return {
      {"overtone_robot_bytes_total",
       kCounter,
       {"map", "robot", "direction"},
       "Serialised messages received of its uploads, and sent to its uploads and watches"},
      {"overtone_robot_uploading", kGauge, robot, "1: an upload of it is open"},
      {"overtone_robot_watching", kGauge, robot, "1: a watch of it is open"},
      {"overtone_robot_revision_sent", kGauge, robot, "Newest revision that went out to it"},
      {"overtone_robot_last_upload_timestamp_seconds", kGauge, robot,
       "When its last submap was stored, since 1970"},
      {"overtone_robot_report_age_seconds", kGauge, robot, "Since its last status report"},
      {"overtone_robot_outbox_submaps", kGauge, robot, "Not acknowledged yet, as reported"},
      {"overtone_robot_outbox_clouds", kGauge, robot, "Not acknowledged yet, as reported"},
      {"overtone_robot_outbox_bytes", kGauge, robot, "Not acknowledged yet, as reported"},
      {"overtone_robot_reconnects_total", kCounter, robot, "Since the client started, as reported"},
      {"overtone_robot_clouds_dropped_total", kCounter, robot,
       "Clouds that will never reach the map, as reported"},
      {"overtone_robot_clock_offset_seconds", kGauge, robot,
       "Its clock minus the server's, as reported"},
      {"overtone_robot_clock_offset_uncertainty_seconds", kGauge, robot,
       "What that is certainly within, as reported"},
      {"overtone_robot_constraints_total",
       kCounter,
       {"map", "robot", "kind"},
       "New constraints of the comparisons that it reported"},
  };
}

}  // namespace

const std::vector<MetricDescription>& MetricDescriptions() {
  static const auto* const all = [] {
    auto* descriptions = new std::vector<MetricDescription>(OfTheServer());
    for (const auto& part : {OfMaps(), OfRobots()}) {
      descriptions->insert(descriptions->end(), part.begin(), part.end());
    }
    return descriptions;
  }();
  return *all;
}

}  // namespace overtone
