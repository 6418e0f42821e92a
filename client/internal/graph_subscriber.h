// SPDX-License-Identifier: Apache-2.0
// Follows the map's revisions and the state of the link.
#ifndef OVERTONE_CLIENT_INTERNAL_GRAPH_SUBSCRIBER_H_
#define OVERTONE_CLIENT_INTERNAL_GRAPH_SUBSCRIBER_H_

#include <chrono>
#include <functional>
#include <memory>
#include <thread>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "overtone/client/host_estimator.h"
#include "overtone/client/internal/backoff.h"
#include "overtone/client/internal/client_stream.h"
#include "overtone/client/internal/logger.h"
#include "overtone/client/internal/traffic_counters.h"
#include "overtone/core/graph/map_graph.h"
#include "overtone/v1/mapping_service.grpc.pb.h"

namespace overtone {

// Owns one thread. Watches the map, resumes after the newest revision it holds when the stream
// breaks, applies deltas to it, and asks for a whole graph when one does not fit. A silent stream
// is given up after `stale_after`.
class GraphSubscriber {
 public:
  // All are called from the subscriber's thread. Every graph is newer than the one before, or of
  // another epoch.
  struct Listener {
    std::function<void(std::shared_ptr<const MapGraph>)> on_graph;
    std::function<void(LinkState)>
        on_link_state;  // changes only; the first state, kConnecting, is not told
    std::function<void()> on_heard = [] {};  // any frame
  };

  // `request` names the map and the options. All pointers must outlive the subscriber.
  GraphSubscriber(v1::MappingService::Stub* stub, v1::WatchGraphRequest request, Backoff backoff,
                  absl::Duration stale_after, TrafficCounters* counters, Logger logger,
                  Listener listener);
  ~GraphSubscriber();  // cancels the stream; does not wait for the network

 private:
  // A robot's wall clock jumps when it finds the time of day; the link must not look stale for
  // that.
  using Clock = std::chrono::steady_clock;
  using WatchStream =
      ClientStream<grpc::ClientReadReactor<v1::WatchGraphResponse>, v1::WatchGraphResponse>;

  void Run();
  void OnInterrupted(const absl::Status& status, absl::Duration delay);
  absl::Status RunStream();
  absl::Status HandleFrames(WatchStream& stream);
  absl::Status Handle(const v1::WatchGraphResponse& frame);
  absl::Status HandleSnapshot(const v1::Graph& snapshot);
  absl::Status HandleDelta(const v1::GraphDelta& delta);
  void Hold(MapGraph graph);
  void SetLinkState(LinkState state);
  // Waits for `condition` on mutex_ until `deadline`, and tells the listener what becomes of the
  // link meanwhile. True: it holds.
  Clock::time_point TellOverdue(Clock::time_point now);
  bool Await(const absl::Condition& condition, Clock::time_point deadline);

  v1::MappingService::Stub* const stub_;
  v1::WatchGraphRequest request_;
  Backoff backoff_;
  QuietRestart quiet_restart_;
  const Clock::duration stale_after_;
  TrafficCounters* const counters_;
  const Logger logger_;
  const Listener listener_;

  // The thread's own.
  std::shared_ptr<const MapGraph> graph_;  // the newest; deltas apply to it
  bool resumable_ = false;                 // the server may go on from graph_
  LinkState link_state_ = LinkState::kConnecting;
  Clock::time_point last_heard_ = Clock::now();
  bool heard_before_ = false;
  bool heard_on_this_stream_ = false;
  // Begun anew quietly: when the host is told after all; max: it is not so.
  Clock::time_point connecting_at_ = Clock::time_point::max();

  absl::Mutex mutex_;
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
  std::thread thread_;  // last: it uses everything above
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_GRAPH_SUBSCRIBER_H_
