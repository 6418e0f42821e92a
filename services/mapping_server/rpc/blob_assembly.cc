// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/rpc/blob_assembly.h"

#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/graph/point_cloud_codec.h"
#include "overtone/proto/conversion/field_path.h"
#include "overtone/proto/conversion/limits.h"
#include "overtone/proto/conversion/sha256.h"

namespace overtone {

absl::optional<BlobAssembly::Outcome> BlobAssembly::Take(const v1::BlobChunk& chunk,
                                                         absl::optional<int64_t> wanted_bytes) {
  const bool begins = chunk.offset() == 0;
  if (!begins && had_outcome_ && chunk.sha256() == sha256_) return absl::nullopt;
  if (begins || chunk.sha256() != sha256_) {
    sha256_ = chunk.sha256();
    blob_.clear();
    had_outcome_ = false;
  }
  absl::Status status = Append(chunk, wanted_bytes);
  if (status.ok()) {
    if (static_cast<int64_t>(blob_.size()) < *wanted_bytes) return absl::nullopt;
    status = CheckComplete();
  }
  had_outcome_ = true;
  std::string blob = std::exchange(blob_, {});
  if (!status.ok()) return Outcome{sha256_, std::move(status), nullptr};
  return Outcome{sha256_, std::move(status), std::make_shared<const std::string>(std::move(blob))};
}

absl::Status BlobAssembly::Append(const v1::BlobChunk& chunk,
                                  absl::optional<int64_t> wanted_bytes) {
  if (!wanted_bytes.has_value()) return absl::FailedPreconditionError("blob.sha256: not wanted");
  if (chunk.gone()) return absl::NotFoundError("blob.gone: its robot no longer has it");
  if (*wanted_bytes > max_blob_bytes_) {
    return InvalidField("blob", absl::StrCat(*wanted_bytes, " bytes, the server takes ",
                                             max_blob_bytes_, " at most"));
  }
  const int64_t size = static_cast<int64_t>(chunk.data().size());
  if (size > limits::kMaxBlobChunkBytes) {
    return InvalidField("blob.data", absl::StrCat(size, " bytes, at most 512 KiB"));
  }
  if (chunk.offset() != static_cast<int64_t>(blob_.size())) {
    return InvalidField("blob.offset", absl::StrCat(chunk.offset(), ", expected ", blob_.size()));
  }
  if (chunk.offset() + size > *wanted_bytes) {
    return InvalidField(
        "blob.data", absl::StrCat("more than the ", *wanted_bytes, " bytes that its submap says"));
  }
  blob_ += chunk.data();
  return absl::OkStatus();
}

absl::Status BlobAssembly::CheckComplete() const {
  if (Sha256(blob_) != sha256_) return InvalidField("blob.sha256", "not the data's digest");
  return AtField("blob.data", DecodePointCloud(blob_).status());
}

}  // namespace overtone
