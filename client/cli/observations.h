// SPDX-License-Identifier: Apache-2.0
// What a robot's sensors saw besides its own motion, on its way from a recording to submaps.
#ifndef OVERTONE_CLIENT_CLI_OBSERVATIONS_H_
#define OVERTONE_CLIENT_CLI_OBSERVATIONS_H_

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "overtone/core/graph/submap.h"

namespace overtone {

// Points in the body frame at `index`: in a file until they are needed, so that a recording of any
// length fits into memory, or in memory when they are few.
struct RecordedCloud {
  int64_t index = 0;
  std::string path;                         // a PCD or PLY file; empty: `cloud` has the points
  std::shared_ptr<const PointCloud> cloud;  // null: `path` has them
};

// In a Recording every `index` is a frame number of its source, in a RobotPlan and in what a robot
// plays it is a keyframe.
struct Observations {
  std::vector<RecordedCloud> clouds;
  std::vector<LandmarkSighting> landmark_sightings;
  std::vector<RobotSighting> robot_sightings;
  std::vector<AbsolutePose> absolute_poses;
};

// Those whose index `place` knows, under the index that it gives.
Observations Placed(const Observations& observations,
                    const std::function<std::optional<int64_t>(int64_t)>& place);

// Writes the clouds in memory to <folder>/NNNNNN.pcd, N the index, and lets go of their points.
absl::Status WriteClouds(const std::string& folder, Observations* observations);

// Those with an index in [begin, end), into a submap; reads its clouds. Clouds without points stay
// out. NotFound, InvalidArgument: a cloud's file.
absl::Status AddObservations(const Observations& observations, int64_t begin, int64_t end,
                             Submap* submap);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_OBSERVATIONS_H_
