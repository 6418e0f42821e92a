// SPDX-License-Identifier: Apache-2.0
// Streams end themselves before their connection does, and so cleanly: gRPC tells nobody that a
// connection has said GOAWAY, and cuts what is left of it when its grace period is over.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_RPC_STREAM_AGE_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_RPC_STREAM_AGE_H_

#include <chrono>
#include <memory>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "grpcpp/alarm.h"
#include "overtone/proto/conversion/status_conversion.h"

namespace overtone {

class StreamAge {
 public:
  // Calls stream->Drain(UNAVAILABLE, to be tried again at once) after `max_age`, on a thread of
  // gRPC's; 0: never. To be called once.
  template <typename Stream>
  void Start(absl::Duration max_age, std::weak_ptr<Stream> stream) {
    if (max_age == absl::ZeroDuration()) return;
    alarm_.Set(std::chrono::system_clock::now() + absl::ToChronoMicroseconds(max_age),
               [stream = std::move(stream)](bool due) {
                 const std::shared_ptr<Stream> open = stream.lock();
                 if (due && open != nullptr) open->Drain(Over());
               });
  }

  void Stop() { alarm_.Cancel(); }

 private:
  static absl::Status Over() {
    return WithRetryDelay(absl::UnavailableError("the stream has reached its age; open another"),
                          absl::ZeroDuration());
  }

  grpc::Alarm alarm_;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_RPC_STREAM_AGE_H_
