// SPDX-License-Identifier: Apache-2.0
// Upload throughput with as much under way as the window allows, beside the two things that it
// cannot be faster than: a bare gRPC stream of the same frames whose service answers each at once,
// and a sequential write of the same bytes to one file, synced whenever as many are written as the
// robots' windows hold, since no more are acknowledged before they are on disk. All three in turn,
// so that what else the machine does strikes them alike; medians.
//   share: the server's throughput over the slower of the two.
// Quotas and the search for loop closures are off. TMPDIR: on the disk to be measured.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <deque>
#include <iostream>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/synchronization/mutex.h"
#include "benchmark/benchmark.h"
#include "grpcpp/grpcpp.h"
#include "overtone/core/graph/point_cloud_codec.h"
#include "overtone/proto/conversion/id_conversion.h"
#include "overtone/proto/conversion/limits.h"
#include "overtone/proto/conversion/sha256.h"
#include "overtone/proto/conversion/submap_conversion.h"
#include "overtone/services/mapping_server/mapping_server.h"
#include "overtone/tests/support/straight_mission.h"
#include "overtone/tests/support/temporary_directory.h"

namespace overtone {
namespace {

using Request = v1::UploadSubmapsRequest;
using Response = v1::UploadSubmapsResponse;

constexpr int kKeyframesPerSubmap = 20;
constexpr int64_t kWindowBytes = 4 << 20;  // as the server's default

[[noreturn]] void Die(const std::string& why) {
  std::cerr << why << "\n";
  std::exit(1);
}

// What one robot sends.
struct Mission {
  MissionId id;
  std::vector<Request> submaps;
  std::map<std::string, std::vector<Request>> chunks;  // of a cloud, by its digest
  int64_t bytes = 0;
};

void AddCloud(KeyframeCloud& cloud, const PointCloud& points, Mission& mission) {
  const std::string blob = *EncodePointCloud(points, {});
  cloud.cloud = nullptr;
  cloud.sha256 = Sha256(blob);
  cloud.encoded_bytes = static_cast<int64_t>(blob.size());
  std::vector<Request>& chunks = mission.chunks[cloud.sha256];
  for (size_t offset = 0; offset < blob.size(); offset += limits::kMaxBlobChunkBytes) {
    v1::BlobChunk& chunk = *chunks.emplace_back().mutable_blob();
    chunk.set_sha256(cloud.sha256);
    chunk.set_offset(static_cast<int64_t>(offset));
    chunk.set_data(blob.substr(offset, limits::kMaxBlobChunkBytes));
    mission.bytes += static_cast<int64_t>(chunks.back().ByteSizeLong());
  }
}

// `points` of each keyframe's cloud; 0: no clouds. No two missions' clouds are alike.
Mission MakeMission(int robot, int num_submaps, int points) {
  Mission mission;
  mission.id = {absl::StrCat("robot", robot), "run"};
  for (int i = 0; i < num_submaps; ++i) {
    Submap submap = StraightSubmap(i, kKeyframesPerSubmap);
    if (points > 0) {
      submap = WithClouds(std::move(submap), kKeyframesPerSubmap, points);
      for (KeyframeCloud& cloud : submap.clouds) {
        PointCloud points = *cloud.cloud;
        points.points.front().x() += static_cast<float>(robot);
        AddCloud(cloud, points, mission);
      }
    }
    *mission.submaps.emplace_back().mutable_submap() = ToProto(submap);
    mission.bytes += static_cast<int64_t>(mission.submaps.back().ByteSizeLong());
  }
  return mission;
}

// Answers at once, and reads on meanwhile: wants every cloud, and takes it, in one chunk.
class BareService final : public v1::MappingService::CallbackService {
 public:
  using Reactor = grpc::ServerBidiReactor<Request, Response>;
  Reactor* UploadSubmaps(grpc::CallbackServerContext*) override { return new Answering; }

 private:
  class Answering final : public Reactor {
   public:
    Answering() { StartRead(&request_); }
    void OnReadDone(bool ok) override {
      absl::MutexLock lock(&mutex_);
      closed_ = !ok;
      if (ok) {
        Take();
        StartRead(&request_);
      }
      Advance();
    }
    void OnWriteDone(bool /*ok*/) override {
      absl::MutexLock lock(&mutex_);
      writing_ = false;
      answers_.pop_front();
      Advance();
    }
    void OnDone() override { delete this; }

