// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/graph_subscriber.h"

#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/client/internal/channel.h"
#include "overtone/proto/conversion/graph_conversion.h"
#include "overtone/tests/support/scripted_mapping_server.h"
#include "overtone/tests/support/straight_mission.h"

namespace overtone {
namespace {

using testing::ElementsAre;
using Watch = ScriptedMappingServer::Watch;

GraphFormat PlainFormat() {
  GraphFormat format;
  format.map = "town";
  format.encoding = v1::GRAPH_ENCODING_PLAIN;
  return format;
}

v1::Graph Message(int num_nodes, uint64_t revision, uint64_t map_epoch = 1) {
  return ToProto(StraightGraph(num_nodes, revision, map_epoch), PlainFormat());
}

v1::GraphDelta Delta(const MapGraph& base, const MapGraph& target) {
  return MakeDelta(base, target, PlainFormat());
}

// A subscriber, and what it reports.
class Robot {
 public:
  explicit Robot(const std::string& address, absl::Duration stale_after = absl::Seconds(60)) {
    MappingClientOptions options;
    options.server = address;
    stub_ = v1::MappingService::NewStub(CreateChannel(options));
    v1::WatchGraphRequest request;
    request.set_map("town");
    subscriber_ = std::make_unique<GraphSubscriber>(
        stub_.get(), request, Backoff(absl::Milliseconds(2), absl::Milliseconds(20), /*seed=*/1),
        stale_after, &counters_, Logger([this](LogLevel, absl::string_view line) {
          absl::MutexLock lock(&mutex_);
          log_.emplace_back(line);
        }),
        GraphSubscriber::Listener{[this](std::shared_ptr<const MapGraph> graph) {
                                    absl::MutexLock lock(&mutex_);
                                    graphs_.push_back(*graph);
                                  },
                                  [this](LinkState state) {
                                    absl::MutexLock lock(&mutex_);
                                    link_states_.push_back(state);
                                  }});
  }

  bool AwaitRevision(uint64_t revision) {
    const auto arrived = [&] {
      mutex_.AssertHeld();
      return !graphs_.empty() && graphs_.back().revision == revision;
    };
    absl::MutexLock lock(&mutex_);
    return mutex_.AwaitWithTimeout(absl::Condition(&arrived), absl::Seconds(20));
  }
  bool AwaitLinkStates(int count) {
    const auto told = [&] {
      mutex_.AssertHeld();
      return static_cast<int>(link_states_.size()) >= count;
    };
    absl::MutexLock lock(&mutex_);
    return mutex_.AwaitWithTimeout(absl::Condition(&told), absl::Seconds(20));
  }
  std::vector<LinkState> link_states() {
    absl::MutexLock lock(&mutex_);
    return link_states_;
  }
  std::vector<uint64_t> revisions() {
    absl::MutexLock lock(&mutex_);
    std::vector<uint64_t> revisions;
    for (const MapGraph& graph : graphs_) revisions.push_back(graph.revision);
    return revisions;
  }
  MapGraph newest() {
    absl::MutexLock lock(&mutex_);
    return graphs_.back();
  }
  // Counted just before the listener hears of it.
  bool AwaitReconnects(int64_t count) {
    const absl::Time deadline = absl::Now() + absl::Seconds(20);
    while (counters_.reconnects < count && absl::Now() < deadline) std::this_thread::yield();
    return counters_.reconnects >= count;
  }
  std::vector<std::string> log() {
    absl::MutexLock lock(&mutex_);
    return log_;
  }
  int64_t reconnects() const { return counters_.reconnects; }
  void Stop() { subscriber_.reset(); }

