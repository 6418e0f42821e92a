// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_CLIENT_INTERNAL_CLOUD_ENCODING_H_
#define OVERTONE_CLIENT_INTERNAL_CLOUD_ENCODING_H_

#include <vector>

#include "absl/status/statusor.h"
#include "overtone/client/internal/blob_queue.h"
#include "overtone/core/graph/point_cloud_codec.h"
#include "overtone/core/graph/submap.h"
#include "overtone/v1/submap.pb.h"

namespace overtone {

// The submap's clouds as they go over the wire. `message` is ToProto(submap); its references get
// what names the blobs. InvalidArgument naming the field: a cloud is missing or cannot be encoded.
absl::StatusOr<std::vector<WaitingBlob>> EncodeClouds(const Submap& submap,
                                                      const CloudCodecOptions& options,
                                                      v1::Submap& message);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_CLOUD_ENCODING_H_
