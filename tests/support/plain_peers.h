// SPDX-License-Identifier: Apache-2.0
// Peers of a mapping server made of nothing but gRPC stubs, so that they can misbehave.
#ifndef OVERTONE_TESTS_SUPPORT_PLAIN_PEERS_H_
#define OVERTONE_TESTS_SUPPORT_PLAIN_PEERS_H_

#include <chrono>
#include <memory>
#include <string>

#include "grpcpp/grpcpp.h"
#include "overtone/proto/conversion/id_conversion.h"
#include "overtone/proto/conversion/submap_conversion.h"
#include "overtone/v1/mapping_service.grpc.pb.h"

namespace overtone::testing {

inline std::chrono::system_clock::time_point Deadline() {
  return std::chrono::system_clock::now() + std::chrono::seconds(30);
}

// An upload stream, one frame at a time.
class Uploader {
 public:
  Uploader(v1::MappingService::Stub& stub, const std::string& map, const MissionId& mission,
           std::chrono::system_clock::time_point deadline = Deadline()) {
    context_.set_deadline(deadline);
    stream_ = stub.UploadSubmaps(&context_);
    v1::UploadSubmapsRequest request;
    request.mutable_header()->set_map(map);
    *request.mutable_header()->mutable_mission() = ToProto(mission);
    stream_->Write(request);
  }
  // A test may end in the middle of a stream.
  ~Uploader() { Cancel(); }
  void Cancel() { context_.TryCancel(); }

  // The next frame from the server; an empty one at the end of the stream.
  v1::UploadSubmapsResponse Read() {
    v1::UploadSubmapsResponse response;
    stream_->Read(&response);
    return response;
  }
  v1::UploadSubmapsResponse Send(const v1::Submap& submap) {
    v1::UploadSubmapsRequest request;
    *request.mutable_submap() = submap;
    stream_->Write(request);
    return Read();
  }
  v1::UploadSubmapsResponse Send(const Submap& submap) { return Send(ToProto(submap)); }
  void Write(const v1::BlobChunk& chunk) {
    v1::UploadSubmapsRequest request;
    *request.mutable_blob() = chunk;
    stream_->Write(request);
  }
  // False: the stream has ended.
  bool Write(const v1::UploadSubmapsRequest& request) { return stream_->Write(request); }

  grpc::Status Close() {
    stream_->WritesDone();
    return End();
  }
  // Waits for the server to end the stream.
  grpc::Status End() {
    v1::UploadSubmapsResponse response;
    while (stream_->Read(&response)) {
    }
    return stream_->Finish();
  }

 private:
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReaderWriter<v1::UploadSubmapsRequest, v1::UploadSubmapsResponse>>
      stream_;
};

// An open WatchGraph.
class Watcher {
 public:
  Watcher(v1::MappingService::Stub& stub, const v1::WatchGraphRequest& request,
          std::chrono::system_clock::time_point deadline = Deadline()) {
    context_.set_deadline(deadline);
    stream_ = stub.WatchGraph(&context_, request);
  }
  ~Watcher() { context_.TryCancel(); }

  // Any frame. False: the stream ended.
  bool Read(v1::WatchGraphResponse& response) { return stream_->Read(&response); }
  // The next frame that is no heartbeat; an empty one at the end of the stream.
  v1::WatchGraphResponse ReadGraph() {
    v1::WatchGraphResponse response;
    while (stream_->Read(&response)) {
      if (!response.has_heartbeat()) return response;
    }
    return v1::WatchGraphResponse();
  }
  grpc::Status Finish() {
    v1::WatchGraphResponse response;
    while (stream_->Read(&response)) {
    }
    return stream_->Finish();
  }

 private:
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReader<v1::WatchGraphResponse>> stream_;
};

inline v1::WatchGraphRequest WatchRequest(const std::string& map) {
  v1::WatchGraphRequest request;
  request.set_map(map);
  return request;
}

}  // namespace overtone::testing

#endif  // OVERTONE_TESTS_SUPPORT_PLAIN_PEERS_H_
