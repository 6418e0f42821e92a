// SPDX-License-Identifier: Apache-2.0
// Observations and candidates as JSON, for a robot's recording. Clouds are named, not held: their
// points must be in files.
#ifndef OVERTONE_CLIENT_CLI_OBSERVATION_CODEC_H_
#define OVERTONE_CLIENT_CLI_OBSERVATION_CODEC_H_

#include "overtone/client/cli/json_codec.h"
#include "overtone/client/cli/observations.h"

namespace overtone {

// {"clouds": [{"index", "file"}], "landmark_sightings": [{"index", "landmark", "point_in_body",
// "covariance"}], "robot_sightings": [{"index", "robot", ...}], "absolute_poses": [{"index",
// "map_tform_body", "covariance"}]}
Json ToJson(const Observations& observations);
Json ToJson(const ScoredCandidate& candidate);  // {"from", "to", "score"}

// These throw for what does not fit: call them inside Decode. Lists that are not there are empty.
Observations ObservationsFromJson(const Json& json);
ScoredCandidate ScoredCandidateFromJson(const Json& json);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_OBSERVATION_CODEC_H_
