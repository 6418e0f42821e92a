// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_CLIENT_INTERNAL_CLOUD_ENCODING_H_
#define OVERTONE_CLIENT_INTERNAL_CLOUD_ENCODING_H_

#include <vector>

#include "absl/status/status.h"
#include "overtone/client/internal/submap_outbox.h"
#include "overtone/core/graph/point_cloud_codec.h"
#include "overtone/core/graph/submap.h"
#include "overtone/v1/submap.pb.h"

namespace overtone {

// What can be said of the submap's clouds before they are encoded. `message` is ToProto(submap);
// its references get stand-ins for what names the blobs, no shorter than that will be, so that it
// can be checked. InvalidArgument naming the field: a cloud is missing, or there are too many.
absl::Status AnnounceClouds(const Submap& submap, v1::Submap& message);

struct EncodedClouds {
  std::vector<WaitingBlob> blobs;
  std::vector<absl::Status> failures;  // of clouds that cannot be encoded, naming the field
};

// The clouds as they go over the wire. `message` refers to each of them in this order; its
// references get what names the blobs, and those to clouds that cannot be encoded go.
EncodedClouds EncodeClouds(const std::vector<KeyframeCloud>& clouds,
                           const CloudCodecOptions& options, v1::Submap& message);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_CLOUD_ENCODING_H_
