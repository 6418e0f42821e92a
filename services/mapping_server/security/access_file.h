// SPDX-License-Identifier: Apache-2.0
// The access file, YAML:
//
//   maps:
//     town:                        # id of a map, or "*" for all
//       robots: [anna, bert]       # names, or "*" for all
//       operators: ["*"]
//   revoked:
//     - robot/bert                 # every certificate of that name
//     - sha256:5e:2c:...           # one certificate: its fingerprint, colons or none
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SECURITY_ACCESS_FILE_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SECURITY_ACCESS_FILE_H_

#include <string>

#include "absl/status/statusor.h"
#include "overtone/services/mapping_server/security/access_rules.h"

namespace overtone {

// NotFound: cannot be read. InvalidArgument "path:line: what": not YAML, an unknown key, a key
// given twice, a name that cannot be one.
absl::StatusOr<AccessRules> ReadAccessFile(const std::string& path);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SECURITY_ACCESS_FILE_H_
