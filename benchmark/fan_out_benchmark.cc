// SPDX-License-Identifier: Apache-2.0
// From a published revision to the last watcher having received it: the server's own WatchGraph,
// each watcher on a TCP connection of its own, all in this process, so that server and watchers
// share the processor. Watchers take bytes; to decode them is each robot's own work.
//
// Every revision moves every node by some centimetres: the largest delta there is. `keyframes`
// above `nodes` are Kron-reduced for each revision. `own`: there are as many robots as watchers,
// and each asks for its own `nodes` alone, as the client does. first_ms: the first watcher has it,
// so all that is done once for all. p50_ms, max_ms: the last has it. bytes: of the last frame;
// delta: 1 when it is one.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/synchronization/notification.h"
#include "benchmark/benchmark.h"
#include "grpcpp/generic/generic_stub.h"
#include "grpcpp/grpcpp.h"
#include "overtone/services/mapping_server/mapping_service.h"
#include "overtone/services/mapping_server/quota/robot_quotas.h"
#include "overtone/services/mapping_server/security/server_security.h"
#include "overtone/tests/support/synthetic_graph.h"

namespace overtone {
namespace {

using Clock = std::chrono::steady_clock;

constexpr char kMap[] = "town";
constexpr double kBendM = 0.05;

std::string RobotName(int number) { return absl::StrCat("robot", number); }

// The missions of so many robots, all bent to one side or the other.
std::shared_ptr<const MapSnapshot> Snapshot(const SyntheticTeam& team, int robots,
                                            uint64_t revision, uint64_t map_epoch) {
  auto snapshot = std::make_shared<MapSnapshot>();
  snapshot->revision = revision;
  snapshot->map_epoch = map_epoch;
  const size_t n = team.server.size();
  for (int m = 0; m < robots; ++m) {
    SnapshotMission mission;
    mission.id = {RobotName(m), "run"};
    mission.anchored = true;
    mission.submap_starts = {0};
    std::vector<Keyframe> keyframes;
    for (size_t i = n * m / robots; i < n * (m + 1) / robots; ++i) {
      Keyframe keyframe;
      keyframe.stamp = {static_cast<int64_t>(keyframes.size() + 1) * 400'123'456};
      keyframe.mission_from_body = team.onboard[i];
      keyframe.motion_covariance = 1e-4 * Matrix6d::Identity();
      Rigid3d map_from_body = team.server[i];
      map_from_body.translation.x() +=
          kBendM * (1 + std::sin(0.01 * static_cast<double>(keyframes.size()))) *
          static_cast<double>(revision % 2);
      mission.map_from_body.push_back(map_from_body);
      keyframes.push_back(keyframe);
    }
    mission.keyframes = KeyframeBlocks(std::move(keyframes));
    snapshot->missions.push_back(std::move(mission));
  }
  std::sort(snapshot->missions.begin(), snapshot->missions.end(),
            [](const SnapshotMission& a, const SnapshotMission& b) { return a.id < b.id; });
  return snapshot;
}

// What MappingServer puts together, with a map that revisions are handed to.
class Server {
 public:
  explicit Server(int max_nodes)
      : options_(Options(max_nodes)),
        security_(*ServerSecurity::Create(options_.security)),
        quotas_(options_.quotas),
        registry_(options_),
        service_(options_, security_->access(), &quotas_, &registry_, &sessions_) {
    if (!registry_.Open().ok()) std::abort();
    map_ = *registry_.Acquire(kMap);
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", security_->Credentials(), &port_);
    builder.RegisterService(&service_);
    server_ = builder.BuildAndStart();
  }
  ~Server() {
    map_.reset();
    sessions_.Stop();
    registry_.Stop();
    server_->Shutdown();
  }

  std::shared_ptr<const MapSnapshot> Next(const SyntheticTeam& team, int robots) {
    return Snapshot(team, robots, ++revision_, map_->epoch());
  }
  void Publish(std::shared_ptr<const MapSnapshot> snapshot) {
    map_->publisher().Publish(std::move(snapshot));
  }
  std::string address() const { return absl::StrCat("127.0.0.1:", port_); }

 private:
  static ServerOptions Options(int max_nodes) {
    ServerOptions options;
    options.data_dir = ":memory:";
    options.graph.max_nodes = max_nodes;
    options.graph.min_distance_m = 0;      // every keyframe is a node
    options.publisher.heartbeat_s = 3600;  // every frame is a revision
    options.limits.max_message_bytes = 64 << 20;
    return options;
  }

  const ServerOptions options_;
  const std::unique_ptr<ServerSecurity> security_;
  RobotQuotas quotas_;
  MapRegistry registry_;
  UploadSessions sessions_;
  MappingService service_;
  std::shared_ptr<HostedMap> map_;
  uint64_t revision_ = 0;
  int port_ = 0;
  std::unique_ptr<grpc::Server> server_;
};

// How many watchers have the newest revision.
class Arrivals {
 public:
  void Expect(int watchers) {
    left_ = watchers;
    expected_ = watchers;
    all_ = std::make_unique<absl::Notification>();
  }
  void Count(const grpc::ByteBuffer& frame) {
    const Clock::time_point now = Clock::now();
    const int left = --left_;
    if (left == expected_ - 1) first_ = now;
    if (left > 0) return;
    last_ = now;
    frame_ = frame;
    all_->Notify();
  }
  void AwaitAll() const { all_->WaitForNotification(); }
  Clock::time_point first() const { return first_; }
  Clock::time_point last() const { return last_; }
  grpc::ByteBuffer* frame() { return &frame_; }  // the last

