// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_CLIENT_INTERNAL_UPLOAD_SUBMAPS_STREAM_H_
#define OVERTONE_CLIENT_INTERNAL_UPLOAD_SUBMAPS_STREAM_H_

#include <utility>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "overtone/client/internal/client_stream.h"
#include "overtone/v1/mapping_service.grpc.pb.h"

namespace overtone {

// One UploadSubmaps call; threads and life as in ClientStream.
class UploadSubmapsStream final
    : public ClientStream<
          grpc::ClientBidiReactor<v1::UploadSubmapsRequest, v1::UploadSubmapsResponse>,
          v1::UploadSubmapsResponse> {
 public:
  using ClientStream::ClientStream;

  // False while a write is under way: gRPC allows one at a time.
  bool CanWrite() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex()) { return !writing_; }

  // Only when CanWrite(), or before Start().
  void Write(v1::UploadSubmapsRequest request) ABSL_LOCKS_EXCLUDED(mutex()) {
    request_ = std::move(request);
    {
      absl::MutexLock lock(mutex());
      writing_ = true;
    }
    StartWrite(&request_);
  }

 private:
  // A failed write needs no care of its own: then the stream is broken, and the read under way
  // fails too.
  void OnWriteDone(bool /*ok*/) override {
    absl::MutexLock lock(mutex());
    writing_ = false;
  }

  v1::UploadSubmapsRequest request_;  // gRPC's while writing_
  bool writing_ ABSL_GUARDED_BY(mutex()) = false;
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_UPLOAD_SUBMAPS_STREAM_H_