 private:
  absl::Mutex mutex_;
  std::vector<MapGraph> graphs_ ABSL_GUARDED_BY(mutex_);
  std::vector<LinkState> link_states_ ABSL_GUARDED_BY(mutex_);
  std::vector<std::string> log_ ABSL_GUARDED_BY(mutex_);
  TrafficCounters counters_;
  std::unique_ptr<v1::MappingService::Stub> stub_;
  std::unique_ptr<GraphSubscriber> subscriber_;
};

// Scripts are set up before their server exists, and park through this.
struct ParkingServer {
  explicit ParkingServer(std::function<grpc::Status(int, Watch&, ParkingServer&)> watch)
      : server({{},
                [this, watch](int call, Watch& stream) { return watch(call, stream, *this); },
                {}}) {}
  grpc::Status Park() { return server.Park(); }
  ScriptedMappingServer server;
};

const grpc::Status kCableCut(grpc::StatusCode::UNAVAILABLE, "cable cut");

TEST(GraphSubscriber, PassesOnWhatIsNewerAndDropsTheRest) {
  ParkingServer parking([](int, Watch& watch, ParkingServer& server) {
    watch.Snapshot(Message(10, 3));
    watch.Snapshot(Message(10, 2));
    watch.Snapshot(Message(10, 3));
    watch.Heartbeat();
    watch.Snapshot(Message(12, 5));
    return server.Park();
  });
  Robot robot(parking.server.address());
  ASSERT_TRUE(robot.AwaitRevision(5));
  EXPECT_THAT(robot.revisions(), ElementsAre(3, 5));
  EXPECT_EQ(robot.newest().NumNodes(), 12);
}

TEST(GraphSubscriber, AppliesDeltas) {
  ParkingServer parking([](int, Watch& watch, ParkingServer& server) {
    watch.Snapshot(Message(10, 3));
    watch.Delta(Delta(StraightGraph(10, 3), StraightGraph(14, 4)));
    watch.Delta(Delta(StraightGraph(14, 4), StraightGraph(16, 6)));
    return server.Park();
  });
  Robot robot(parking.server.address());
  ASSERT_TRUE(robot.AwaitRevision(6));
  EXPECT_THAT(robot.revisions(), ElementsAre(3, 4, 6));
  EXPECT_EQ(robot.newest().NumNodes(), 16);
}

TEST(GraphSubscriber, ResumesAfterTheNewestRevision) {
  ParkingServer parking([](int call, Watch& watch, ParkingServer& server) {
    if (call == 0) {
      watch.Snapshot(Message(10, 5, /*map_epoch=*/9));
      return kCableCut;
    }
    watch.Delta(Delta(StraightGraph(10, 5, 9), StraightGraph(11, 6, 9)));
    return server.Park();
  });
  Robot robot(parking.server.address());
  ASSERT_TRUE(robot.AwaitRevision(6));
  const std::vector<v1::WatchGraphRequest> watches = parking.server.Watches();
  ASSERT_EQ(watches.size(), 2);
  EXPECT_EQ(watches[0].after_revision(), 0);
  EXPECT_EQ(watches[1].after_revision(), 5);
  EXPECT_EQ(watches[1].map_epoch(), 9);
  EXPECT_EQ(robot.reconnects(), 1);
}

TEST(GraphSubscriber, ADeltaThatDoesNotFitMakesItAskForASnapshot) {
  ParkingServer parking([](int call, Watch& watch, ParkingServer& server) {
    if (call == 0) {
      watch.Snapshot(Message(10, 3));
      watch.Delta(Delta(StraightGraph(11, 4), StraightGraph(12, 5)));
      return server.Park();
    }
    watch.Snapshot(Message(12, 5));
    return server.Park();
  });
  Robot robot(parking.server.address());
  ASSERT_TRUE(robot.AwaitRevision(5));
  EXPECT_THAT(robot.revisions(), ElementsAre(3, 5));
  EXPECT_EQ(parking.server.Watches().back().after_revision(), 0);
}

TEST(GraphSubscriber, AMalformedGraphIsDroppedAndAskedForAnew) {
  ParkingServer parking([](int call, Watch& watch, ParkingServer& server) {
    v1::Graph graph = Message(10, 7);
    if (call == 0) {
      graph.mutable_missions(0)
          ->mutable_nodes(4)
          ->mutable_map_tform_body()
          ->mutable_position()
          ->set_x(std::numeric_limits<double>::quiet_NaN());
    }
    watch.Snapshot(graph);
    return server.Park();
  });
  Robot robot(parking.server.address());
  ASSERT_TRUE(robot.AwaitRevision(7));
  EXPECT_THAT(robot.revisions(), ElementsAre(7));
  EXPECT_EQ(parking.server.Watches().size(), 2);
}

TEST(GraphSubscriber, ARestoredMapStartsItsRevisionsAnew) {
  ParkingServer parking([](int, Watch& watch, ParkingServer& server) {
    watch.Snapshot(Message(10, 8, /*map_epoch=*/1));
    watch.Snapshot(Message(5, 2, /*map_epoch=*/2));
    return server.Park();
  });
  Robot robot(parking.server.address());
  ASSERT_TRUE(robot.AwaitRevision(2));
  EXPECT_THAT(robot.revisions(), ElementsAre(8, 2));
}

TEST(GraphSubscriber, SilenceMakesTheLinkStaleAndIsGivenUp) {
  ParkingServer parking([](int call, Watch& watch, ParkingServer& server) {
    if (call < 2) watch.Heartbeat();
    return server.Park();
  });
  Robot robot(parking.server.address(), /*stale_after=*/absl::Milliseconds(100));
  ASSERT_TRUE(robot.AwaitLinkStates(4));
  EXPECT_THAT(robot.link_states(), ElementsAre(LinkState::kLive, LinkState::kStale,
                                               LinkState::kLive, LinkState::kStale));
}

// A server that closes a connection for its age, or restarts within a moment.
TEST(GraphSubscriber, AStreamThatIsBegunAnewAtOnceGoesUnnoticed) {
  for (const grpc::Status& end : {grpc::Status::OK, kCableCut}) {
    ParkingServer parking([end](int call, Watch& watch, ParkingServer& server) {
      watch.Heartbeat();
      return call == 0 ? end : server.Park();
    });
    Robot robot(parking.server.address());
    ASSERT_TRUE(parking.server.AwaitWatches(2));
    ASSERT_TRUE(robot.AwaitReconnects(1));
    EXPECT_THAT(robot.link_states(), ElementsAre(LinkState::kLive));
    EXPECT_TRUE(robot.log().empty());
  }
}

TEST(GraphSubscriber, AStreamThatBreaksAgainMeansReconnectingAndThenLiveAgain) {
  ParkingServer parking([](int call, Watch& watch, ParkingServer& server) {
    watch.Heartbeat();
    return call < 2 ? kCableCut : server.Park();
  });
  Robot robot(parking.server.address());
  ASSERT_TRUE(robot.AwaitLinkStates(3));
  EXPECT_THAT(robot.link_states(),
              ElementsAre(LinkState::kLive, LinkState::kConnecting, LinkState::kLive));
  EXPECT_EQ(robot.log().size(), 1u);
}

TEST(GraphSubscriber, ALinkThatDoesNotComeBackAtOnceIsReconnecting) {
  ParkingServer parking([](int call, Watch& watch, ParkingServer& server) {
    if (call > 0) return server.Park();
    watch.Heartbeat();
    return kCableCut;
  });
  Robot robot(parking.server.address());
  ASSERT_TRUE(robot.AwaitLinkStates(2));
  EXPECT_THAT(robot.link_states(), ElementsAre(LinkState::kLive, LinkState::kConnecting));
}

TEST(GraphSubscriber, AServerThatNeverAnswersIsStaleToo) {
  SilentSocket half_open;
  Robot robot(half_open.address(), /*stale_after=*/absl::Milliseconds(50));
  ASSERT_TRUE(robot.AwaitLinkStates(1));
  EXPECT_THAT(robot.link_states(), ElementsAre(LinkState::kStale));
}

TEST(GraphSubscriber, StopsAtOnceWhateverTheServerDoes) {
  SilentSocket half_open;
  ScriptedMappingServer parked({});
  for (const std::string& address :
       {half_open.address(), parked.address(), std::string("127.0.0.1:1")}) {
    Robot robot(address);
    const absl::Time start = absl::Now();
    robot.Stop();
    EXPECT_LT(absl::Now() - start, absl::Seconds(1)) << address;
  }
}

}  // namespace
}  // namespace overtone
