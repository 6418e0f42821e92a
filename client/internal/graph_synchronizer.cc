// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/graph_synchronizer.h"

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "overtone/client/internal/exception_guard.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/synchronization/aligned_rmse.h"
#include "overtone/core/synchronization/constraint_selection.h"
#include "overtone/core/synchronization/position_noise.h"
#include "overtone/core/synchronization/wavelet_discrepancy.h"

namespace overtone {
namespace {

// A distance from the origin does not see drift across it: positions must agree, too.
bool IsNoise(const SynchronizationReport& report) {
  constexpr double kLargestShare = 2;
  return !AnyExceeds(report.bands) &&
         report.rmse_before_m <= kLargestShare * PositionNoise(report.comparison);
}

}  // namespace

GraphSynchronizer::GraphSynchronizer(MissionId mission, SynchronizationOptions options,
                                     HostEstimator* host)
    : mission_(std::move(mission)),
      options_(std::move(options)),
      host_(host),
      comparator_(options_),
      noise_floor_(options_),
      gate_(options_) {}

void GraphSynchronizer::AddKeyframes(int64_t first_index, const std::vector<Keyframe>& keyframes) {
  absl::MutexLock lock(&mutex_);
  odometry_.AddKeyframes(first_index, keyframes);
}

// A host may know more than its odometry and our constraints: loops of its own, a map. Then what it
// estimates now is all that can be built on.
bool GraphSynchronizer::RecordExplainsHost(const SynchronizationReport& report) const {
  constexpr double kUnexplainedShare = 0.2;  // of how far the host is from the server
  const auto expected =
      PredictHost(report.comparison, odometry_, options_.odometry, history_.Active());
  if (!expected.ok()) return false;
  return AlignedRmse(expected->poses, expected->Of(report.comparison.onboard)) <=
         std::max(options_.selection.tolerance_m, kUnexplainedShare * report.rmse_before_m);
}

SelectionContext GraphSynchronizer::MakeContext(const SynchronizationReport& report,
                                                const std::vector<OnboardPose>& onboard) {
  absl::MutexLock lock(&mutex_);
  odometry_.Observe(onboard, options_.odometry);
  record_explains_host_ = RecordExplainsHost(report);
  OdometryChain chain = Record().Along(RowsOf(report.comparison), options_.odometry);
  return {std::move(chain.poses), std::move(chain.step_covariance), history_.Active()};
}

HostPrediction GraphSynchronizer::Judge(SynchronizationReport& report,
                                        const SelectionContext& context) {
  const std::vector<Constraint> in_force = history_.ActiveAfter(report.batch);
  absl::MutexLock lock(&mutex_);
  absl::StatusOr<HostPrediction> prediction =
      PredictHost(report.comparison, Record(), options_.odometry, in_force);
  if (!prediction.ok()) {
    report.held_back = absl::StrCat("no prediction: ", prediction.status().message());
    return HostPrediction();
  }
  report.predicted_rmse_m = prediction->rmse_m;
  report.held_back = gate_.Judge(report.comparison, context, report.batch, *prediction);
  return *std::move(prediction);
}

bool GraphSynchronizer::Select(SynchronizationReport& report, const SelectionContext& context,
                               HostPrediction& prediction) {
  const SelectionStrategy strategy = options_.selection.strategy;
  const Unproposed unproposed = ProposesAll(strategy) ? Unproposed::kRetract : Unproposed::kKeep;
  report.batch = history_.Reconcile(SelectConstraints(report.comparison, options_, context),
                                    report.comparison, options_.constraints, unproposed);
  if (report.batch.empty()) return strategy != SelectionStrategy::kNone;
  prediction = Judge(report, context);
  if (report.held_back.empty()) return false;
  report.batch = ConstraintBatch();
  return !prediction.poses.empty() && !gate_.Gains(report.comparison, prediction);
}

// What lies behind the last row moves with it: nothing but odometry ties it there.
void GraphSynchronizer::SetBlend(SynchronizationReport& report, HostPrediction prediction) const {
  const TrajectoryComparison& comparison = report.comparison;
  if (prediction.poses.empty()) {  // a batch that only takes back
    absl::MutexLock lock(&mutex_);
    absl::StatusOr<HostPrediction> predicted =
        PredictHost(comparison, Record(), options_.odometry, history_.ActiveAfter(report.batch));
    if (!predicted.ok()) return;
    prediction = *std::move(predicted);
  }
  Rigid3d before = comparison.onboard.back();
  const auto& unmatched = comparison.unmatched;
  if (!unmatched.empty() && unmatched.back().index > comparison.keyframe_index.back()) {
    before = unmatched.back().estimate_from_body;
  }
  const Rigid3d after = prediction.poses.back() * (comparison.onboard.back().Inverse() * before);
  report.batch.newest_move_m = (after.translation - before.translation).norm();
  report.batch.newest_turn_rad = LogSO3(before.rotation.conjugate() * after.rotation).norm();
  report.batch.blend_s = BlendSeconds(before, after, options_.blend);
}

absl::StatusOr<SynchronizationReport> GraphSynchronizer::Synchronize(const MapGraph& graph) {
  ASSIGN_OR_RETURN(std::vector<OnboardPose> onboard,
                   GuardExceptions("HostEstimator::Trajectory",
                                   [&]() -> absl::StatusOr<std::vector<OnboardPose>> {
                                     return host_->Trajectory();
                                   }));

  const auto start = std::chrono::steady_clock::now();
  ASSIGN_OR_RETURN(onboard, CheckedTrajectory(std::move(onboard)));
  SynchronizationReport report;
  ASSIGN_OR_RETURN(report.comparison, comparator_.Compare(graph, mission_, onboard));
  report.bands = noise_floor_.Judge(report.comparison);
  report.rmse_before_m = report.predicted_rmse_m =
      AlignedRmse(report.comparison.onboard, report.comparison.server);
  const SelectionContext context = MakeContext(report, onboard);
  report.onset = FindDriftOnset(report.comparison, options_, context);
  HostPrediction prediction;
  const std::vector<std::string> refuted = gate_.Refuted(report.comparison);
  if (!refuted.empty()) {
    report.batch = history_.Retraction(refuted, report.comparison);
    report.held_back = "the last batch did not do what was predicted, and is taken back";
  } else if (IsNoise(report) || Select(report, context, prediction)) {
    noise_floor_.Learn(report.comparison);
  }
  report.compare_ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();

  if (report.batch.empty()) return report;
  SetBlend(report, prediction);
  report.host_status = GuardExceptions("HostEstimator::ApplyConstraints",
                                       [&] { return host_->ApplyConstraints(report.batch); });
  if (!report.host_status.ok()) return report;
  history_.Commit(report.batch);
  gate_.Applied(report.comparison, report.batch, prediction);
  return report;
}

}  // namespace overtone
