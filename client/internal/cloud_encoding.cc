// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/cloud_encoding.h"

#include <memory>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/field_path.h"
#include "overtone/proto/conversion/limits.h"
#include "overtone/proto/conversion/sha256.h"

namespace overtone {

absl::StatusOr<std::vector<WaitingBlob>> EncodeClouds(const Submap& submap,
                                                      const CloudCodecOptions& options,
                                                      v1::Submap& message) {
  const int count = static_cast<int>(submap.clouds.size());
  if (count > limits::kMaxCloudsPerSubmap) {
    return InvalidField("clouds", absl::StrCat(count, " of them, at most 2000"));
  }
  std::vector<WaitingBlob> blobs;
  for (int i = 0; i < count; ++i) {
    const std::shared_ptr<const PointCloud>& cloud = submap.clouds[i].cloud;
    if (cloud == nullptr) return InvalidField(absl::StrCat("clouds[", i, "].cloud"), "null");
    ASSIGN_OR_RETURN(std::string bytes, AtField("clouds", i, EncodePointCloud(*cloud, options)));
    WaitingBlob blob;
    blob.sequence = submap.sequence;
    blob.sha256 = Sha256(bytes);
    message.mutable_clouds(i)->set_sha256(blob.sha256);
    message.mutable_clouds(i)->set_encoded_bytes(static_cast<int64_t>(bytes.size()));
    blob.bytes = std::make_shared<const std::string>(std::move(bytes));
    blobs.push_back(std::move(blob));
  }
  return blobs;
}

}  // namespace overtone
