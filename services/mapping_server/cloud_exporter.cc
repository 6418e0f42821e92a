// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/cloud_exporter.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {

absl::StatusOr<CloudExporter::NextChunk> CloudExporter::Make(const CloudExport& request,
                                                             const std::function<bool()>& wanted) {
  const int64_t left = max_points_ - *in_hand_;
  if (request.max_points > left) {
    return absl::ResourceExhaustedError(
        absl::StrCat("max_points: ", request.max_points, " is more than the ", left,
                     " that exports which are being sent leave; try again, or ask for fewer"));
  }
  ASSIGN_OR_RETURN(MergedCloud cloud, MergeClouds(*registry_, request, wanted));
  const auto points = static_cast<int64_t>(cloud.points.voxels().size());
  *in_hand_ += points;
  const std::shared_ptr<PlyFile> file(new PlyFile(std::move(cloud)),
                                      [in_hand = in_hand_, points](const PlyFile* gone) {
                                        delete gone;
                                        *in_hand -= points;
                                      });
  return NextChunk([file] { return file->Next(); });
}

void CloudExporter::Start(const v1::ExportMapRequest& request, std::function<bool()> wanted,
                          Done done) {
  const absl::StatusOr<CloudExport> read = ReadCloudExport(request);
  if (!read.ok()) return done(read.status());
  thread_.Post([this, request = *read, wanted = std::move(wanted), done = std::move(done)] {
    done(Make(request, wanted));
  });
}

}  // namespace overtone
