// SPDX-License-Identifier: Apache-2.0
#include "overtone/tests/support/scripted_mapping_server.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <utility>

#include "absl/strings/str_cat.h"
#include "grpcpp/security/server_credentials.h"
#include "grpcpp/server_builder.h"

namespace overtone {

void ScriptedMappingServer::Upload::Ready(int64_t next_sequence, int64_t window_bytes) {
  v1::UploadSubmapsResponse response;
  response.mutable_ready()->set_next_sequence(next_sequence);
  response.mutable_ready()->set_window_bytes(window_bytes);
  stream_->Write(response);
}

void ScriptedMappingServer::Upload::Ack(int64_t durable_through_sequence) {
  v1::UploadSubmapsResponse response;
  response.mutable_ack()->set_durable_through_sequence(durable_through_sequence);
  stream_->Write(response);
}

void ScriptedMappingServer::Upload::Reject(int64_t sequence, grpc::StatusCode code,
                                           const std::string& message, int64_t expected_sequence) {
  v1::UploadSubmapsResponse response;
  response.mutable_reject()->set_sequence(sequence);
  response.mutable_reject()->set_code(code);
  response.mutable_reject()->set_message(message);
  response.mutable_reject()->set_expected_sequence(expected_sequence);
  stream_->Write(response);
}

void ScriptedMappingServer::Upload::Want(const std::vector<std::string>& sha256) {
  v1::UploadSubmapsResponse response;
  response.mutable_want();
  for (const std::string& digest : sha256) response.mutable_want()->add_sha256(digest);
  stream_->Write(response);
}

void ScriptedMappingServer::Upload::BlobResult(const std::string& sha256, grpc::StatusCode code) {
  v1::UploadSubmapsResponse response;
  response.mutable_blob_result()->set_sha256(sha256);
  response.mutable_blob_result()->set_code(code);
  stream_->Write(response);
}

v1::UploadSubmapsRequest ScriptedMappingServer::Upload::ReadFrame() {
  v1::UploadSubmapsRequest request;
  if (!stream_->Read(&request)) request.Clear();
  if (request.has_submap()) {
    absl::MutexLock lock(&server_->mutex_);
    server_->received_.push_back(request.submap().sequence());
  }
  return request;
}

int64_t ScriptedMappingServer::Upload::Read() {
  const v1::UploadSubmapsRequest request = ReadFrame();
  return request.has_submap() ? request.submap().sequence() : -1;
}

grpc::Status ScriptedMappingServer::Upload::AcknowledgeEverything(
    const std::function<void(const v1::Submap&)>& store) {
  while (true) {
    const v1::UploadSubmapsRequest request = ReadFrame();
    if (request.has_submap()) {
      store(request.submap());
      Ack(request.submap().sequence());
      std::vector<std::string> wanted;
      for (const v1::CloudReference& cloud : request.submap().clouds()) {
        wanted.push_back(cloud.sha256());
        lacking_[cloud.sha256()] = cloud;
      }
      if (!wanted.empty()) Want(wanted);
    } else if (request.has_blob()) {
      TakeChunk(request.blob());
    } else {
      return grpc::Status::OK;
    }
  }
}

void ScriptedMappingServer::Upload::TakeChunk(const v1::BlobChunk& chunk) {
  if (chunk.offset() == 0) assembled_.clear();
  assembled_ += chunk.data();
  if (assembled_.size() < lacking_[chunk.sha256()].encoded_bytes()) return;
  {
    absl::MutexLock lock(&server_->mutex_);
    server_->blobs_.push_back(assembled_);
  }
  lacking_.erase(chunk.sha256());
  BlobResult(chunk.sha256(), grpc::StatusCode::OK);
  if (lacking_.empty()) Want({});
}

void ScriptedMappingServer::Watch::Snapshot(const v1::Graph& graph) {
  v1::WatchGraphResponse response;
  *response.mutable_snapshot() = graph;
  stream->Write(response);
}

void ScriptedMappingServer::Watch::Delta(const v1::GraphDelta& delta) {
  v1::WatchGraphResponse response;
  *response.mutable_delta() = delta;
  stream->Write(response);
}

void ScriptedMappingServer::Watch::Heartbeat() {
  v1::WatchGraphResponse response;
  response.mutable_heartbeat();
  stream->Write(response);
}

ScriptedMappingServer::ScriptedMappingServer(Script script, const std::string& address)
    : script_(std::move(script)) {
  grpc::ServerBuilder builder;
  builder.AddListeningPort(address, grpc::InsecureServerCredentials(), &port_);
  builder.RegisterService(this);
  server_ = builder.BuildAndStart();
}

ScriptedMappingServer::~ScriptedMappingServer() {
  {
    absl::MutexLock lock(&mutex_);
    stopping_ = true;
  }
  server_->Shutdown(std::chrono::system_clock::now());
}

std::string ScriptedMappingServer::address() const { return absl::StrCat("127.0.0.1:", port_); }

grpc::Status ScriptedMappingServer::Park() {
  absl::MutexLock lock(&mutex_);
  mutex_.Await(absl::Condition(&stopping_));
  return grpc::Status(grpc::StatusCode::UNAVAILABLE, "stopping");
}

std::vector<int64_t> ScriptedMappingServer::Received() const {
  absl::MutexLock lock(&mutex_);
  return received_;
}

std::vector<std::string> ScriptedMappingServer::Blobs() const {
  absl::MutexLock lock(&mutex_);
  return blobs_;
}

std::vector<v1::UploadHeader> ScriptedMappingServer::Headers() const {
  absl::MutexLock lock(&mutex_);
  return headers_;
}

std::vector<v1::WatchGraphRequest> ScriptedMappingServer::Watches() const {
  absl::MutexLock lock(&mutex_);
  return watches_;
}

bool ScriptedMappingServer::AwaitReceived(int count, absl::Duration timeout) const {
  const auto received = [&] {
    mutex_.AssertHeld();
    return static_cast<int>(received_.size()) >= count;
  };
  absl::MutexLock lock(&mutex_);
  return mutex_.AwaitWithTimeout(absl::Condition(&received), timeout);
}

bool ScriptedMappingServer::AwaitWatches(int count, absl::Duration timeout) const {
  const auto watched = [&] {
    mutex_.AssertHeld();
    return static_cast<int>(watches_.size()) >= count;
  };
  absl::MutexLock lock(&mutex_);
  return mutex_.AwaitWithTimeout(absl::Condition(&watched), timeout);
}

grpc::Status ScriptedMappingServer::UploadSubmaps(grpc::ServerContext* /*context*/,
                                                  Upload::Stream* stream) {
  if (!script_.upload) return Park();
  v1::UploadSubmapsRequest request;
  if (!stream->Read(&request) || !request.has_header()) {
    return grpc::Status(grpc::StatusCode::INVALID_ARGUMENT, "header: must come first");
  }
  int call = 0;
  {
    absl::MutexLock lock(&mutex_);
    call = static_cast<int>(headers_.size());
    headers_.push_back(request.header());
  }
  Upload upload(this, stream, request.header());
  return script_.upload(call, upload);
}

grpc::Status ScriptedMappingServer::WatchGraph(grpc::ServerContext* /*context*/,
                                               const v1::WatchGraphRequest* request,
                                               grpc::ServerWriter<v1::WatchGraphResponse>* stream) {
  int call = 0;
  {
    absl::MutexLock lock(&mutex_);
    call = static_cast<int>(watches_.size());
    watches_.push_back(*request);
  }
  Watch watch{*request, stream};
  return script_.watch ? script_.watch(call, watch) : Park();
}

grpc::Status ScriptedMappingServer::AddLoopClosures(grpc::ServerContext* /*context*/,
                                                    const v1::AddLoopClosuresRequest* request,
                                                    v1::AddLoopClosuresResponse* /*response*/) {
  int call = 0;
  {
    absl::MutexLock lock(&mutex_);
    call = closure_calls_++;
  }
  return script_.add_loop_closures ? script_.add_loop_closures(call, *request) : Park();
}

grpc::Status ScriptedMappingServer::GetServerInfo(grpc::ServerContext* /*context*/,
                                                  const v1::GetServerInfoRequest* /*request*/,
                                                  v1::GetServerInfoResponse* response) {
  if (!script_.server_info) return grpc::Status(grpc::StatusCode::UNIMPLEMENTED, "");
  script_.server_info(*response);
  return grpc::Status::OK;
}

grpc::Status ScriptedMappingServer::ReportStatus(grpc::ServerContext* /*context*/,
                                                 const v1::ReportStatusRequest* request,
                                                 v1::ReportStatusResponse* response) {
  if (!script_.report_status) return grpc::Status(grpc::StatusCode::UNIMPLEMENTED, "");
  int call = 0;
  {
    absl::MutexLock lock(&mutex_);
    call = report_calls_++;
  }
  return script_.report_status(call, *request, *response);
}

SilentSocket::SilentSocket() : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof(address);
  if (bind(socket_, reinterpret_cast<sockaddr*>(&address), length) == 0 &&
      listen(socket_, /*backlog=*/16) == 0 &&
      getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &length) == 0) {
    port_ = ntohs(address.sin_port);
  }
}

SilentSocket::~SilentSocket() { close(socket_); }

std::string SilentSocket::address() const { return absl::StrCat("127.0.0.1:", port_); }

}  // namespace overtone
