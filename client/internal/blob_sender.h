// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_CLIENT_INTERNAL_BLOB_SENDER_H_
#define OVERTONE_CLIENT_INTERNAL_BLOB_SENDER_H_

#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "absl/container/flat_hash_map.h"
#include "absl/status/status.h"
#include "overtone/client/internal/submap_outbox.h"
#include "overtone/proto/conversion/limits.h"
#include "overtone/v1/mapping_service.pb.h"

namespace overtone {

// Where one upload stream stands with the blobs of its clouds: what the server wants, in its order,
// chunk by chunk. What the server has or will never have leaves the outbox. Not thread-safe.
class BlobSender {
 public:
  // `outbox` outlives the sender.
  explicit BlobSender(SubmapOutbox* outbox) : outbox_(outbox) {}

  // `acknowledged_through`: the last submap that the server has acknowledged. Internal: it wants
  // more at once than there is reason to.
  absl::Status OnWant(const v1::UploadWant& want, int64_t acknowledged_through);
  // Internal: about a blob that it was not sent.
  absl::Status OnResult(const v1::UploadBlobResult& result);

  // The next chunk that may go out; none: nothing is wanted, or a quarter of the window is
  // unanswered (so little of it, because poses queue up behind what is under way), or the host
  // started over and may yet hand over what is wanted.
  std::optional<v1::UploadSubmapsRequest> Next(
      int64_t window_bytes, int64_t max_chunk_bytes = limits::kMaxBlobChunkBytes);

  int64_t bytes_in_flight() const { return in_flight_bytes_; }

 private:
  struct Sending {
    std::string sha256;
    SharedBytes bytes;
    size_t offset = 0;
  };

  v1::UploadSubmapsRequest NextChunk(int64_t max_chunk_bytes);
  v1::UploadSubmapsRequest Gone(const std::string& sha256);

  SubmapOutbox* const outbox_;
  std::deque<std::string> wanted_;
  std::optional<Sending> sending_;
  // Begun and not answered: bytes by digest; 0: gone.
  absl::flat_hash_map<std::string, int64_t> in_flight_;
  int64_t in_flight_bytes_ = 0;
  int64_t acknowledged_through_ = -1;   // sequence, with the last Want
  int64_t nothing_lacks_through_ = -1;  // sequence
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_BLOB_SENDER_H_
