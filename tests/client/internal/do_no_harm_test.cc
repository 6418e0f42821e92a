// SPDX-License-Identifier: Apache-2.0
// A server that is wrong for a while: the robot is never much worse off than by itself, and gets
// its correction once the server has found its mistake.
#include <random>

#include "gtest/gtest.h"
#include "overtone/client/estimator/onboard_estimator.h"
#include "overtone/client/internal/graph_synchronizer.h"
#include "overtone/core/synchronization/aligned_rmse.h"
#include "overtone/core/synchronization/chain_smoother.h"
#include "overtone/tests/support/drifting_mission.h"

namespace overtone {
namespace {

const MissionId kMission = {"robot", "run"};
constexpr int kNumNodes = 300;

class Robot {
 public:
  explicit Robot(int seed) : mission_(MakeDriftingMission(kNumNodes, seed, 0.02, 0.003)) {}

  // Drives on to `end` keyframes.
  void Drive(int end) {
    std::vector<Keyframe> keyframes;
    for (int i = driven_; i < end; ++i) {
      const Rigid3d motion =
          i == 0 ? mission_.odometry[0] : mission_.odometry[i - 1].Inverse() * mission_.odometry[i];
      EXPECT_TRUE(estimator_.AddKeyframe(i, {i}, motion, mission_.step_covariance[i]).ok());
      Keyframe keyframe;
      keyframe.mission_from_body = mission_.odometry[i];
      keyframe.motion_covariance = mission_.step_covariance[i];
      keyframes.push_back(keyframe);
    }
    synchronizer_.AddKeyframes(driven_, keyframes);
    driven_ = end;
  }

  SynchronizationReport Compare(const std::vector<Rigid3d>& server, uint64_t revision) {
    MapMission mission;
    mission.id = kMission;
    for (int i = 0; i < driven_; ++i) mission.nodes.push_back({i, {i}, server[i], i % 20 == 0});
    MapGraph graph;
    graph.revision = revision;
    graph.map_epoch = 1;
    graph.missions = {mission};
    const auto report = synchronizer_.Synchronize(graph);
    EXPECT_TRUE(report.ok()) << report.status();
    return *report;
  }

  // What the server makes of it with a closure between keyframes that are far apart in truth.
  std::vector<Rigid3d> FalseEstimate(int from, int to, const Rigid3d& from_tform_to) const {
    std::vector<OdometryStep> steps(kNumNodes);
    for (int i = 1; i < kNumNodes; ++i) {
      steps[i].previous_from_this = mission_.truth[i - 1].Inverse() * mission_.truth[i];
      steps[i].covariance = mission_.step_covariance[i];
      steps[i].information = mission_.step_covariance[i].inverse();
    }
    const auto bent = SmoothChain(mission_.truth, steps,
                                  {{from, to, from_tform_to, 1e4 * Matrix6d::Identity()}}, {});
    EXPECT_TRUE(bent.ok()) << bent.status();
    return bent->poses;
  }

  const std::vector<Rigid3d>& truth() const { return mission_.truth; }
  double OnboardRmse() const { return Rmse(mission_.odometry); }
  double CorrectedRmse() {
    std::vector<Rigid3d> corrected;
    for (const OnboardPose& pose : estimator_.Trajectory()) {
      corrected.push_back(pose.estimate_from_body);
    }
    return Rmse(corrected);
  }

 private:
  double Rmse(const std::vector<Rigid3d>& poses) const {
    return AlignedRmse(
        std::vector<Rigid3d>(poses.begin(), poses.begin() + driven_),
        std::vector<Rigid3d>(mission_.truth.begin(), mission_.truth.begin() + driven_));
  }

  const DriftingMission mission_;
  int driven_ = 0;
  OnboardEstimator estimator_;
  GraphSynchronizer synchronizer_{kMission, SynchronizationOptions(), &estimator_};
};

TEST(DoNoHarm, AFalseClosureIsNotFollowedAndForgottenWhenTheServerDemotesIt) {
  for (const int seed : {1, 2, 3}) {
    Robot robot(seed);
    // Two places on opposite sides of the ellipse, taken for one.
    const std::vector<Rigid3d> wrong = robot.FalseEstimate(30, 170, Rigid3d());
    uint64_t revision = 0;
    const auto step = [&](int end, const std::vector<Rigid3d>& server) {
      robot.Drive(end);
      const SynchronizationReport report = robot.Compare(server, ++revision);
      EXPECT_LE(robot.CorrectedRmse(), 1.05 * robot.OnboardRmse())
          << "seed " << seed << ", revision " << revision << ": " << report.held_back;
      return report;
    };
    step(100, robot.truth());
    step(180, robot.truth());
    EXPECT_LT(robot.CorrectedRmse(), 0.5 * robot.OnboardRmse());
    EXPECT_NE(step(210, wrong).held_back, "");
    EXPECT_NE(step(240, wrong).held_back, "");
    step(270, robot.truth());
    step(300, robot.truth());
    EXPECT_LT(robot.CorrectedRmse(), 0.5 * robot.OnboardRmse()) << "seed " << seed;
  }
}

}  // namespace
}  // namespace overtone
