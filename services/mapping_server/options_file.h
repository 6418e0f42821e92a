// SPDX-License-Identifier: Apache-2.0
// Options from a YAML file whose keys are those of configs/default.yaml.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_OPTIONS_FILE_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_OPTIONS_FILE_H_

#include <map>
#include <string>

#include "absl/status/status.h"
#include "overtone/services/mapping_server/server_options.h"

namespace overtone {

// Puts what the file says into `options`; the rest stays. NotFound: cannot be read. InvalidArgument
// "path:line: what": not YAML, an unknown key (with the nearest known one), a key given twice, a
// value of the wrong type. Ranges are for ServerOptions::Validate().
absl::Status ReadOptionsFile(const std::string& path, ServerOptions& options);

// Every key that a file may give, "section.key", with its value as the file would say it.
std::map<std::string, std::string> OptionValues(ServerOptions options);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_OPTIONS_FILE_H_
