// SPDX-License-Identifier: Apache-2.0
#include <functional>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/tests/services/mapping_server/server_fixture.h"

namespace overtone {
namespace {

using testing::MakeClosure;
using testing::MakeSubmap;
using testing::SameGraph;
using testing::ServerTest;
using ::testing::StartsWith;
using testing::Uploader;
using testing::Watcher;
using testing::WatchRequest;

const MissionId kAnna = {"anna", "run1"};
const MissionId kBert = {"bert", "run1"};

class WatchGraphTest : public ServerTest {
 protected:
  v1::Graph GetGraph(const std::string& map, const v1::GraphRequestOptions& options = {}) {
    v1::GetGraphRequest request;
    request.set_map(map);
    *request.mutable_options() = options;
    v1::GetGraphResponse response;
    grpc::ClientContext context;
    context.set_deadline(testing::Deadline());
    const grpc::Status status = mapping_->GetGraph(&context, request, &response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return response.graph();
  }
};

TEST_F(WatchGraphTest, AWatchOpenedBeforeTheFirstSubmapGetsTheMapWhenItComes) {
  Watcher watcher(*mapping_, WatchRequest("mine"));
  v1::WatchGraphResponse frame;
  ASSERT_TRUE(watcher.Read(frame));
  EXPECT_TRUE(frame.has_heartbeat());
  EXPECT_EQ(frame.heartbeat().revision(), 0u);
  Upload("mine", kAnna, 1, 5);
  frame = watcher.ReadGraph();
  ASSERT_TRUE(frame.has_snapshot());
  EXPECT_EQ(frame.snapshot().map(), "mine");
  EXPECT_EQ(frame.snapshot().encoding(), v1::GRAPH_ENCODING_COMPACT);
  const auto graph = FromProto(frame.snapshot());
  ASSERT_TRUE(graph.ok()) << graph.status();
  EXPECT_EQ(graph->NumNodes(), 5);
}

TEST_F(WatchGraphTest, DeltasAddUpToTheNewestGraph) {
  Upload("mine", kAnna, 1, 5);
  Watcher watcher(*mapping_, WatchRequest("mine"));
  v1::WatchGraphResponse frame = watcher.ReadGraph();
  ASSERT_TRUE(frame.has_snapshot());
  MapGraph graph = *FromProto(frame.snapshot());
  Upload("mine", kBert, 4, 10);
  int deltas = 0;
  while (graph.NumNodes() < 45) {
    frame = watcher.ReadGraph();
    ASSERT_TRUE(frame.has_delta()) << frame.ShortDebugString();
    const uint64_t before = graph.revision;
    auto next = ApplyDelta(graph, frame.delta());
    ASSERT_TRUE(next.ok()) << next.status();
    graph = *std::move(next);
    EXPECT_GT(graph.revision, before);
    ++deltas;
  }
  EXPECT_GT(deltas, 0);
  v1::GraphRequestOptions options;
  options.set_encoding(v1::GRAPH_ENCODING_COMPACT);
  const auto newest = FromProto(GetGraph("mine", options));
  ASSERT_TRUE(newest.ok()) << newest.status();
  EXPECT_TRUE(SameGraph(graph, *newest));
}

TEST_F(WatchGraphTest, AResumedWatchGetsADeltaAndAnUnknownRevisionASnapshot) {
  Upload("mine", kAnna, 1, 5);
  const MapGraph seen = WaitForNodes("mine", 5);
  Upload("mine", kBert, 1, 7);
  WaitForNodes("mine", 12);
  v1::WatchGraphRequest request = WatchRequest("mine");
  request.set_after_revision(seen.revision);
  request.set_map_epoch(seen.map_epoch);
  {
    Watcher watcher(*mapping_, request);
    const auto frame = watcher.ReadGraph();
    ASSERT_TRUE(frame.has_delta()) << frame.ShortDebugString();
    const auto graph = ApplyDelta(seen, frame.delta());
    ASSERT_TRUE(graph.ok()) << graph.status();
    EXPECT_EQ(graph->NumNodes(), 12);
  }
  {
    v1::WatchGraphRequest other_epoch = request;
    other_epoch.set_map_epoch(seen.map_epoch + 1);
    Watcher watcher(*mapping_, other_epoch);
    EXPECT_TRUE(watcher.ReadGraph().has_snapshot());
  }
  {
    v1::WatchGraphRequest future = request;
    future.set_after_revision(1 << 20);
    Watcher watcher(*mapping_, future);
    EXPECT_TRUE(watcher.ReadGraph().has_snapshot());
  }
}

TEST_F(WatchGraphTest, AWatchThatIsUpToDateHearsHeartbeatsOnly) {
  Upload("mine", kAnna, 1, 5);
  const MapGraph seen = WaitForNodes("mine", 5);
  v1::WatchGraphRequest request = WatchRequest("mine");
  request.set_after_revision(seen.revision);
  request.set_map_epoch(seen.map_epoch);
  Watcher watcher(*mapping_, request);
  v1::WatchGraphResponse frame;
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(watcher.Read(frame));
    ASSERT_TRUE(frame.has_heartbeat()) << frame.ShortDebugString();
    EXPECT_EQ(frame.heartbeat().revision(), seen.revision);
    EXPECT_EQ(frame.heartbeat().map_epoch(), seen.map_epoch);
    EXPECT_GT(frame.heartbeat().server_time().seconds(), 1'600'000'000);
  }
}

TEST_F(WatchGraphTest, OnlyTheRobotAskedForIsSent) {
  Upload("mine", kAnna, 1, 5);
  Upload("mine", kBert, 1, 7);
  WaitForNodes("mine", 12);
  v1::GraphRequestOptions options;
  options.set_robot("bert");
  const v1::Graph graph = GetGraph("mine", options);
  ASSERT_EQ(graph.missions_size(), 1);
  EXPECT_EQ(graph.missions(0).id().robot(), "bert");
  EXPECT_EQ(graph.missions(0).nodes_size(), 7);
  options.set_robot("nobody");
  EXPECT_EQ(GetGraph("mine", options).missions_size(), 0);
}

TEST_F(WatchGraphTest, AboveTheNodeLimitTheGraphIsReducedAndItsEdgesAreSentWhenAskedFor) {
  Upload("mine", kAnna, 4, 25);
  WaitForNodes("mine", 100);
  v1::GraphRequestOptions options;
  options.set_max_nodes(30);
  EXPECT_FALSE(GetGraph("mine", options).has_edges());
  options.set_include_edges(true);
  const v1::Graph message = GetGraph("mine", options);
  const auto graph = FromProto(message);
  ASSERT_TRUE(graph.ok()) << graph.status();
  EXPECT_LE(graph->NumNodes(), 30);
  EXPECT_FALSE(graph->edges.empty());
  EXPECT_EQ(graph->missions[0].nodes.back().index, 99);
}

TEST_F(WatchGraphTest, MissionsWithoutATieStayUnanchoredUntilAClosureTiesThem) {
  Upload("mine", kAnna, 1, 5);
  Upload("mine", kBert, 1, 5);
  MapGraph graph = WaitForNodes("mine", 10);
  EXPECT_TRUE(graph.missions[0].anchored);
  EXPECT_FALSE(graph.missions[1].anchored);

  Watcher watcher(*mapping_, WatchRequest("mine"));
  graph = *FromProto(watcher.ReadGraph().snapshot());
  v1::AddLoopClosuresRequest request;
  request.set_map("mine");
  // Three that agree, as a first tie needs; the last one twice.
  for (const int i : {1, 2, 3}) {
    *request.add_loop_closures() = ToProto(MakeClosure({kAnna, i}, {kBert, i}));
  }
  *request.add_loop_closures() = request.loop_closures(2);
  v1::AddLoopClosuresResponse response;
  grpc::ClientContext context;
  const grpc::Status status = mapping_->AddLoopClosures(&context, request, &response);
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(response.added(), 3);
  // The mapping thread may have begun with the first one or two.
  while (!graph.missions[1].anchored) {
    const auto next = ApplyDelta(graph, watcher.ReadGraph().delta());
    ASSERT_TRUE(next.ok()) << next.status();
    graph = *next;
  }
  EXPECT_EQ(graph.missions[1].component, 0);

  grpc::ClientContext again;
  ASSERT_TRUE(mapping_->AddLoopClosures(&again, request, &response).ok());
  EXPECT_EQ(response.added(), 0);
}

TEST_F(WatchGraphTest, TooManyWatchersAreResourceExhausted) {
  ServerOptions options = testing::TestOptions();
  options.limits.max_watchers_per_map = 2;
  StartServer(options);
  v1::WatchGraphResponse frame;
  Watcher first(*mapping_, WatchRequest("mine"));
  ASSERT_TRUE(first.Read(frame));
  Watcher second(*mapping_, WatchRequest("mine"));
  ASSERT_TRUE(second.Read(frame));
  Watcher third(*mapping_, WatchRequest("mine"));
  EXPECT_EQ(third.Finish().error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_TRUE(first.Read(frame));
}

struct BadRequest {
  std::string message;
  std::function<void(v1::WatchGraphRequest&)> spoil;
};

TEST_F(WatchGraphTest, EveryBadRequestIsRefusedByField) {
  Upload("mine", kAnna, 1, 5);
  const std::vector<BadRequest> cases = {
      {"map:", [](auto& r) { r.set_map(""); }},
      {"map:", [](auto& r) { r.set_map(std::string(10000, 'a')); }},
      {"options.max_nodes:", [](auto& r) { r.mutable_options()->set_max_nodes(-1); }},
      {"options.max_nodes:", [](auto& r) { r.mutable_options()->set_max_nodes(1'000'001); }},
      {"options.encoding:",
       [](auto& r) { r.mutable_options()->set_encoding(static_cast<GraphEncoding>(77)); }},
      {"options.robot:", [](auto& r) { r.mutable_options()->set_robot("A B"); }},
  };
  for (const BadRequest& bad : cases) {
    v1::WatchGraphRequest request = WatchRequest("mine");
    bad.spoil(request);
    const grpc::Status watched = Watcher(*mapping_, request).Finish();
    EXPECT_EQ(watched.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << bad.message;
    EXPECT_THAT(watched.error_message(), StartsWith(bad.message));

    v1::GetGraphRequest twin;
    twin.set_map(request.map());
    *twin.mutable_options() = request.options();
    v1::GetGraphResponse response;
    grpc::ClientContext context;
    const grpc::Status got = mapping_->GetGraph(&context, twin, &response);
    EXPECT_EQ(got.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << bad.message;
    EXPECT_THAT(got.error_message(), StartsWith(bad.message));
  }
  EXPECT_EQ(WaitForNodes("mine", 5).NumNodes(), 5);  // and the map lives on
}

}  // namespace
}  // namespace overtone
