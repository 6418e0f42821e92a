// SPDX-License-Identifier: Apache-2.0
// The robot's end of Overtone: submaps go up, constraints come back. No call blocks on the network,
// none throws, and a lost server only means that no new batches come.
#ifndef OVERTONE_CLIENT_MAPPING_CLIENT_H_
#define OVERTONE_CLIENT_MAPPING_CLIENT_H_

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "overtone/client/host_estimator.h"
#include "overtone/client/mapping_client_options.h"
#include "overtone/core/graph/map_graph.h"
#include "overtone/core/graph/submap.h"
#include "overtone/core/synchronization/drift_onset.h"
#include "overtone/core/synchronization/noise_floor.h"
#include "overtone/core/synchronization/trajectory_comparison.h"

namespace overtone {

// Counts of this client since it was created.
struct MappingClientStats {
  LinkState link_state = LinkState::kConnecting;
  int64_t submaps_acknowledged = 0;
  int64_t submaps_waiting = 0;
  int64_t blobs_waiting = 0;  // encoded clouds
  int64_t bytes_waiting = 0;
  int64_t bytes_sent = 0;  // serialised messages, without HTTP/2 framing
  int64_t bytes_received = 0;
  int64_t report_bytes_sent = 0;  // of bytes_sent: MappingClientOptions::report_status
  int64_t reconnects = 0;
  int64_t clouds_dropped = 0;  // HostEstimator::OnCloudsDropped
  // Sequences: with all before it, what survives the end of the process, and a loss of power. -1:
  // none, or no outbox_dir.
  int64_t persisted_through = -1;
  int64_t synced_through = -1;
  bool outbox_on_disk = false;   // false: no outbox_dir, or the disk fails and it goes on in memory
  int64_t missions_waiting = 0;  // earlier ones, of which something is left to go up
  uint64_t revision = 0;         // of the newest graph
  int64_t comparisons = 0;
  // The robot's clock minus the server's, seconds, and what it is certainly within. NaN: not known.
  double clock_offset_s = std::numeric_limits<double>::quiet_NaN();
  double clock_offset_uncertainty_s = std::numeric_limits<double>::quiet_NaN();
};

// What one comparison did, for logs and plots.
struct SynchronizationReport {
  TrajectoryComparison comparison;  // nodes, signals, discrepancy per node and band
  ConstraintBatch batch;            // what the host was asked to apply; empty: agreement
  absl::Status host_status;         // the host's answer
  double compare_ms = 0;            // graph, filter, selection; without the host's own work
  // RMSE of the host's positions to the server's after rigid alignment, metres: now, and as
  // predicted with the batch, or what would have been one, applied.
  double rmse_before_m = 0;
  double predicted_rmse_m = 0;
  // By band: whether anything is wrong. Where no band exceeds its noise, and positions agree up to
  // theirs (position_noise.h), no constraint was looked for.
  BandLevels bands;
  // Where odometry begins to be off in a way that its noise does not explain, and at which scale.
  std::optional<DriftOnset> onset;
  // Why there is no batch though constraints were selected; empty: no reason.
  std::string held_back;
};

// The next submap of the mission.
struct SubmapPosition {
  int64_t sequence = 0;
  int64_t first_index = 0;
};

// Thread-safe. Owns six threads (submaps into the outbox, submaps up, loop closures up, graphs
// down, status reports, and the one that calls the host), while something of earlier missions is
// left three more, beside gRPC's own. The destructor stops them within a second, or when the host
// returns from the call it is in; what was handed over is then in outbox_dir, or lost if there is
// none.
class MappingClient {
 public:
  // `host` must outlive the client. InvalidArgument naming the option. Does not wait for the
  // server.
  static absl::StatusOr<std::unique_ptr<MappingClient>> Create(MappingClientOptions options,
                                                               HostEstimator* host);
  virtual ~MappingClient() = default;

  // What AddSubmap expects next: the first submap, or where the mission goes on after a restart
  // (outbox_dir) or after OnSubmapRejected. What was handed over before a restart and had not
  // persisted is wanted anew.
  virtual SubmapPosition NextSubmap() const = 0;

  // Hands over the next submap: sequence and first_index follow the previous one's. Checks it and
  // returns; its clouds are encoded and written to disk by the client's own thread, and must not
  // change any more. Once WaitUntilPersisted has returned, or `persisted_through` is that far, it
  // survives. InvalidArgument naming the field; OutOfRange: not the next one; ResourceExhausted:
  // outbox full, try again. A full outbox drops the clouds of the oldest submaps first, and so
  // does one that more than 64 MiB of clouds not encoded yet wait for (OnCloudsDropped); keyframes
  // never.
  virtual absl::Status AddSubmap(const Submap& submap) = 0;

  // Closures found between submaps, or between this robot and another. Same rules.
  virtual absl::Status AddLoopClosures(const std::vector<LoopClosure>& closures) = 0;

  // Waits until everything handed over so far is encoded and, with outbox_dir, on disk: it survives
  // the end of the process from then on (not a loss of power: MappingClientStats::synced_through).
  // DeadlineExceeded otherwise.
  virtual absl::Status WaitUntilPersisted(absl::Duration timeout) = 0;

  // Waits until everything handed over of this mission, clouds too, is acknowledged.
  // DeadlineExceeded otherwise; the reason if the server refused something for good since the last
  // call (HostEstimator::OnSubmapRejected tells what).
  virtual absl::Status WaitUntilAcknowledged(absl::Duration timeout) = 0;

  // Waits for a graph that holds keyframe `index` of this mission (a server that has mapped it) and
  // whose revision is at least `min_revision`. DeadlineExceeded otherwise.
  virtual absl::Status WaitForKeyframe(int64_t index, uint64_t min_revision,
                                       absl::Duration timeout) = 0;

  // The newest graph; null before the first.
  virtual std::shared_ptr<const MapGraph> Graph() const = 0;

  // Compares the newest graph with the host's trajectory now, on the client's thread, and waits for
  // the result. FailedPrecondition: no graph yet, fewer than three nodes in common, or called from
  // inside one of the host's callbacks. NotFound: the server has not mapped this mission yet.
  virtual absl::StatusOr<SynchronizationReport> Synchronize() = 0;

  // As of now; never waits.
  virtual MappingClientStats Stats() const = 0;
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_MAPPING_CLIENT_H_
