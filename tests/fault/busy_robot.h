// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_TESTS_FAULT_BUSY_ROBOT_H_
#define OVERTONE_TESTS_FAULT_BUSY_ROBOT_H_

#include <atomic>
#include <memory>
#include <string>
#include <thread>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "overtone/client/mapping_client.h"
#include "overtone/tests/support/fake_host.h"

namespace overtone {

constexpr int kBusyKeyframes = 3;  // of one submap

// The same content whenever it is made: along the x axis, one cloud that no other submap of any
// robot has, and from the second on a loop closure that agrees with the odometry.
Submap BusySubmap(const MissionId& mission, int64_t sequence, int points_per_cloud);

// A robot that hands over one submap after the other, from a thread of its own.
class BusyRobot {
 public:
  struct Pace {
    absl::Duration interval = absl::Milliseconds(40);  // between two submaps
    int64_t max_waiting = 40;  // submaps; no more while so many are not acknowledged
    int64_t max_submaps = 1 << 30;
    int points_per_cloud = 100;
  };

  // options.server, map, mission and whatever differs from the defaults.
  BusyRobot(MappingClientOptions options, Pace pace);
  ~BusyRobot();

  void Rest();  // hands over no more; what it did still goes up
  int64_t handed() const { return handed_; }
  const MissionId& mission() const { return mission_; }
  MappingClient& client() { return *client_; }
  const FakeHost& host() const { return host_; }

  // What the host was told that it must never be told: submaps or closures refused, clouds dropped,
  // a submap not taken. Ok: nothing.
  absl::Status Complaint() const;

 private:
  void Run();

  const MissionId mission_;
  const Pace pace_;
  FakeHost host_;
  std::unique_ptr<MappingClient> client_;
  mutable absl::Mutex mutex_;
  bool resting_ ABSL_GUARDED_BY(mutex_) = false;
  absl::Status failure_ ABSL_GUARDED_BY(mutex_);
  std::atomic<int64_t> handed_{0};
  std::thread thread_;
};

}  // namespace overtone

#endif  // OVERTONE_TESTS_FAULT_BUSY_ROBOT_H_
