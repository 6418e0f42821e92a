// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/cloud_exporter.h"

#include <utility>

#include "absl/strings/str_cat.h"

namespace overtone {

absl::StatusOr<std::shared_ptr<void>> CloudExporter::Reserve(int64_t points) {
  std::shared_ptr<void> reserved(
      nullptr, [in_hand = in_hand_, points](void*) { in_hand->fetch_sub(points); });
  if (in_hand_->fetch_add(points) + points > kMaxPointsInHand) {
    return absl::ResourceExhaustedError(
        absl::StrCat("max_points: ", points, " more than the exports under way leave of ",
                     kMaxPointsInHand, "; try again when they are done, or ask for fewer"));
  }
  return reserved;
}

void CloudExporter::Start(const v1::ExportMapRequest& request, std::function<bool()> wanted,
                          Done done) {
  const absl::StatusOr<CloudExport> read = ReadCloudExport(request);
  if (!read.ok()) return done(read.status());
  const absl::StatusOr<std::shared_ptr<void>> reserved = Reserve(read->max_points);
  if (!reserved.ok()) return done(reserved.status());
  thread_.Post([this, request = *read, reserved = *reserved, wanted = std::move(wanted),
                done = std::move(done)] {
    absl::StatusOr<MergedCloud> cloud = MergeClouds(*registry_, request, wanted);
    if (!cloud.ok()) return done(cloud.status());
    const auto file = std::make_shared<PlyFile>(*std::move(cloud));
    done(NextChunk([file, reserved] { return file->Next(); }));
  });
}

}  // namespace overtone
