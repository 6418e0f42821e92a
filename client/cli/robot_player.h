// SPDX-License-Identifier: Apache-2.0
// One robot: plays its recording through the real client library, step by step in data time.
#ifndef OVERTONE_CLIENT_CLI_ROBOT_PLAYER_H_
#define OVERTONE_CLIENT_CLI_ROBOT_PLAYER_H_

#include <cstdint>
#include <memory>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "overtone/client/cli/json_codec.h"
#include "overtone/client/cli/robot_recording_file.h"
#include "overtone/client/estimator/onboard_estimator.h"
#include "overtone/client/mapping_client.h"

namespace overtone {

// Not thread-safe.
class RobotPlayer {
 public:
  // options.mission is taken from the recording, and comparisons are made on request only.
  static absl::StatusOr<std::unique_ptr<RobotPlayer>> Create(RobotRecording recording,
                                                             MappingClientOptions options,
                                                             absl::Duration timeout);

  // Plays the keyframes up to data time `time_s` (since the first): into the onboard estimator and,
  // as submaps with what was seen from them and the closures and candidates that came to light
  // with them, up to the server; returns when all of it is acknowledged. Clouds are read when their
  // submap is due.
  // {"keyframes": so far, "closures": so far, "done": no keyframe left}
  absl::StatusOr<Json> Advance(double time_s);

  // Waits for a graph of at least `min_revision` that holds the newest keyframe, compares and
  // corrects. See ToJson in the source for the fields.
  absl::StatusOr<Json> Compare(uint64_t min_revision);

 private:
  RobotPlayer(RobotRecording recording, absl::Duration timeout);

  absl::Status GoOn();
  int64_t EndOfSubmap(int64_t begin, double time_s) const;
  absl::Status AddToEstimator(int64_t begin, int64_t end);
  absl::Status Upload(int64_t begin, int64_t end);
  absl::Status Hand(const Submap& submap);
  bool ComesToLight(const NodeId& from, const NodeId& to, int64_t begin, int64_t end) const;
  double TimeOf(int64_t index) const;

  RobotRecording recording_;
  absl::Duration timeout_;
  std::vector<int> load_;  // of what was seen from each keyframe, as kMaxLoadPerSubmap counts it
  int64_t next_index_ = 0;
  int64_t next_sequence_ = 0;
  int64_t closures_sent_ = 0;
  OnboardEstimator estimator_;
  std::unique_ptr<MappingClient> client_;  // after what it calls: ends first
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_ROBOT_PLAYER_H_
