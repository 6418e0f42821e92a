// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/observations.h"

#include <filesystem>
#include <utility>

#include "absl/strings/str_format.h"
#include "overtone/client/cli/output_files.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/graph/point_cloud_io.h"

namespace overtone {
namespace {

template <typename Observation>
std::vector<Observation> PlaceEach(const std::vector<Observation>& observations,
                                   const std::function<std::optional<int64_t>(int64_t)>& place) {
  std::vector<Observation> placed;
  for (const Observation& observation : observations) {
    const std::optional<int64_t> index = place(observation.index);
    if (!index.has_value()) continue;
    placed.push_back(observation);
    placed.back().index = *index;
  }
  return placed;
}

template <typename Observation>
void AddEach(const std::vector<Observation>& observations, int64_t begin, int64_t end,
             std::vector<Observation>* result) {
  for (const Observation& observation : observations) {
    if (observation.index >= begin && observation.index < end) result->push_back(observation);
  }
}

}  // namespace

Observations Placed(const Observations& observations,
                    const std::function<std::optional<int64_t>(int64_t)>& place) {
  return {PlaceEach(observations.clouds, place), PlaceEach(observations.landmark_sightings, place),
          PlaceEach(observations.robot_sightings, place),
          PlaceEach(observations.absolute_poses, place)};
}

absl::Status WriteClouds(const std::string& folder, Observations* observations) {
  for (RecordedCloud& recorded : observations->clouds) {
    if (recorded.cloud == nullptr) continue;
    RETURN_IF_ERROR(MakeFolder(folder));
    // Absolute: who reads it may run elsewhere.
    std::error_code error;
    recorded.path =
        std::filesystem::absolute(absl::StrFormat("%s/%06d.pcd", folder, recorded.index), error);
    RETURN_IF_ERROR(WritePcd(recorded.path, *recorded.cloud));
    recorded.cloud.reset();
  }
  return absl::OkStatus();
}

absl::Status AddObservations(const Observations& observations, int64_t begin, int64_t end,
                             Submap* submap) {
  std::vector<RecordedCloud> clouds;
  AddEach(observations.clouds, begin, end, &clouds);
  for (RecordedCloud& recorded : clouds) {
    if (recorded.cloud == nullptr) {
      ASSIGN_OR_RETURN(PointCloud cloud, ReadPointCloud(recorded.path));
      recorded.cloud = std::make_shared<const PointCloud>(std::move(cloud));
    }
    if (recorded.cloud->empty()) continue;
    KeyframeCloud cloud;
    cloud.index = recorded.index;
    cloud.cloud = std::move(recorded.cloud);
    submap->clouds.push_back(std::move(cloud));
  }
  AddEach(observations.landmark_sightings, begin, end, &submap->landmark_sightings);
  AddEach(observations.robot_sightings, begin, end, &submap->robot_sightings);
  AddEach(observations.absolute_poses, begin, end, &submap->absolute_poses);
  return absl::OkStatus();
}

}  // namespace overtone
