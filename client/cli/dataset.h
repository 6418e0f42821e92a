// SPDX-License-Identifier: Apache-2.0
// The recordings a replay plays: odometry, and where there is one the ground truth, in the
// publishers' own formats.
#ifndef OVERTONE_CLIENT_CLI_DATASET_H_
#define OVERTONE_CLIENT_CLI_DATASET_H_

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "overtone/client/cli/motion_noise.h"
#include "overtone/client/cli/observations.h"
#include "overtone/core/common/ids.h"
#include "overtone/core/geometry/trajectory.h"
#include "overtone/core/graph/node_selection.h"

namespace overtone {

enum class DatasetKind {
  kExample,
  kEuroc,
  kMulran,
  kKitti,
  kTum,
  kG2o,
  // These come with what the sensors saw (sensor_dataset.h).
  kMrclam,
  kPcd,
  kCarmen,
  kTuc,
};

// What suits a kind of data when the user says nothing.
struct DatasetDefaults {
  KeyframeSelectionOptions keyframes;
  MotionNoise noise;
  // The ground truths of all robots are in one frame, so that measurements between robots can be
  // made from them.
  bool ground_truth_shared = false;
};
DatasetDefaults DefaultsOf(DatasetKind kind);

// "NAME:odometry[:ground_truth]".
struct RobotSource {
  std::string name;
  std::string odometry_path;
  std::string ground_truth_path;  // empty: none
};
absl::StatusOr<RobotSource> ParseRobotSource(absl::string_view text);

// The id a robot uploads under: its name in lower case, mission "run". InvalidArgument naming the
// name when that breaks the id rule.
absl::StatusOr<MissionId> MissionOf(absl::string_view name);

// A relative pose between two poses of the recordings, by their source's own frame numbers.
struct FrameClosure {
  int64_t from_frame = 0;
  int64_t to_frame = 0;
  Rigid3d from_tform_to;
  Matrix6d covariance = Matrix6d::Identity();
};

// Two frames that look alike to the robot's front end.
struct FrameCandidate {
  int64_t from_frame = 0;
  int64_t to_frame = 0;
  double score = 0;  // [0, 1]
};

struct Recording {
  std::string name;
  MissionId id;
  Trajectory odometry;  // mission_from_body
  std::vector<int64_t>
      frames;  // of each odometry pose: row or vertex number in its source, increasing
  std::vector<Matrix6d>
      motion_covariances;   // of the motion into each pose; empty: the noise model tells
  Trajectory ground_truth;  // world_from_body; empty: none
  bool ground_truth_positions_only = false;  // its rotations say nothing
  // Takes this robot's world to the one all robots share; absent: nobody knows how they lie.
  std::optional<Rigid3d> common_from_world;
  std::vector<FrameClosure> closures;  // that came with the odometry (g2o)
  std::vector<FrameCandidate> candidates;
  Observations observations;    // by frame
  std::set<int64_t> keyframes;  // frames that become keyframes whatever the distance
  // Frames with a poorly observed motion into them, and its direction as in Keyframe.
  std::map<int64_t, Eigen::Vector3d> degenerate;
  std::vector<FrameClosure> relations;  // known to be true, for evaluation only
  std::string note;                     // what was left out in reading, for people
};

// Errors name the file and line.
absl::StatusOr<Recording> ReadRecording(DatasetKind kind, const RobotSource& source);

// "NAME:file" where file is a 3 x 4 matrix that takes NAME's world to the common one. Sets it in
// the recording of that name, and the identity in those without one. InvalidArgument: no such
// robot.
absl::Status ApplyAlignments(const std::vector<std::string>& alignments,
                             std::vector<Recording>* recordings);

// Cuts one run into `parts` that each share the fraction `overlap` of their length with the next,
// as if several robots had driven them: NAME_0, NAME_1, ... Every part's odometry begins at the
// identity; frames keep their numbers. InvalidArgument: parts < 2, overlap outside [0, 0.9], a part
// shorter than 10 poses.
absl::StatusOr<std::vector<Recording>> SplitRecording(const Recording& recording, int parts,
                                                      double overlap);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_DATASET_H_
