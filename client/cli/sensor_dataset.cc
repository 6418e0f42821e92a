// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/sensor_dataset.h"

#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/client/cli/carmen_recording.h"
#include "overtone/client/cli/mrclam_recording.h"
#include "overtone/client/cli/pcd_recording.h"
#include "overtone/client/cli/tuc_recording.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

absl::StatusOr<std::vector<Recording>> ReadPath(DatasetKind kind, const std::string& path,
                                                const SensorDatasetFiles& files) {
  if (kind == DatasetKind::kMrclam) return ReadMrclamRecordings(path);
  if (kind == DatasetKind::kPcd) return ReadPcdRecordings(path);
  ASSIGN_OR_RETURN(Recording recording,
                   kind == DatasetKind::kCarmen
                       ? ReadCarmenRecording(path, files.reference, files.relations)
                       : ReadTucRecording(path, files.min_candidate_score));
  return std::vector<Recording>{std::move(recording)};
}

}  // namespace

bool IsSensorDataset(DatasetKind kind) {
  return kind == DatasetKind::kMrclam || kind == DatasetKind::kPcd ||
         kind == DatasetKind::kCarmen || kind == DatasetKind::kTuc;
}

absl::StatusOr<std::vector<Recording>> ReadSensorDataset(DatasetKind kind,
                                                         const SensorDatasetFiles& files) {
  if (files.paths.empty()) {
    return absl::InvalidArgumentError("this dataset needs the path of its folder or log");
  }
  if (files.paths.size() > 1 && kind != DatasetKind::kPcd) {
    return absl::InvalidArgumentError("only --dataset pcd takes more than one path");
  }
  std::vector<Recording> recordings;
  std::set<MissionId> ids;
  for (const std::string& path : files.paths) {
    ASSIGN_OR_RETURN(std::vector<Recording> some, ReadPath(kind, path, files));
    for (Recording& recording : some) {
      if (!ids.insert(recording.id).second) {
        return absl::InvalidArgumentError(
            absl::StrCat(path, ": a second robot named ", recording.name));
      }
      recordings.push_back(std::move(recording));
    }
  }
  return recordings;
}

}  // namespace overtone
