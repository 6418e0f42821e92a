// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/graph_synchronizer.h"

#include <chrono>
#include <utility>
#include <vector>

#include "overtone/client/internal/exception_guard.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/synchronization/constraint_selection.h"
#include "overtone/core/synchronization/wavelet_discrepancy.h"

namespace overtone {

GraphSynchronizer::GraphSynchronizer(MissionId mission, SynchronizationOptions options,
                                     HostEstimator* host)
    : mission_(std::move(mission)), options_(std::move(options)), host_(host) {}

absl::StatusOr<SynchronizationReport> GraphSynchronizer::Synchronize(const MapGraph& graph) {
  ASSIGN_OR_RETURN(const std::vector<OnboardPose> onboard,
                   GuardExceptions("HostEstimator::Trajectory",
                                   [&]() -> absl::StatusOr<std::vector<OnboardPose>> {
                                     return host_->Trajectory();
                                   }));

  const auto start = std::chrono::steady_clock::now();
  SynchronizationReport report;
  ASSIGN_OR_RETURN(report.comparison, CompareTrajectories(graph, mission_, onboard, options_));
  const std::vector<Constraint> proposals = SelectConstraints(report.comparison, options_);
  report.batch = history_.Reconcile(proposals, report.comparison, options_.constraints);
  report.compare_ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();

  if (report.batch.empty()) return report;
  report.host_status = GuardExceptions("HostEstimator::ApplyConstraints",
                                       [&] { return host_->ApplyConstraints(report.batch); });
  if (report.host_status.ok()) history_.Commit(report.batch);
  return report;
}

}  // namespace overtone
