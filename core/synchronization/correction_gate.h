// SPDX-License-Identifier: Apache-2.0
// Do no harm: which batches go out, and whether they did what was predicted.
#ifndef OVERTONE_CORE_SYNCHRONIZATION_CORRECTION_GATE_H_
#define OVERTONE_CORE_SYNCHRONIZATION_CORRECTION_GATE_H_

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "overtone/core/synchronization/constraint.h"
#include "overtone/core/synchronization/host_prediction.h"
#include "overtone/core/synchronization/selection_context.h"
#include "overtone/core/synchronization/synchronization_options.h"
#include "overtone/core/synchronization/trajectory_comparison.h"

namespace overtone {

// For one mission. Not thread-safe.
class CorrectionGate {
 public:
  explicit CorrectionGate(SynchronizationOptions options) : options_(std::move(options)) {}

  // Why the batch is held back, for people; empty: it may go out. Looked at are the gain, the size
  // of the correction and how the batch's constraints agree with the context's odometry
  // (GateOptions). A batch that only retracts always may.
  std::string Judge(const TrajectoryComparison& comparison, const SelectionContext& context,
                    const ConstraintBatch& batch, const HostPrediction& prediction);

  // Whether the host is predicted to come nearer to the server's estimate by more than noise.
  bool Gains(const TrajectoryComparison& comparison, const HostPrediction& prediction) const;

  // The host applied it.
  void Applied(const TrajectoryComparison& comparison, const ConstraintBatch& batch,
               const HostPrediction& prediction);

  // Called with the next comparisons: ids of the last batch to take back, when twice running less
  // than half of the predicted gain has come of it (twice: a host may optimise in its own time).
  // Then the next comparisons are held back, one more after every such failure.
  std::vector<std::string> Refuted(const TrajectoryComparison& comparison);

 private:
  // What the last batch should have led to.
  struct Promise {
    std::map<int64_t, Rigid3d> server;  // map_from_body by keyframe index, as of then
    std::vector<std::string> ids;       // added and updated
    double rmse_before_m = 0;
    double predicted_rmse_m = 0;
    int misses = 0;
    bool open = false;
  };

  std::string JudgeOdometry(const TrajectoryComparison& comparison, const SelectionContext& context,
                            const ConstraintBatch& batch);

  const SynchronizationOptions options_;
  Promise promise_;
  int failures_ = 0;
  int comparisons_to_wait_ = 0;
  int suspicious_revisions_ = 0;  // one after the other
  uint64_t last_suspicious_ = 0;  // revision
};

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_CORRECTION_GATE_H_
