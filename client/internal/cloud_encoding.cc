// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/cloud_encoding.h"

#include <memory>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/proto/conversion/field_path.h"
#include "overtone/proto/conversion/limits.h"
#include "overtone/proto/conversion/sha256.h"

namespace overtone {

absl::Status AnnounceClouds(const Submap& submap, v1::Submap& message) {
  const int count = static_cast<int>(submap.clouds.size());
  if (count > limits::kMaxCloudsPerSubmap) {
    return InvalidField("clouds", absl::StrCat(count, " of them, at most 2000"));
  }
  for (int i = 0; i < count; ++i) {
    if (submap.clouds[i].cloud == nullptr) {
      return InvalidField(absl::StrCat("clouds[", i, "].cloud"), "null");
    }
    message.mutable_clouds(i)->set_sha256(std::string(limits::kSha256Bytes, '\0'));
    message.mutable_clouds(i)->set_encoded_bytes(limits::kMaxBlobBytes);
  }
  return absl::OkStatus();
}

EncodedClouds EncodeClouds(const std::vector<KeyframeCloud>& clouds,
                           const CloudCodecOptions& options, v1::Submap& message) {
  EncodedClouds encoded;
  int kept = 0;
  for (int i = 0; i < clouds.size(); ++i) {
    absl::StatusOr<std::string> bytes =
        AtField("clouds", i, EncodePointCloud(*clouds[i].cloud, options));
    if (bytes.ok() && bytes->size() > limits::kMaxBlobBytes) {
      bytes = InvalidField(absl::StrCat("clouds[", i, "]"), "above 16 MiB when encoded");
    }
    if (!bytes.ok()) {
      encoded.failures.push_back(bytes.status());
      continue;
    }
    v1::CloudReference& reference = *message.mutable_clouds(kept++);
    reference.set_index(clouds[i].index);
    reference.set_sha256(Sha256(*bytes));
    reference.set_encoded_bytes(static_cast<int64_t>(bytes->size()));
    encoded.blobs.push_back({message.sequence(), reference.sha256(),
                             std::make_shared<const std::string>(*std::move(bytes))});
  }
  message.mutable_clouds()->DeleteSubrange(kept, message.clouds_size() - kept);
  return encoded;
}

}  // namespace overtone
