// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/mapping_pipeline.h"

#include <atomic>
#include <memory>
#include <thread>

#include "absl/synchronization/notification.h"
#include "gtest/gtest.h"
#include "overtone/tests/support/street_team.h"

namespace overtone {
namespace {

struct Heard {
  std::atomic<int> published{0};
  std::atomic<int> stored{0};
};

MappingPipeline::Sink SinkInto(Heard& heard) {
  MappingPipeline::Sink sink;
  sink.publish = [&](std::shared_ptr<const MapSnapshot>, const RevisionHistory&) {
    ++heard.published;
  };
  sink.store = [&](const std::string&, const std::function<void(absl::Status)>& done) {
    ++heard.stored;
    done(absl::OkStatus());
  };
  return sink;
}

// On the mapping thread until the pipeline is being destroyed. What it asked for before is answered
// later still.
absl::Status WaitForTheEnd(MappingPipeline& pipeline) {
  const auto ending = std::make_shared<std::atomic<bool>>(false);
  while (!*ending) {
    pipeline.Decide([](MultiRobotMap&) { return absl::OkStatus(); },
                    [ending](const absl::Status& status) {
                      if (absl::IsUnavailable(status)) *ending = true;
                    });
    std::this_thread::yield();
  }
  return absl::OkStatus();
}

TEST(MappingPipeline, DestroyedInTheMiddleOfACycleItGivesTheOptimisationUp) {
  Heard heard;
  absl::Notification in_cycle;
  {
    MappingPipeline pipeline({}, SinkInto(heard));
    pipeline.Start(absl::nullopt);
    const auto fill_and_wait = [&](MultiRobotMap& map) {
      StreetTeam team(2, 400);
      while (team.NumKeyframes() < 400) team.AddSubmap(map);
      in_cycle.Notify();
      return WaitForTheEnd(pipeline);
    };
    pipeline.Decide(fill_and_wait, [](const absl::Status&) {});
    in_cycle.WaitForNotification();
  }
  EXPECT_EQ(heard.published, 0);
  EXPECT_EQ(heard.stored, 0);
}

TEST(MappingPipeline, DestroyedAtRestItHasPublishedAndStoredAll) {
  Heard heard;
  absl::Notification published;
  MappingPipeline::Sink sink = SinkInto(heard);
  sink.publish = [&](std::shared_ptr<const MapSnapshot> snapshot, const RevisionHistory&) {
    if (snapshot->missions.size() == 2 && heard.published++ == 0) published.Notify();
  };
  {
    MappingPipeline pipeline({}, sink);
    pipeline.Start(absl::nullopt);
    pipeline.Decide(
        [](MultiRobotMap& map) {
          StreetTeam team(2, 400);
          while (team.NumKeyframes() < 400) team.AddSubmap(map);
          return absl::OkStatus();
        },
        [](const absl::Status&) {});
    published.WaitForNotification();
  }
  EXPECT_GE(heard.stored, 1);
}

}  // namespace
}  // namespace overtone
