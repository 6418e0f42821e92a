// SPDX-License-Identifier: Apache-2.0
// What to do with constraints where the robot has no estimator to give them to. Each one is spread
// over the keyframes between its ends, a little at every step, so that the path bends instead of
// jumping; what comes after moves along.
//   robot_without_optimiser [host:port]
#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <mutex>

#include "overtone/client/mapping_client.h"

using overtone::Rigid3d;

class SpreadingEstimator : public overtone::HostEstimator {
 public:
  // Called by the odometry for each keyframe, while the client may be correcting the older ones.
  void AddKeyframe(overtone::Timestamp stamp, const Rigid3d& previous_from_this) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const Rigid3d previous = poses_.empty() ? Rigid3d() : poses_.back().estimate_from_body;
    poses_.push_back({static_cast<int64_t>(poses_.size()), stamp, previous * previous_from_this});
  }

  Rigid3d newest() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return poses_.back().estimate_from_body;
  }

  std::vector<overtone::OnboardPose> Trajectory() override {
    const std::lock_guard<std::mutex> lock(mutex_);
    return poses_;
  }

  // Constraints in the order of their ends; chords, which do not overlap, then all hold. A later
  // word on the same two keyframes simply bends the path anew, and there is nothing to take back
  // for a retracted one.
  absl::Status ApplyConstraints(const overtone::ConstraintBatch& batch) override {
    std::vector<overtone::Constraint> constraints = batch.add;
    constraints.insert(constraints.end(), batch.update.begin(), batch.update.end());
    std::sort(constraints.begin(), constraints.end(), [](const auto& a, const auto& b) {
      return std::max(a.from, a.to) < std::max(b.from, b.to);
    });
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const overtone::Constraint& c : constraints) {
      if (c.from < c.to) Spread(c.from, c.to, c.from_tform_to);
      if (c.to < c.from) Spread(c.to, c.from, c.from_tform_to.Inverse());
    }
    return absl::OkStatus();
  }

 private:
  // Pose `begin` stays, pose `end` and all later ones move as one, and those between take their
  // share of that motion, a screw in the estimate's frame.
  void Spread(int64_t begin, int64_t end, const Rigid3d& begin_tform_end) {
    const Rigid3d old_end = poses_[end].estimate_from_body;
    const Rigid3d wanted = poses_[begin].estimate_from_body * begin_tform_end;
    const overtone::Vector6d xi = overtone::Log(wanted * old_end.Inverse());
    for (size_t i = begin + 1; i < poses_.size(); ++i) {
      const double share =
          std::min(1.0, static_cast<double>(i - begin) / static_cast<double>(end - begin));
      poses_[i].estimate_from_body = overtone::Exp(share * xi) * poses_[i].estimate_from_body;
    }
  }

  mutable std::mutex mutex_;
  std::vector<overtone::OnboardPose> poses_;
};

void Check(const absl::Status& status) {
  if (status.ok()) return;
  std::cerr << status << std::endl;
  std::exit(EXIT_FAILURE);
}

// The circle of example 01.
int main(int argc, char** argv) {
  constexpr int kSteps = 60;
  const Rigid3d measured_step =
      overtone::Exp((overtone::Vector6d() << 1, 0, 0, 0, 0, 6.4 * M_PI / 180).finished());

  SpreadingEstimator estimator;
  overtone::MappingClientOptions options;
  if (argc > 1) options.server = argv[1];
  options.mission = {"spreading-robot", "circle"};
  options.min_time_between_comparisons = absl::InfiniteDuration();
  options.synchronization.selection.strategy = overtone::SelectionStrategy::kUniform;
  options.synchronization.selection.n = 3;  // a few long chords: that is what spreading is for
  const auto client = overtone::MappingClient::Create(options, &estimator);
  Check(client.status());

  overtone::Submap submap;
  Rigid3d odometry;
  for (int64_t i = 0; i <= kSteps; ++i, odometry = odometry * measured_step) {
    const overtone::Timestamp stamp{i * 1'000'000'000};
    estimator.AddKeyframe(stamp, i == 0 ? Rigid3d() : measured_step);
    submap.keyframes.push_back({stamp, odometry, 1e-4 * overtone::Matrix6d::Identity()});
  }
  submap.loop_closures.push_back({{options.mission, 0},
                                  {options.mission, kSteps},
                                  Rigid3d(),
                                  1e-6 * overtone::Matrix6d::Identity()});
  Check((*client)->AddSubmap(submap));
  Check((*client)->WaitForKeyframe(kSteps, /*min_revision=*/1, absl::Seconds(10)));

  std::cout << "from the circle's end to its begin: " << estimator.newest().translation.norm()
            << " m by odometry" << std::endl;
  const auto report = (*client)->Synchronize();
  Check(report.status());
  Check(report->host_status);
  std::cout << "and " << estimator.newest().translation.norm() << " m after "
            << report->batch.add.size() << " constraints" << std::endl;
}
