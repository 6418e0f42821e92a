// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_TESTS_SUPPORT_HEALTH_WATCH_H_
#define OVERTONE_TESTS_SUPPORT_HEALTH_WATCH_H_

#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "grpcpp/create_channel.h"
#include "grpcpp/generic/generic_stub.h"
#include "grpcpp/security/credentials.h"

namespace overtone {

// grpc.health.v1.Health/Watch of one service, in raw bytes: Debian ships no stubs of it. For one
// thread.
class HealthWatch {
 public:
  enum class Status { kUnknown = 0, kServing = 1, kNotServing = 2, kServiceUnknown = 3, kEnded };

  // `service`: at most 127 bytes.
  HealthWatch(const std::string& address, const std::string& service)
      : stub_(grpc::CreateChannel(address, grpc::InsecureChannelCredentials())) {
    call_ = stub_.PrepareCall(&context_, "/grpc.health.v1.Health/Watch", &queue_);
    call_->StartCall(this);
    if (!Done()) return;
    // HealthCheckRequest{service}
    const grpc::Slice bytes(
        absl::StrCat("\x0a", std::string(1, static_cast<char>(service.size())), service));
    call_->Write(grpc::ByteBuffer(&bytes, 1), this);
    open_ = Done();
  }

  ~HealthWatch() {
    context_.TryCancel();
    void* tag = nullptr;
    bool ok = false;
    if (reading_) queue_.Next(&tag, &ok);
    grpc::Status status;
    call_->Finish(&status, this);
    queue_.Next(&tag, &ok);
    queue_.Shutdown();
    while (queue_.Next(&tag, &ok)) {
    }
  }

  // The next that the server says. kEnded: the stream has ended, or nothing came within `timeout`.
  Status Next(absl::Duration timeout) {
    if (!open_) return Status::kEnded;
    call_->Read(&message_, this);
    reading_ = true;
    if (!Done(timeout)) return Status::kEnded;
    grpc::Slice bytes;
    if (!message_.DumpToSingleSlice(&bytes).ok()) return Status::kEnded;
    // HealthCheckResponse{status}; 0 is left out.
    return bytes.size() < 2 ? Status::kUnknown : static_cast<Status>(bytes.begin()[1]);
  }

 private:
  bool Done(absl::Duration timeout = absl::Seconds(20)) {
    void* tag = nullptr;
    bool ok = false;
    const auto next = queue_.AsyncNext(&tag, &ok, absl::ToChronoTime(absl::Now() + timeout));
    if (next == grpc::CompletionQueue::GOT_EVENT) reading_ = false;
    open_ = next == grpc::CompletionQueue::GOT_EVENT && ok;
    return open_;
  }

  grpc::CompletionQueue queue_;
  grpc::ClientContext context_;
  grpc::GenericStub stub_;
  std::unique_ptr<grpc::GenericClientAsyncReaderWriter> call_;
  grpc::ByteBuffer message_;
  bool open_ = false;
  bool reading_ = false;
};

}  // namespace overtone

#endif  // OVERTONE_TESTS_SUPPORT_HEALTH_WATCH_H_
