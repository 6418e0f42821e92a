// SPDX-License-Identifier: Apache-2.0
// Options from a YAML file whose keys are those of configs/default.yaml.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_OPTIONS_FILE_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_OPTIONS_FILE_H_

#include <string>

#include "absl/status/status.h"
#include "overtone/services/mapping_server/option_table.h"
#include "overtone/services/mapping_server/server_options.h"

namespace overtone {

// Puts what the file says into `options`, and where it says so into `sources`; the rest stays.
// NotFound: cannot be read. InvalidArgument, a line "path:line: what" for each mistake: not YAML,
// an unknown key (with the nearest known one), a key given twice, a value of the wrong type. Ranges
// are for ServerOptions::Validate().
absl::Status ReadOptionsFile(const std::string& path, ServerOptions& options,
                             OptionSources& sources);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_OPTIONS_FILE_H_
