// SPDX-License-Identifier: Apache-2.0
// One comparison of the server's graph with the host's trajectory, and its consequence for the
// host.
#ifndef OVERTONE_CLIENT_INTERNAL_GRAPH_SYNCHRONIZER_H_
#define OVERTONE_CLIENT_INTERNAL_GRAPH_SYNCHRONIZER_H_

#include "absl/status/statusor.h"
#include "overtone/client/host_estimator.h"
#include "overtone/client/mapping_client.h"
#include "overtone/core/common/ids.h"
#include "overtone/core/graph/map_graph.h"
#include "overtone/core/synchronization/constraint_history.h"
#include "overtone/core/synchronization/synchronization_options.h"

namespace overtone {

// Calls the host from the calling thread. Not thread-safe.
class GraphSynchronizer {
 public:
  // `host` must outlive the synchronizer.
  GraphSynchronizer(MissionId mission, SynchronizationOptions options, HostEstimator* host);

  // compare -> select -> reconcile with what the host already has -> one batch -> commit when the
  // host applied it. A batch that the host refuses is forgotten, so that the next comparison offers
  // it anew. Errors of CompareTrajectories: NotFound, FailedPrecondition, InvalidArgument.
  // Internal: the host's Trajectory() threw.
  absl::StatusOr<SynchronizationReport> Synchronize(const MapGraph& graph);

 private:
  const MissionId mission_;
  const SynchronizationOptions options_;
  HostEstimator* const host_;
  ConstraintHistory history_;
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_GRAPH_SYNCHRONIZER_H_
