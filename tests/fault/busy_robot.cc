// SPDX-License-Identifier: Apache-2.0
#include "overtone/tests/fault/busy_robot.h"

#include <cstdlib>
#include <functional>
#include <iostream>
#include <random>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/tests/support/straight_mission.h"

namespace overtone {
namespace {

std::shared_ptr<const PointCloud> RandomCloud(const std::string& seed, int num_points) {
  std::seed_seq sequence(seed.begin(), seed.end());
  std::mt19937 random(sequence);
  std::uniform_real_distribution<float> uniform(-20, 20);
  auto cloud = std::make_shared<PointCloud>();
  for (int i = 0; i < num_points; ++i) {
    cloud->points.emplace_back(uniform(random), uniform(random), uniform(random));
  }
  return cloud;
}

}  // namespace

Submap BusySubmap(const MissionId& mission, int64_t sequence, int points_per_cloud) {
  Submap submap = StraightSubmap(sequence, kBusyKeyframes);
  const std::string seed = absl::StrCat(ToString(mission), " ", sequence);
  submap.clouds.push_back({submap.first_index, RandomCloud(seed, points_per_cloud)});
  if (sequence > 0) {
    LoopClosure closure = ClosureBetween(submap.first_index - 2, submap.first_index + 1);
    closure.from.mission = closure.to.mission = mission;
    submap.loop_closures.push_back(closure);
  }
  return submap;
}

BusyRobot::BusyRobot(MappingClientOptions options, Pace pace)
    : mission_(options.mission), pace_(pace) {
  auto client = MappingClient::Create(std::move(options), &host_);
  if (!client.ok()) {
    std::cerr << client.status() << std::endl;
    std::abort();
  }
  client_ = *std::move(client);
  handed_ = client_->NextSubmap().sequence;
  thread_ = std::thread([this] { Run(); });
}

BusyRobot::~BusyRobot() { Rest(); }

void BusyRobot::Rest() {
  {
    absl::MutexLock lock(&mutex_);
    resting_ = true;
  }
  if (thread_.joinable()) thread_.join();
}

absl::Status BusyRobot::Complaint() const {
  {
    absl::MutexLock lock(&mutex_);
    RETURN_IF_ERROR(failure_);
  }
  absl::MutexLock lock(&host_.mutex);
  if (!host_.rejected.empty()) {
    return absl::DataLossError(absl::StrCat("submap ", host_.rejected[0].first,
                                            " rejected: ", host_.rejected[0].second.ToString()));
  }
  for (const absl::Status& reason : host_.rejected_closures) return reason;
  if (host_.clouds_dropped.empty()) return absl::OkStatus();
  return absl::DataLossError(absl::StrCat(host_.clouds_dropped.back(), " clouds dropped"));
}

void BusyRobot::Run() {
  while (true) {
    const MappingClientStats stats = client_->Stats();
    absl::Status status;
    if (handed_ < pace_.max_submaps && stats.submaps_waiting < pace_.max_waiting) {
      status = client_->AddSubmap(BusySubmap(mission_, handed_, pace_.points_per_cloud));
      if (status.ok()) ++handed_;
    }
    absl::MutexLock lock(&mutex_);
    failure_.Update(status);
    // The robot drives on: its pace, not a wait for anything.
    if (mutex_.AwaitWithTimeout(absl::Condition(&resting_), pace_.interval)) return;
  }
}

}  // namespace overtone
