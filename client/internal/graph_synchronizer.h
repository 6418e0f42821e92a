// SPDX-License-Identifier: Apache-2.0
// One comparison of the server's graph with the host's trajectory, and its consequence for the
// host.
#ifndef OVERTONE_CLIENT_INTERNAL_GRAPH_SYNCHRONIZER_H_
#define OVERTONE_CLIENT_INTERNAL_GRAPH_SYNCHRONIZER_H_

#include <cstdint>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "overtone/client/host_estimator.h"
#include "overtone/client/mapping_client.h"
#include "overtone/core/common/ids.h"
#include "overtone/core/graph/map_graph.h"
#include "overtone/core/graph/submap.h"
#include "overtone/core/synchronization/constraint_history.h"
#include "overtone/core/synchronization/correction_gate.h"
#include "overtone/core/synchronization/host_prediction.h"
#include "overtone/core/synchronization/noise_floor.h"
#include "overtone/core/synchronization/odometry_record.h"
#include "overtone/core/synchronization/selection_context.h"
#include "overtone/core/synchronization/synchronization_options.h"
#include "overtone/core/synchronization/wavelet_discrepancy.h"

namespace overtone {

// Calls the host from the calling thread. Not thread-safe, AddKeyframes apart.
class GraphSynchronizer {
 public:
  // `host` must outlive the synchronizer.
  GraphSynchronizer(MissionId mission, SynchronizationOptions options, HostEstimator* host);

  // Of the mission, as they are uploaded: by their odometry the effect of constraints is predicted.
  // Any thread.
  void AddKeyframes(int64_t first_index, const std::vector<Keyframe>& keyframes)
      ABSL_LOCKS_EXCLUDED(mutex_);

  // compare -> is anything wrong at all -> select -> reconcile with what the host already has ->
  // one batch -> predict and judge it -> commit when the host applied it. A batch that is held back
  // is judged anew with the next comparison, one that did not do what was predicted is retracted. A
  // batch that the host refuses is forgotten, so that the next comparison offers it anew. Errors of
  // TrajectoryComparator: NotFound, FailedPrecondition, InvalidArgument. Internal: the host's
  // Trajectory() threw.
  absl::StatusOr<SynchronizationReport> Synchronize(const MapGraph& graph);

 private:
  SelectionContext MakeContext(const SynchronizationReport& report,
                               const std::vector<OnboardPose>& onboard) ABSL_LOCKS_EXCLUDED(mutex_);
  bool RecordExplainsHost(const SynchronizationReport& report) const
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  const OdometryRecord& Record() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    return record_explains_host_ ? odometry_ : nothing_recorded_;
  }
  // The batch, or why there is none. True: there is nothing to correct.
  bool Select(SynchronizationReport& report, const SelectionContext& context,
              HostPrediction& prediction) ABSL_LOCKS_EXCLUDED(mutex_);
  // Fills how the batch moves the newest keyframe.
  void SetBlend(SynchronizationReport& report, HostPrediction prediction) const
      ABSL_LOCKS_EXCLUDED(mutex_);
  // Fills what the report says of the prediction.
  HostPrediction Judge(SynchronizationReport& report, const SelectionContext& context)
      ABSL_LOCKS_EXCLUDED(mutex_);

  const MissionId mission_;
  const SynchronizationOptions options_;
  HostEstimator* const host_;
  TrajectoryComparator comparator_;
  NoiseFloor noise_floor_;
  ConstraintHistory history_;
  CorrectionGate gate_;
  const OdometryRecord nothing_recorded_;
  bool record_explains_host_ = true;  // at the comparison under way
  mutable absl::Mutex mutex_;
  OdometryRecord odometry_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_GRAPH_SYNCHRONIZER_H_
