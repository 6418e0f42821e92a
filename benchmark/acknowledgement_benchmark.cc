// SPDX-License-Identifier: Apache-2.0
// What durability costs the robot that waits for an acknowledgement: latency with one submap under
// way, and submaps a second with a window of them, for 1, 8 and 32 robots; by a server that writes
// to disk, the same server in memory, and a bare gRPC stream that answers each frame at once.
//   TMPDIR=<on the disk to be measured> acknowledgement_benchmark
#include <algorithm>
#include <functional>
#include <iostream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/time/clock.h"
#include "grpcpp/grpcpp.h"
#include "overtone/proto/conversion/id_conversion.h"
#include "overtone/proto/conversion/submap_conversion.h"
#include "overtone/services/mapping_server/mapping_server.h"
#include "overtone/tests/support/straight_mission.h"
#include "overtone/tests/support/temporary_directory.h"
#include "spdlog/spdlog.h"

namespace overtone {
namespace {

constexpr int kKeyframesPerSubmap = 20;
constexpr int kSubmaps = 300;  // of each robot and measurement
constexpr int kWindow = 16;    // submaps under way, for throughput
constexpr int kTeams[] = {1, 8, 32};

// The frames of UploadSubmaps, and an answer to each at once.
class BareService final : public v1::MappingService::CallbackService {
 public:
  using Reactor = grpc::ServerBidiReactor<v1::UploadSubmapsRequest, v1::UploadSubmapsResponse>;
  Reactor* UploadSubmaps(grpc::CallbackServerContext*) override { return new Answering; }

 private:
  class Answering final : public Reactor {
   public:
    Answering() { StartRead(&request_); }
    void OnReadDone(bool ok) override {
      if (!ok) return Finish(grpc::Status::OK);
      if (request_.has_header()) {
        response_.mutable_ready()->set_next_sequence(0);
      } else {
        response_.mutable_ack()->set_durable_through_sequence(request_.submap().sequence());
      }
      StartWrite(&response_);
    }
    void OnWriteDone(bool ok) override {
      if (!ok) return Finish(grpc::Status::OK);
      StartRead(&request_);
    }
    void OnDone() override { delete this; }

   private:
    v1::UploadSubmapsRequest request_;
    v1::UploadSubmapsResponse response_;
  };
};

[[noreturn]] void Die(const std::string& why) {
  std::cerr << why << "\n";
  std::exit(1);
}

std::vector<v1::UploadSubmapsRequest> Frames() {
  std::vector<v1::UploadSubmapsRequest> frames(kSubmaps);
  for (int i = 0; i < kSubmaps; ++i) {
    *frames[i].mutable_submap() = ToProto(StraightSubmap(i, kKeyframesPerSubmap));
  }
  return frames;
}

// One robot: sends all frames, `window` at most without an acknowledgement. Microseconds from each
// frame to the acknowledgement that covers it.
std::vector<double> Upload(const std::string& address, const std::string& map,
                           const std::string& robot, int window,
                           const std::vector<v1::UploadSubmapsRequest>& frames) {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);  // a connection for each robot
  const auto stub = v1::MappingService::NewStub(
      grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments));
  grpc::ClientContext context;
  const auto stream = stub->UploadSubmaps(&context);
  v1::UploadSubmapsRequest header;
  header.mutable_header()->set_map(map);
  *header.mutable_header()->mutable_mission() = ToProto(MissionId{robot, "run_1"});
  v1::UploadSubmapsResponse response;
  if (!stream->Write(header) || !stream->Read(&response) || !response.has_ready()) Die("no Ready");
  std::vector<absl::Time> sent;
  std::vector<double> latency_us;
  while (latency_us.size() < frames.size()) {
    while (sent.size() < frames.size() && sent.size() - latency_us.size() < size_t(window)) {
      sent.push_back(absl::Now());
      if (!stream->Write(frames[sent.size() - 1])) Die("the stream broke");
    }
    if (!stream->Read(&response)) Die(stream->Finish().error_message());
    if (!response.has_ack()) Die(response.ShortDebugString());
    const absl::Time now = absl::Now();
    while (static_cast<int64_t>(latency_us.size()) <= response.ack().durable_through_sequence()) {
      latency_us.push_back(absl::ToDoubleMicroseconds(now - sent[latency_us.size()]));
    }
  }
  stream->WritesDone();
  stream->Finish();
  return latency_us;
}

struct Figures {
  double p50_us = 0, p99_us = 0, submaps_per_s = 0;
};

// `team` robots side by side, each on a connection of its own.
Figures Measure(const std::string& address, const std::string& map, int team, int window) {
  static const std::vector<v1::UploadSubmapsRequest> frames = Frames();
  std::vector<std::vector<double>> latencies(team);
  std::vector<std::thread> robots;
  const absl::Time begin = absl::Now();
  for (int i = 0; i < team; ++i) {
    robots.emplace_back(
        [&, i] { latencies[i] = Upload(address, map, absl::StrCat("robot_", i), window, frames); });
  }
  for (std::thread& robot : robots) robot.join();
  const double seconds = absl::ToDoubleSeconds(absl::Now() - begin);
  std::vector<double> all;
  for (const auto& one : latencies) all.insert(all.end(), one.begin(), one.end());
  std::sort(all.begin(), all.end());
  return {all[all.size() / 2], all[all.size() * 99 / 100], all.size() / seconds};
}

Figures MeasureBare(int team, int window) {
  BareService service;
  int port = 0;
  grpc::ServerBuilder builder;
  builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
  builder.RegisterService(&service);
  const auto server = builder.BuildAndStart();
  const Figures figures = Measure(absl::StrCat("127.0.0.1:", port), "town", team, window);
  server->Shutdown();
  return figures;
}

Figures MeasureServer(const std::string& data_dir, int team, int window) {
  ServerOptions options;
  options.listen = "127.0.0.1:0";
  options.data_dir = data_dir;
  options.quotas.max_messages_per_s = options.quotas.max_bytes_per_s = 0;  // not what is measured
  const auto server = MappingServer::Start(options);
  if (!server.ok()) Die(server.status().ToString());
  return Measure((*server)->address(), "town", team, window);
}

void Print(int team, const char* what, int window) {
  const TemporaryDirectory data_dir;
  const Figures disk = MeasureServer(data_dir.path(), team, window);
  const Figures memory = MeasureServer(":memory:", team, window);
  const Figures bare = MeasureBare(team, window);
  for (const auto& [name, figures] :
       {std::pair("disk", disk), std::pair("memory", memory), std::pair("bare stream", bare)}) {
    std::cout << absl::StreamFormat("| %d | %s | %s | %.2f | %.2f | %.0f | %.2f | %.2f |\n", team,
                                    what, name, figures.p50_us / 1e3, figures.p99_us / 1e3,
                                    figures.submaps_per_s, figures.p50_us / memory.p50_us,
                                    figures.p50_us / bare.p50_us)
              << std::flush;
  }
}

}  // namespace
}  // namespace overtone

int main() {
  spdlog::set_level(spdlog::level::err);
  std::cout << "| robots | under way | server | p50 ms | p99 ms | submaps/s | p50 / memory | p50 / "
               "bare |\n|---|---|---|---|---|---|---|---|\n";
  for (const int team : overtone::kTeams) {
    overtone::Print(team, "one", 1);
    overtone::Print(team, "sixteen", overtone::kWindow);
  }
}
