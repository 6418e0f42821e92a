// SPDX-License-Identifier: Apache-2.0
// A gRPC stream (callback API) turned into state that its owner's one thread can await and then
// handle in plain sequential code: gRPC's threads only set flags under the owner's mutex.
#ifndef OVERTONE_CLIENT_INTERNAL_CLIENT_STREAM_H_
#define OVERTONE_CLIENT_INTERNAL_CLIENT_STREAM_H_

#include <utility>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "grpcpp/client_context.h"
#include "grpcpp/support/client_callback.h"
#include "grpcpp/support/status.h"

namespace overtone {

// Reactor: grpc::ClientReadReactor<Response> or grpc::ClientBidiReactor<Request, Response>.
// Life: construct; bind it with stub->async()->Rpc(&stream.context(), ..., &stream); Start();
// Take() whenever HasMessage(); Finish(), always, before it is destroyed. At most one message is
// held: the rest waits in HTTP/2's flow control.
template <typename Reactor, typename Response>
class ClientStream : public Reactor {
 public:
  // `mutex` guards the stream's state and outlives it.
  explicit ClientStream(absl::Mutex* mutex) : mutex_(mutex) {
    // A server that is away is waited for: only the channel's own backoff then decides when the
    // call goes out.
    context_.set_wait_for_ready(true);
  }

  grpc::ClientContext& context() { return context_; }

  void Start() {
    this->AddHold();  // operations are started from the owner's thread until Finish()
    this->StartRead(&message_);
    this->StartCall();
  }

  bool HasMessage() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return has_message_; }
  // Nothing more comes; Finish() tells why.
  bool Ended() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return ended_; }

  // Only when HasMessage().
  Response Take() ABSL_LOCKS_EXCLUDED(mutex_) {
    Response message = std::move(message_);
    message_.Clear();
    {
      absl::MutexLock lock(mutex_);
      has_message_ = false;
    }
    this->StartRead(&message_);
    return message;
  }

  // Cancels the call unless it has ended, and waits until gRPC has let go of this object: no
  // network round trip.
  grpc::Status Finish() ABSL_LOCKS_EXCLUDED(mutex_) {
    bool ended = false;
    {
      absl::MutexLock lock(mutex_);
      ended = ended_;
    }
    if (!ended) context_.TryCancel();
    this->RemoveHold();
    absl::MutexLock lock(mutex_);
    mutex_->Await(absl::Condition(&done_));
    return status_;
  }

 protected:
  absl::Mutex* mutex() const { return mutex_; }

 private:
  void OnReadDone(bool ok) override {
    absl::MutexLock lock(mutex_);
    has_message_ = ok;
    ended_ = !ok;
  }

  void OnDone(const grpc::Status& status) override {
    absl::MutexLock lock(mutex_);
    status_ = status;
    ended_ = true;
    done_ =
        true;  // the last touch: the owner may destroy this object as soon as the lock is released
  }

  absl::Mutex* const mutex_;
  grpc::ClientContext context_;
  Response message_;  // gRPC's between StartRead and OnReadDone, the owner's while has_message_
  bool has_message_ ABSL_GUARDED_BY(mutex_) = false;
  bool ended_ ABSL_GUARDED_BY(mutex_) = false;
  bool done_ ABSL_GUARDED_BY(mutex_) = false;
  grpc::Status status_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_CLIENT_STREAM_H_