   private:
    void Take() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
      if (request_.has_header()) {
        answers_.emplace_back().mutable_ready()->set_window_bytes(kWindowBytes);
      } else if (request_.has_submap()) {
        answers_.emplace_back().mutable_ack()->set_durable_through_sequence(
            request_.submap().sequence());
        if (request_.submap().clouds().empty()) return;
        v1::UploadWant& want = *answers_.emplace_back().mutable_want();
        for (const auto& cloud : request_.submap().clouds()) want.add_sha256(cloud.sha256());
      } else {
        answers_.emplace_back().mutable_blob_result()->set_sha256(request_.blob().sha256());
      }
    }
    void Advance() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
      if (writing_) return;
      if (!answers_.empty()) {
        writing_ = true;
        StartWrite(&answers_.front());
      } else if (closed_) {
        Finish(grpc::Status::OK);
      }
    }

    absl::Mutex mutex_;
    Request request_;
    std::deque<Response> answers_ ABSL_GUARDED_BY(mutex_);
    bool writing_ ABSL_GUARDED_BY(mutex_) = false;
    bool closed_ ABSL_GUARDED_BY(mutex_) = false;
  };
};

// Sends all that a robot has, submaps first and then the clouds as they are wanted, with less than
// the window under way.
class Robot {
 public:
  Robot(const std::string& address, const Mission& mission) : mission_(mission) {
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);  // a connection for each robot
    stub_ = v1::MappingService::NewStub(
        grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments));
  }

  void Upload() {
    stream_ = stub_->UploadSubmaps(&context_);
    Request header;
    header.mutable_header()->set_map("town");
    *header.mutable_header()->mutable_mission() = ToProto(mission_.id);
    Response response;
    if (!stream_->Write(header) || !stream_->Read(&response) || !response.has_ready()) {
      Die("no Ready");
    }
    std::thread reader([this] { ReadAnswers(); });
    for (const Request& submap : mission_.submaps) {
      Send(submap, [this](int64_t bytes) { submaps_under_way_.push_back(bytes); });
    }
    for (size_t sent = 0; sent < mission_.chunks.size(); ++sent) SendBlob(NextWanted());
    reader.join();
    stream_->WritesDone();
    while (stream_->Read(&response)) {  // that nothing more is wanted
    }
    const grpc::Status status = stream_->Finish();
    if (!status.ok()) Die(status.error_message());
  }

 private:
  template <typename Note>
  void Send(const Request& request, const Note& note) {
    const auto bytes = static_cast<int64_t>(request.ByteSizeLong());
    {
      absl::MutexLock lock(&mutex_);
      const auto room = [this]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
        return bytes_under_way_ < kWindowBytes;
      };
      mutex_.Await(absl::Condition(&room));
      bytes_under_way_ += bytes;
      note(bytes);
    }
    if (!stream_->Write(request)) Die("the stream broke");
  }

  void SendBlob(const std::string& sha256) {
    for (const Request& chunk : mission_.chunks.at(sha256)) {
      Send(chunk, [&](int64_t bytes) { blobs_under_way_[sha256] += bytes; });
    }
  }

  std::string NextWanted() {
    absl::MutexLock lock(&mutex_);
    const auto any = [this]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return !wanted_.empty(); };
    mutex_.Await(absl::Condition(&any));
    std::string sha256 = std::move(wanted_.front());
    wanted_.pop_front();
    return sha256;
  }

  // Until all is acknowledged.
  void ReadAnswers() {
    Response response;
    int64_t next_sequence = 0;
    size_t blobs = 0;
    const auto submaps = static_cast<int64_t>(mission_.submaps.size());
    while (next_sequence < submaps || blobs < mission_.chunks.size()) {
      if (!stream_->Read(&response)) Die("the stream broke");
      absl::MutexLock lock(&mutex_);
      if (response.has_ack()) {
        for (; next_sequence <= response.ack().durable_through_sequence(); ++next_sequence) {
          bytes_under_way_ -= submaps_under_way_.front();
          submaps_under_way_.pop_front();
        }
      } else if (response.has_want()) {
        wanted_.insert(wanted_.end(), response.want().sha256().begin(),
                       response.want().sha256().end());
      } else if (response.has_blob_result() && response.blob_result().code() == 0) {
        bytes_under_way_ -= blobs_under_way_[response.blob_result().sha256()];
        ++blobs;
      } else {
        Die(response.ShortDebugString());
      }
    }
  }

  const Mission& mission_;
  std::unique_ptr<v1::MappingService::Stub> stub_;
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReaderWriter<Request, Response>> stream_;
  absl::Mutex mutex_;
  int64_t bytes_under_way_ ABSL_GUARDED_BY(mutex_) = 0;
  std::deque<int64_t> submaps_under_way_ ABSL_GUARDED_BY(mutex_);
  std::map<std::string, int64_t> blobs_under_way_ ABSL_GUARDED_BY(mutex_);
  std::deque<std::string> wanted_ ABSL_GUARDED_BY(mutex_);
};

