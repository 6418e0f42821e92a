// SPDX-License-Identifier: Apache-2.0
// What the server itself writes into a map's log (storage/v1/map_log.proto). The map is a function
// of its log: submaps, closures and findings in the order in which they were stored, which is the
// order in which it takes them.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_MAP_LOG_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_MAP_LOG_H_

#include <string>
#include <variant>
#include <vector>

#include "absl/status/statusor.h"
#include "overtone/core/graph/submap.h"
#include "overtone/core/mapping/map_checkpoint.h"
#include "overtone/core/place_recognition/loop_candidate.h"
#include "overtone/services/mapping_server/loop_detector.h"
#include "overtone/services/mapping_server/submap_store.h"
#include "overtone/storage/v1/map_log.pb.h"

namespace overtone {

// In this order: what a search found at a keyframe; a robot's scored pair as it is; one that was
// measured; what operators decided; a motion measured by clouds.
using Finding =
    std::variant<SearchResult, ScoredCandidate, LoopCandidate, MapDecisions, RefinedMotion>;

FindingRecord ToRecord(const Finding& finding);
// DataLoss: ToRecord did not make it.
absl::StatusOr<Finding> ParseFinding(const std::string& bytes);

void ToStorage(const MapDecisions& decisions,
               google::protobuf::RepeatedPtrField<storage::v1::Decision>* messages);
std::vector<MapDecisions::Decision> FromStorage(
    const google::protobuf::RepeatedPtrField<storage::v1::Decision>& messages);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_MAP_LOG_H_
