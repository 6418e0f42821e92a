// SPDX-License-Identifier: Apache-2.0
// What is done to a map's store while it is closed.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_STORE_REPLACEMENT_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_STORE_REPLACEMENT_H_

#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "overtone/core/common/ids.h"
#include "overtone/services/mapping_server/server_options.h"

namespace overtone {

// Moves the store `from`, synced, to `to`, in the place of what may be there; whoever loses power
// finds either the one or the other. Both on one file system. ResourceExhausted: the disk fails;
// then what was there is there.
absl::Status ReplaceStore(const std::string& from, const std::string& to);

// As SubmapStore::DeleteMission.
absl::Status DeleteFromStore(const std::string& path, const ServerLimits& limits,
                             const MissionId& mission);

// "PATH: what" -> "what".
std::string WithoutPath(absl::string_view message, absl::string_view path);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_STORE_REPLACEMENT_H_
