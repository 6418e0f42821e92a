// SPDX-License-Identifier: Apache-2.0
// A robot that agrees with the server up to the noise of both is left alone; one that drifts is
// not.
#include <algorithm>
#include <iostream>
#include <memory>
#include <random>

#include "gtest/gtest.h"
#include "overtone/client/internal/graph_synchronizer.h"
#include "overtone/tests/support/drifting_mission.h"
#include "overtone/tests/support/fake_host.h"

namespace overtone {
namespace {

const MissionId kMission = {"robot", "run"};
constexpr int kNumNodes = 300;
constexpr int kRevisions = 10;

// All revisions' poses have noise of their own on both sides; the mission grows with each.
class Robot {
 public:
  Robot(int seed, double sigma_m, bool noise_floor)
      : random_(seed), sigma_m_(sigma_m), mission_(MakeDriftingMission(kNumNodes, seed)) {
    SynchronizationOptions options;
    options.noise_floor.enabled = noise_floor;
    synchronizer_ = std::make_unique<GraphSynchronizer>(kMission, options, &host_);
    absl::MutexLock lock(&host_.mutex);
    for (int i = 0; i < kNumNodes; ++i) {
      host_.trajectory.push_back({i, {i}, mission_.truth[i] * Noise()});
    }
  }

  // From `row` on the robot's estimate is off upwards, more and more up to `drift_m`: across the
  // distance from the origin, which the bands compare by default.
  void Drift(int row, double drift_m) {
    absl::MutexLock lock(&host_.mutex);
    for (int i = row; i < kNumNodes; ++i) {
      host_.trajectory[i].estimate_from_body.translation.z() +=
          drift_m * std::min(1.0, (i - row) / 30.0);
    }
  }

  SynchronizationReport Compare(uint64_t revision) {
    const int size = kNumNodes * std::min<int>(revision, kRevisions) / kRevisions;
    MapMission mission;
    mission.id = kMission;
    for (int i = 0; i < size; ++i) {
      mission.nodes.push_back({i, {i}, mission_.truth[i] * Noise(), i % 20 == 0});
    }
    MapGraph graph;
    graph.revision = revision;
    graph.map_epoch = 1;
    graph.missions = {mission};
    const auto report = synchronizer_->Synchronize(graph);
    EXPECT_TRUE(report.ok()) << report.status();
    return *report;
  }

 private:
  Rigid3d Noise() {
    Vector6d xi;
    for (double& entry : xi) entry = normal_(random_);
    xi.head<3>() *= sigma_m_;
    xi.tail<3>() *= 0.1 * sigma_m_;
    return Exp(xi);
  }

  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  const double sigma_m_;
  const DriftingMission mission_;
  FakeHost host_;
  std::unique_ptr<GraphSynchronizer> synchronizer_;
};

int CountBatches(bool noise_floor) {
  int batches = 0;
  for (const double sigma_m : {0.002, 0.01, 0.02, 0.05}) {
    for (int seed = 1; seed <= 10; ++seed) {
      Robot robot(seed, sigma_m, noise_floor);
      for (uint64_t revision = 1; revision <= kRevisions; ++revision) {
        batches += !robot.Compare(revision).batch.empty();
      }
    }
  }
  return batches;
}

TEST(HealthyRobot, IsLeftAloneByTheNoiseFloor) {
  const int with = CountBatches(true), without = CountBatches(false);
  std::cout << "batches in 400 comparisons: " << with << ", without a noise floor " << without
            << "\n";
  EXPECT_LE(with, 4);
  EXPECT_GT(without, 20);  // else there is nothing to show here
}

TEST(HealthyRobot, ThatDriftsIsCorrected) {
  constexpr double kSigma_m = 0.01;
  for (int seed = 1; seed <= 10; ++seed) {
    Robot robot(seed, kSigma_m, true);
    for (uint64_t revision = 1; revision <= kRevisions; ++revision) robot.Compare(revision);
    robot.Drift(200, 20 * kSigma_m);
    const SynchronizationReport report = robot.Compare(kRevisions + 1);
    EXPECT_FALSE(report.batch.add.empty()) << "seed " << seed << ": " << report.held_back;
  }
}

}  // namespace
}  // namespace overtone