 private:
  std::atomic<int> left_ = 0;
  int expected_ = 0;
  std::unique_ptr<absl::Notification> all_;
  Clock::time_point first_, last_;
  grpc::ByteBuffer frame_;
};

class Watcher : public grpc::ClientBidiReactor<v1::WatchGraphRequest, grpc::ByteBuffer> {
 public:
  // `robot` empty: the whole map.
  Watcher(const std::string& address, const std::string& robot, Arrivals* arrivals)
      : arrivals_(arrivals) {
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);  // a connection for each
    arguments.SetMaxReceiveMessageSize(-1);
    stub_ = std::make_unique<Stub>(
        grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments));
    request_.set_map(kMap);
    request_.mutable_options()->set_robot(robot);
    stub_->PrepareBidiStreamingCall(&context_, "/overtone.v1.MappingService/WatchGraph", {}, this);
    StartWriteLast(&request_, grpc::WriteOptions());
    StartRead(&frame_);
    StartCall();
  }
  ~Watcher() override {
    context_.TryCancel();
    done_.WaitForNotification();
  }

  void OnReadDone(bool ok) override {
    if (!ok) return;
    arrivals_->Count(frame_);
    StartRead(&frame_);
  }
  void OnDone(const grpc::Status& status) override {
    if (status.error_code() != grpc::StatusCode::CANCELLED) std::abort();
    done_.Notify();
  }

 private:
  using Stub = grpc::TemplatedGenericStub<v1::WatchGraphRequest, grpc::ByteBuffer>;

  Arrivals* const arrivals_;
  std::unique_ptr<Stub> stub_;
  grpc::ClientContext context_;
  v1::WatchGraphRequest request_;
  grpc::ByteBuffer frame_;
  absl::Notification done_;
};

double Seconds(Clock::duration duration) { return std::chrono::duration<double>(duration).count(); }

bool IsDelta(grpc::ByteBuffer* frame) {
  v1::WatchGraphResponse response;
  return grpc::SerializationTraits<v1::WatchGraphResponse>::Deserialize(frame, &response).ok() &&
         response.has_delta();
}

void BM_FanOut(benchmark::State& state) {
  const int num_watchers = static_cast<int>(state.range(0));
  const bool own = state.range(3) != 0;
  const int robots = own ? num_watchers : 5;
  Server server(static_cast<int>(state.range(1)));
  const SyntheticTeam team = MakeSyntheticTeam(static_cast<int>(state.range(2)));
  Arrivals arrivals;
  arrivals.Expect(num_watchers);
  server.Publish(server.Next(team, robots));
  std::vector<std::unique_ptr<Watcher>> watchers;
  for (int i = 0; i < num_watchers; ++i) {
    watchers.push_back(
        std::make_unique<Watcher>(server.address(), own ? RobotName(i) : "", &arrivals));
  }
  arrivals.AwaitAll();
  std::vector<double> first_ms, last_ms;
  for (auto _ : state) {
    std::shared_ptr<const MapSnapshot> next = server.Next(team, robots);
    arrivals.Expect(num_watchers);
    const Clock::time_point published = Clock::now();
    server.Publish(std::move(next));
    arrivals.AwaitAll();
    const double seconds = Seconds(arrivals.last() - published);
    state.SetIterationTime(seconds);
    first_ms.push_back(1e3 * Seconds(arrivals.first() - published));
    last_ms.push_back(1e3 * seconds);
  }
  watchers.clear();
  std::sort(first_ms.begin(), first_ms.end());
  std::sort(last_ms.begin(), last_ms.end());
  state.counters["first_ms"] = first_ms[first_ms.size() / 2];
  state.counters["p50_ms"] = last_ms[last_ms.size() / 2];
  state.counters["max_ms"] = last_ms.back();
  state.counters["bytes"] = static_cast<double>(arrivals.frame()->Length());
  state.counters["delta"] = IsDelta(arrivals.frame());
}
void Runs(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgNames({"watchers", "nodes", "keyframes", "own"});
  benchmark->UseManualTime()->Unit(benchmark::kMillisecond)->Iterations(31);
}
BENCHMARK(BM_FanOut)
    ->Apply(Runs)
    ->ArgsProduct({{1, 10, 100, 500, 1000}, {2000}, {2000}, {0}})
    ->Args({500, 200, 200, 0})
    ->Args({500, 20000, 20000, 0})
    ->Args({500, 2000, 4000, 0})
    ->Args({16, 2000, 16 * 2000, 1})
    ->Args({50, 2000, 50 * 2000, 1});

}  // namespace
}  // namespace overtone
