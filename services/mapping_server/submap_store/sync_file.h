// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_SYNC_FILE_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_SYNC_FILE_H_

#include <string>

#include "absl/status/status.h"

namespace overtone {

// A file's content, or a folder's list of names, down to the disk. ResourceExhausted: it fails.
absl::Status SyncFile(const std::string& path);
// The name of a file that was made or renamed.
absl::Status SyncFolderOf(const std::string& path);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_SYNC_FILE_H_
