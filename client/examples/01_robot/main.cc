// SPDX-License-Identifier: Apache-2.0
// A complete robot. It drives a circle with an odometry that turns 0.4 degrees too far every metre,
// uploads what it drove, recognises the place where it began, and lets the server's constraints
// correct its trajectory.
//   robot [host:port [ca.crt robot-robot.crt robot-robot.key]]
#include <cstdlib>
#include <iostream>

#include "overtone/client/mapping_client.h"

using overtone::Rigid3d;

// The smallest estimator there is: a constraint takes its later keyframe, and all that follow, to
// where it says.
struct Estimator : overtone::HostEstimator {
  std::vector<overtone::OnboardPose> poses;

  std::vector<overtone::OnboardPose> Trajectory() override { return poses; }

  absl::Status ApplyConstraints(const overtone::ConstraintBatch& batch) override {
    for (const overtone::Constraint& c : batch.add) {
      const Rigid3d wanted = poses[c.from].estimate_from_body * c.from_tform_to;
      const Rigid3d correction = wanted * poses[c.to].estimate_from_body.Inverse();
      for (size_t i = c.to; i < poses.size(); ++i)
        poses[i].estimate_from_body = correction * poses[i].estimate_from_body;
    }
    return absl::OkStatus();
  }
};

void Check(const absl::Status& status) {
  if (status.ok()) return;
  std::cerr << status << std::endl;
  std::exit(EXIT_FAILURE);
}

int main(int argc, char** argv) {
  constexpr int kSteps = 60;  // of one metre and 6 degrees to the left: a circle
  const Rigid3d measured_step =
      overtone::Exp((overtone::Vector6d() << 1, 0, 0, 0, 0, 6.4 * M_PI / 180).finished());

  Estimator estimator;
  overtone::MappingClientOptions options;
  if (argc > 1) options.server = argv[1];
  if (argc > 4) {  // what `overtone certs --robot robot` has written
    options.tls.ca_file = argv[2];
    options.tls.certificate_file = argv[3];
    options.tls.key_file = argv[4];
  }
  options.mission = {"robot", "circle"};
  options.min_time_between_comparisons = absl::InfiniteDuration();  // only when we ask for it
  options.synchronization.selection.strategy =
      overtone::SelectionStrategy::kUniform;  // chords from pose to later pose
  const auto client = overtone::MappingClient::Create(options, &estimator);
  Check(client.status());

  overtone::Submap submap;
  Rigid3d odometry;
  for (int64_t i = 0; i <= kSteps; ++i, odometry = odometry * measured_step) {
    const overtone::Timestamp stamp{i * 1'000'000'000};
    estimator.poses.push_back({i, stamp, odometry});
    submap.keyframes.push_back({stamp, odometry, 1e-4 * overtone::Matrix6d::Identity()});
    if (i == kSteps) {  // back where it began
      submap.loop_closures.push_back({{options.mission, 0},
                                      {options.mission, i},
                                      Rigid3d(),
                                      1e-6 * overtone::Matrix6d::Identity()});
    }
    if (submap.keyframes.size() == 10 || i == kSteps) {
      Check((*client)->AddSubmap(submap));
      submap = {submap.sequence + 1, i + 1};
    }
  }
  Check((*client)->WaitUntilAcknowledged(absl::Seconds(10)));
  Check((*client)->WaitForKeyframe(kSteps, /*min_revision=*/1, absl::Seconds(10)));

  const auto gap_m = [&] { return estimator.poses.back().estimate_from_body.translation.norm(); };
  std::cout << "from the circle's end to its begin: " << gap_m() << " m by odometry" << std::endl;
  const auto report = (*client)->Synchronize();
  Check(report.status());
  Check(report->host_status);
  std::cout << "and " << gap_m() << " m after " << report->batch.add.size() << " constraints"
            << std::endl;
}
