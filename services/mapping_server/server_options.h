// SPDX-License-Identifier: Apache-2.0
// Everything that can be set about the server: default, unit and reason. configs/default.yaml lists
// the same keys.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SERVER_OPTIONS_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SERVER_OPTIONS_H_

#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "overtone/core/mapping/graph_monitor.h"
#include "overtone/core/mapping/multi_robot_map.h"
#include "overtone/proto/conversion/graph_columns.h"
#include "overtone/proto/conversion/published_graph.h"
#include "overtone/services/mapping_server/loop_detector.h"
#include "overtone/services/mapping_server/quota/quota_options.h"
#include "overtone/services/mapping_server/security/security_options.h"

namespace overtone {

// What one peer or all of them may take. Beyond a limit: RESOURCE_EXHAUSTED.
struct ServerLimits {
  // What the server sends; gRPC's own default for clients. It takes requests of up to 1 MiB and
  // 64 KiB (limits.h).
  int64_t max_message_bytes = 4 << 20;
  // Sent but not acknowledged, for each upload stream: a few large submaps hide the round trip.
  int64_t upload_window_bytes = 4 << 20;
  int max_maps = 64;
  int max_missions_per_map = 1000;
  int64_t max_keyframes_per_mission = 1'000'000;
  int64_t max_loop_closures_per_map = 1'000'000;
  // 0: no limit. Each submap costs about 0.1 kB of memory and a row; at one in ten seconds these
  // are 11 days of driving. Keyframes are what the optimiser and every reader work on.
  int64_t max_submaps_per_map = 100'000;
  int64_t max_keyframes_per_map = 1'000'000;
  // One encoded cloud, and all that a map keeps: at 10 kB a keyframe the latter is 100,000 of them.
  int64_t max_blob_bytes = 16 << 20;
  int64_t max_stored_blob_bytes = 1 << 30;
  // 0: no limit. For clouds that are so small that the bytes say nothing.
  int64_t max_blobs_per_map = 1'000'000;
  // A backup that is to be restored.
  int64_t max_restore_bytes = int64_t{4} << 30;
  int max_watchers_per_map = 1000;
  // Streams on one connection.
  int max_concurrent_streams = 1000;
  // Seconds after which a connection says GOAWAY (10 % sooner or later, so that not all come back
  // at once) and a stream ends itself; 0: never. Load is balanced anew then, and what has changed
  // about names and certificates is noticed. Streams end within it again as long, and what is left
  // is cut 10 s later.
  double max_connection_age_s = 3600;

  absl::Status Validate() const;
};

struct PublisherOptions {
  // Silence on a stream before a heartbeat; a third of the client's stale_after.
  double heartbeat_s = 5.0;
  // Revisions kept for deltas: a reader that falls further behind gets a snapshot.
  int history = 8;
  // Graphs of graph.max_nodes nodes kept ready for what readers ask for: node limits, robots,
  // edges. Smaller ones count by their nodes; in a large map two nodes for each keyframe are kept,
  // so that every robot can be sent its own.
  int max_variants = 16;
  PublicationTolerance tolerance;
  ColumnUnits units;

  absl::Status Validate() const;
};

struct ServerOptions {
  // host:port; port 0 takes a free one. Only this host by default: others need certificates.
  std::string listen = "localhost:7077";
  // Where maps are kept over restarts; ":memory:" keeps them as long as the process.
  std::string data_dir = "overtone-data";
  // host:port of http://.../metrics for Prometheus; empty: none.
  std::string metrics_listen;
  // trace, debug, info, warning, error, critical, off. To stderr.
  std::string log_level = "info";
  // text for people, json (one object a line) for what collects logs.
  std::string log_format = "text";
  // The schema, for grpcurl and buf curl. Off where the API should not explain itself.
  bool reflection = true;
  // A dead peer is noticed after this and as long again; it also keeps NATs from forgetting us.
  double keepalive_s = 10.0;
  // What streams and calls get to finish in on SIGTERM, whatever their peers do. Closing the maps
  // comes after it.
  double shutdown_s = 5.0;

  SecurityOptions security;
  ServerLimits limits;
  QuotaOptions quotas;
  PublisherOptions publisher;
  GraphMonitorOptions graph;
  MultiRobotMapOptions map;
  LoopDetectorOptions loop_closures;

  // InvalidArgument naming the option as in the configuration file.
  absl::Status Validate() const;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SERVER_OPTIONS_H_
