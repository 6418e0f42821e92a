// SPDX-License-Identifier: Apache-2.0
// A server in this process on a free port, and plain gRPC stubs as its peers.
#ifndef OVERTONE_TESTS_SERVICES_MAPPING_SERVER_SERVER_FIXTURE_H_
#define OVERTONE_TESTS_SERVICES_MAPPING_SERVER_SERVER_FIXTURE_H_

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "grpcpp/grpcpp.h"
#include "gtest/gtest.h"
#include "overtone/proto/conversion/graph_conversion.h"
#include "overtone/proto/conversion/id_conversion.h"
#include "overtone/proto/conversion/submap_conversion.h"
#include "overtone/services/mapping_server/mapping_server.h"
#include "overtone/tests/proto/conversion_fixture.h"
#include "overtone/tests/support/plain_peers.h"

namespace overtone::testing {

inline ServerOptions TestOptions() {
  ServerOptions options;
  options.listen = "localhost:0";
  options.data_dir = ":memory:";
  options.publisher.heartbeat_s = 0.05;
  // Every keyframe is a node.
  options.graph.min_distance_m = 0;
  options.graph.min_rotation_rad = 0;
  options.shutdown_s = 1.0;
  return options;
}

class ServerTest : public ::testing::Test {
 protected:
  void StartServer(const ServerOptions& options = TestOptions()) {
    auto server = MappingServer::Start(options);
    ASSERT_TRUE(server.ok()) << server.status();
    server_ = *std::move(server);
    const auto channel =
        grpc::CreateChannel(server_->address(), grpc::InsecureChannelCredentials());
    mapping_ = v1::MappingService::NewStub(channel);
    admin_ = v1::MapAdminService::NewStub(channel);
  }
  void SetUp() override { StartServer(); }

  // Uploads submaps 0, 1, ... of `keyframes` keyframes each, and waits until each is acknowledged.
  void Upload(const std::string& map, const MissionId& mission, int submaps, int keyframes) {
    Uploader uploader(*mapping_, map, mission);
    ASSERT_TRUE(uploader.Read().has_ready());
    for (int i = 0; i < submaps; ++i) {
      const auto answer = uploader.Send(MakeSubmap(i, i * keyframes, keyframes));
      ASSERT_EQ(answer.ack().durable_through_sequence(), i) << answer.ShortDebugString();
    }
    EXPECT_TRUE(uploader.Close().ok());
  }

  // Waits for a revision with that many nodes.
  MapGraph WaitForNodes(const std::string& map, int num_nodes) {
    Watcher watcher(*mapping_, WatchRequest(map));
    MapGraph graph;
    while (graph.NumNodes() < num_nodes) {
      const v1::WatchGraphResponse frame = watcher.ReadGraph();
      const auto next =
          frame.has_delta() ? ApplyDelta(graph, frame.delta()) : FromProto(frame.snapshot());
      EXPECT_TRUE(next.ok()) << next.status();
      if (!next.ok()) break;
      graph = *next;
    }
    return graph;
  }

  // Calls a unary method of MapAdminService; a failure fails the test.
  template <typename Response, typename Request, typename Method>
  Response Call(Method method, const Request& request) {
    Response response;
    const grpc::Status status = Try(method, request, response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return response;
  }
  template <typename Response, typename Request, typename Method>
  grpc::Status Try(Method method, const Request& request, Response& response) {
    grpc::ClientContext context;
    context.set_deadline(Deadline());
    return (admin_.get()->*method)(&context, request, &response);
  }

  // Of a map that is there, when its newest revision holds all that came.
  v1::MapSummary Settle(const std::string& map) {
    const auto deadline = Deadline();
    while (std::chrono::system_clock::now() < deadline) {
      const auto response =
          Call<v1::ListMapsResponse>(&v1::MapAdminService::Stub::ListMaps, v1::ListMapsRequest());
      const auto found =
          std::find_if(response.maps().begin(), response.maps().end(),
                       [&](const v1::MapSummary& summary) { return summary.map() == map; });
      if (found == response.maps().end()) {
        ADD_FAILURE() << "no map " << map;
        return v1::MapSummary();
      }
      if (found->front_end_backlog() == 0) return *found;
      std::this_thread::yield();
    }
    ADD_FAILURE() << "map " << map << " does not come to rest";
    return v1::MapSummary();
  }

  v1::GetUploadStateResponse UploadState(const std::string& map, const MissionId& mission) {
    v1::GetUploadStateRequest request;
    request.set_map(map);
    *request.mutable_mission() = ToProto(mission);
    v1::GetUploadStateResponse response;
    grpc::ClientContext context;
    context.set_deadline(Deadline());
    const grpc::Status status = mapping_->GetUploadState(&context, request, &response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return response;
  }

  std::unique_ptr<MappingServer> server_;
  std::unique_ptr<v1::MappingService::Stub> mapping_;
  std::unique_ptr<v1::MapAdminService::Stub> admin_;
};

}  // namespace overtone::testing

#endif  // OVERTONE_TESTS_SERVICES_MAPPING_SERVER_SERVER_FIXTURE_H_
