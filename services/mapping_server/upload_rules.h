// SPDX-License-Identifier: Apache-2.0
// When a submap continues its mission. Pure, so that every store applies the same rules.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_UPLOAD_RULES_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_UPLOAD_RULES_H_

#include "absl/status/status.h"
#include "overtone/core/graph/submap.h"
#include "overtone/services/mapping_server/submap_store.h"

namespace overtone {

// `submap` is not stored yet and holds at least one keyframe. OutOfRange: not the next sequence.
// InvalidArgument: first_index or the first stamp does not continue the mission.
absl::Status CheckContinues(const UploadState& state, const Submap& submap);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_UPLOAD_RULES_H_
