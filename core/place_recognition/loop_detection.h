// SPDX-License-Identifier: Apache-2.0
// The seam between what sensors give and the map. Point clouds go this way; visual submaps
// (keypoint descriptors with 3-D points) will be one more view, one more proposer and one more
// verifier.
#ifndef OVERTONE_CORE_PLACE_RECOGNITION_LOOP_DETECTION_H_
#define OVERTONE_CORE_PLACE_RECOGNITION_LOOP_DETECTION_H_

#include <memory>
#include <optional>
#include <vector>

#include "absl/status/status.h"
#include "overtone/core/common/ids.h"
#include "overtone/core/graph/point_cloud.h"
#include "overtone/core/place_recognition/loop_candidate.h"

namespace overtone {

// What was seen from around a keyframe.
struct PlaceView {
  NodeId node;
  double travelled_m = 0;                   // along its mission by odometry
  Eigen::Quaterniond mission_from_body;     // odometry's
  std::shared_ptr<const PointCloud> cloud;  // in the keyframe's body frame
  bool single_scan = false;                 // nothing was gathered around it
};

// Finds places that look alike. Not thread-safe.
class LoopProposer {
 public:
  virtual ~LoopProposer() = default;

  // Keeps the view, and gives the places before it that look like it: best first, distinct, above
  // the threshold, with a guess of the relative pose. `from` is the earlier place.
  virtual std::vector<LoopCandidate> Propose(const PlaceView& view) = 0;

  // Keeps the view only.
  virtual void Keep(const PlaceView& view) = 0;

  // The most similar other place, above the threshold or not. Absent: the node was never seen, or
  // there is nothing to compare it with.
  virtual std::optional<LoopCandidate> MostSimilar(const NodeId& node) const = 0;
};

// Measures a candidate's relative pose. Thread-safe.
class LoopVerifier {
 public:
  virtual ~LoopVerifier() = default;

  // Fills in measured, from_tform_to, covariance and figures of `candidate` from its guess. Not ok:
  // the views cannot be compared; the candidate stays as it is.
  virtual absl::Status Verify(const PlaceView& from, const PlaceView& to,
                              LoopCandidate& candidate) const = 0;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_PLACE_RECOGNITION_LOOP_DETECTION_H_