// Seconds, all robots side by side.
double Upload(const std::string& address, const std::vector<Mission>& missions) {
  const auto begin = std::chrono::steady_clock::now();
  std::vector<std::thread> threads;
  for (const Mission& mission : missions) {
    threads.emplace_back([&] { Robot(address, mission).Upload(); });
  }
  for (std::thread& thread : threads) thread.join();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

double UploadToServer(const std::vector<Mission>& missions) {
  const TemporaryDirectory data_dir;
  ServerOptions options;
  options.listen = "127.0.0.1:0";
  options.data_dir = data_dir.path();
  options.quotas.max_messages_per_s = options.quotas.max_bytes_per_s = 0;
  options.loop_closures.enabled = false;
  const auto server = MappingServer::Start(options);
  if (!server.ok()) Die(server.status().ToString());
  return Upload((*server)->address(), missions);
}

double UploadBare(const std::vector<Mission>& missions) {
  BareService service;
  int port = 0;
  grpc::ServerBuilder builder;
  builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
  builder.RegisterService(&service);
  const auto server = builder.BuildAndStart();
  const double seconds = Upload(absl::StrCat("127.0.0.1:", port), missions);
  server->Shutdown();
  return seconds;
}

double WriteAndSync(const std::vector<Mission>& missions) {
  std::vector<std::string> records;
  for (const Mission& mission : missions) {
    for (const Request& submap : mission.submaps) records.push_back(submap.SerializeAsString());
    for (const auto& [sha256, chunks] : mission.chunks) {
      for (const Request& chunk : chunks) records.push_back(chunk.SerializeAsString());
    }
  }
  const TemporaryDirectory folder;
  const auto begin = std::chrono::steady_clock::now();
  const int fd = open(folder.File("log").c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
  const auto window = static_cast<size_t>(kWindowBytes) * missions.size();
  size_t not_synced = 0;
  for (const std::string& record : records) {
    if (write(fd, record.data(), record.size()) != static_cast<ssize_t>(record.size()))
      Die("write");
    not_synced += record.size();
    if (not_synced < window) continue;
    if (fsync(fd) != 0) Die("fsync");
    not_synced = 0;
  }
  if (fsync(fd) != 0) Die("fsync");
  close(fd);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

double Median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void BM_Upload(benchmark::State& state) {
  std::vector<Mission> missions;
  double megabytes = 0;
  for (int robot = 0; robot < state.range(0); ++robot) {
    missions.push_back(MakeMission(robot, static_cast<int>(state.range(1) / state.range(0)),
                                   static_cast<int>(state.range(2))));
    megabytes += 1e-6 * static_cast<double>(missions.back().bytes);
  }
  std::vector<double> server_s, bare_s, write_s;
  for (auto _ : state) {
    server_s.push_back(UploadToServer(missions));
    bare_s.push_back(UploadBare(missions));
    write_s.push_back(WriteAndSync(missions));
    state.SetIterationTime(server_s.back());
  }
  state.counters["MB"] = megabytes;
  state.counters["server_MBps"] = megabytes / Median(server_s);
  state.counters["bare_MBps"] = megabytes / Median(bare_s);
  state.counters["write_MBps"] = megabytes / Median(write_s);
  state.counters["share"] = std::max(Median(bare_s), Median(write_s)) / Median(server_s);
}
BENCHMARK(BM_Upload)
    ->ArgNames({"robots", "submaps", "points"})
    ->Args({1, 2000, 0})
    ->Args({8, 4000, 0})
    ->Args({1, 200, 2500})
    ->Args({8, 400, 2500})
    ->Args({8, 64, 35000})
    ->UseManualTime()
    ->Iterations(5)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace overtone
