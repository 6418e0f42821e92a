// SPDX-License-Identifier: Apache-2.0
// What the server says on an upload stream.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_RPC_UPLOAD_FRAMES_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_RPC_UPLOAD_FRAMES_H_

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "overtone/proto/conversion/status_conversion.h"
#include "overtone/services/mapping_server/submap_store.h"
#include "overtone/v1/mapping_service.pb.h"

namespace overtone {

inline v1::UploadSubmapsResponse ReadyFrame(int64_t next_sequence, int64_t window_bytes) {
  v1::UploadSubmapsResponse response;
  response.mutable_ready()->set_next_sequence(next_sequence);
  response.mutable_ready()->set_window_bytes(window_bytes);
  return response;
}

inline v1::UploadSubmapsResponse AckFrame(int64_t durable_through_sequence) {
  v1::UploadSubmapsResponse response;
  response.mutable_ack()->set_durable_through_sequence(durable_through_sequence);
  return response;
}

inline v1::UploadSubmapsResponse RejectFrame(int64_t sequence, const absl::Status& status,
                                             int64_t expected_sequence) {
  v1::UploadSubmapsResponse response;
  v1::UploadReject& reject = *response.mutable_reject();
  reject.set_sequence(sequence);
  reject.set_code(static_cast<int>(status.code()));
  reject.set_message(HeaderSafe(status.message()));
  reject.set_expected_sequence(expected_sequence);
  return response;
}

// Empty: nothing is lacking.
inline v1::UploadSubmapsResponse WantFrame(const std::vector<MissingBlob>& blobs) {
  v1::UploadSubmapsResponse response;
  response.mutable_want();
  for (const MissingBlob& blob : blobs) response.mutable_want()->add_sha256(blob.sha256);
  return response;
}

inline v1::UploadSubmapsResponse BlobResultFrame(const std::string& sha256,
                                                 const absl::Status& status) {
  v1::UploadSubmapsResponse response;
  v1::UploadBlobResult& result = *response.mutable_blob_result();
  result.set_sha256(sha256);
  result.set_code(static_cast<int>(status.code()));
  result.set_message(HeaderSafe(status.message()));
  return response;
}

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_RPC_UPLOAD_FRAMES_H_
