// SPDX-License-Identifier: Apache-2.0
// A mapping server on a free port of the loopback interface that does what the test says, call by
// call.
#ifndef OVERTONE_TESTS_SUPPORT_SCRIPTED_MAPPING_SERVER_H_
#define OVERTONE_TESTS_SUPPORT_SCRIPTED_MAPPING_SERVER_H_

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "grpcpp/server.h"
#include "overtone/v1/mapping_service.grpc.pb.h"

namespace overtone {

class ScriptedMappingServer final : public v1::MappingService::Service {
 public:
  // One UploadSubmaps call whose header has been read.
  class Upload {
   public:
    using Stream = grpc::ServerReaderWriter<v1::UploadSubmapsResponse, v1::UploadSubmapsRequest>;
    Upload(ScriptedMappingServer* server, Stream* stream, v1::UploadHeader header)
        : server_(server), stream_(stream), header_(std::move(header)) {}

    void Ready(int64_t next_sequence, int64_t window_bytes = 1 << 20);
    void Ack(int64_t durable_through_sequence);
    void Reject(int64_t sequence, grpc::StatusCode code, const std::string& message,
                int64_t expected_sequence = 0);
    // Empty: nothing is lacking.
    void Want(const std::vector<std::string>& sha256);
    void BlobResult(const std::string& sha256, grpc::StatusCode code);
    // Any frame; one without content when the client went away.
    v1::UploadSubmapsRequest ReadFrame();
    // The sequence of the next submap, -1 when the client went away.
    int64_t Read();
    // Reads and acknowledges until the client goes away; wants every cloud and takes it. `store`,
    // before each acknowledgement.
    grpc::Status AcknowledgeEverything(const std::function<void(const v1::Submap&)>& store =
                                           [](const v1::Submap&) {});
    const v1::UploadHeader& header() const { return header_; }

   private:
    void TakeChunk(const v1::BlobChunk& chunk);

    ScriptedMappingServer* server_;
    Stream* stream_;
    const v1::UploadHeader header_;
    std::map<std::string, v1::CloudReference> lacking_;  // by digest
    std::string assembled_;
  };

  // One WatchGraph call.
  struct Watch {
    v1::WatchGraphRequest request;
    grpc::ServerWriter<v1::WatchGraphResponse>* stream;

    void Snapshot(const v1::Graph& graph);
    void Delta(const v1::GraphDelta& delta);
    void Heartbeat();
  };

  // Called from gRPC's threads; `call` counts from 0 for each RPC.
  struct Script {
    std::function<grpc::Status(int call, Upload& upload)> upload;
    std::function<grpc::Status(int call, Watch& watch)> watch;
    std::function<grpc::Status(int call, const v1::AddLoopClosuresRequest& request)>
        add_loop_closures;
    std::function<void(v1::GetServerInfoResponse& response)> server_info;
    std::function<grpc::Status(int call, const v1::ReportStatusRequest& request,
                               v1::ReportStatusResponse& response)>
        report_status;
  };

  // Calls without a script are parked; GetServerInfo and ReportStatus then are not implemented.
  // `address`: "127.0.0.1:port".
  explicit ScriptedMappingServer(Script script, const std::string& address = "127.0.0.1:0");
  ~ScriptedMappingServer() override;

  std::string address() const;

  // Blocks until the server is destroyed: what a silent server does. A client that goes away leaves
  // it parked.
  grpc::Status Park();

  // Sequences of all submaps read, over all calls.
  std::vector<int64_t> Received() const;
  std::vector<v1::UploadHeader> Headers() const;
  // Blobs that AcknowledgeEverything took, in their order.
  std::vector<std::string> Blobs() const;
  bool AwaitReceived(int count, absl::Duration timeout = absl::Seconds(20)) const;
  bool AwaitWatches(int count, absl::Duration timeout = absl::Seconds(20)) const;
  std::vector<v1::WatchGraphRequest> Watches() const;

 private:
  grpc::Status UploadSubmaps(grpc::ServerContext* context, Upload::Stream* stream) override;
  grpc::Status WatchGraph(grpc::ServerContext* context, const v1::WatchGraphRequest* request,
                          grpc::ServerWriter<v1::WatchGraphResponse>* stream) override;
  grpc::Status AddLoopClosures(grpc::ServerContext* context,
                               const v1::AddLoopClosuresRequest* request,
                               v1::AddLoopClosuresResponse* response) override;
  grpc::Status GetServerInfo(grpc::ServerContext* context, const v1::GetServerInfoRequest* request,
                             v1::GetServerInfoResponse* response) override;
  grpc::Status ReportStatus(grpc::ServerContext* context, const v1::ReportStatusRequest* request,
                            v1::ReportStatusResponse* response) override;

  const Script script_;
  mutable absl::Mutex mutex_;
  std::vector<v1::UploadHeader> headers_ ABSL_GUARDED_BY(mutex_);
  std::vector<int64_t> received_ ABSL_GUARDED_BY(mutex_);
  std::vector<std::string> blobs_ ABSL_GUARDED_BY(mutex_);
  std::vector<v1::WatchGraphRequest> watches_ ABSL_GUARDED_BY(mutex_);
  int report_calls_ ABSL_GUARDED_BY(mutex_) = 0;
  int closure_calls_ ABSL_GUARDED_BY(mutex_) = 0;
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
  int port_ = 0;
  std::unique_ptr<grpc::Server> server_;
};

// Accepts TCP connections in the kernel and never says a word: a half-open link.
class SilentSocket {
 public:
  SilentSocket();
  ~SilentSocket();
  std::string address() const;

 private:
  int socket_ = -1;
  int port_ = 0;
};

}  // namespace overtone

#endif  // OVERTONE_TESTS_SUPPORT_SCRIPTED_MAPPING_SERVER_H_
