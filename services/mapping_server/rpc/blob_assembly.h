// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_RPC_BLOB_ASSEMBLY_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_RPC_BLOB_ASSEMBLY_H_

#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "absl/types/optional.h"
#include "overtone/services/mapping_server/submap_store.h"
#include "overtone/v1/mapping_service.pb.h"

namespace overtone {

// Puts the blobs of one stream together, one at a time, and checks them. Holds at most
// max_blob_bytes. Not thread-safe.
class BlobAssembly {
 public:
  explicit BlobAssembly(int64_t max_blob_bytes) : max_blob_bytes_(max_blob_bytes) {}

  // How a blob ended. Ok: `blob` has the digest that it is named by, and is a cloud.
  // InvalidArgument: it is not, its chunks do not fit together, or it is too large. NotFound: gone.
  // FailedPrecondition: not wanted.
  struct Outcome {
    std::string sha256;
    absl::Status status;
    SharedBlob blob;
  };

  // `wanted_bytes`: the size of the blob that the chunk is of; nullopt: it is not wanted. No
  // outcome: more has to come, or this is the rest of a blob that had its outcome.
  absl::optional<Outcome> Take(const v1::BlobChunk& chunk, absl::optional<int64_t> wanted_bytes);

 private:
  absl::Status Append(const v1::BlobChunk& chunk, absl::optional<int64_t> wanted_bytes);
  absl::Status CheckComplete() const;

  const int64_t max_blob_bytes_;
  std::string sha256_;
  std::string blob_;
  bool had_outcome_ = false;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_RPC_BLOB_ASSEMBLY_H_
