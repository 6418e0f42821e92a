// SPDX-License-Identifier: Apache-2.0
// Options from the environment: quotas.max_streams is OVERTONE_QUOTAS_MAX_STREAMS.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_OPTIONS_ENVIRONMENT_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_OPTIONS_ENVIRONMENT_H_

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "overtone/services/mapping_server/option_table.h"
#include "overtone/services/mapping_server/server_options.h"

namespace overtone {

std::string EnvironmentName(absl::string_view key);

// The process's, "NAME=value" each.
std::vector<std::string> Environment();

// Puts what the environment says into `options` and `sources`. InvalidArgument, a line for each
// mistake: a value of the wrong type, or a variable OVERTONE_... that is no option's, since a
// mistyped one would otherwise do nothing. Left alone are
//   OVERTONE_CONFIG                  the file, as --config
//   OVERTONE_SERVER, OVERTONE_MAP, OVERTONE_TLS_CA, _CERT, _KEY, _SERVER_NAME, _ROBOT_CERTS
//                                    the command's (`overtone`)
//   OVERTONE_DASHBOARD_...           the dashboard's
//   OVERTONE_FAILPOINT, OVERTONE_TEST_...    tests'
//   OVERTONE_..._SERVICE_HOST, ..._PORT and the like            what Kubernetes says of Services
absl::Status ReadOptionsEnvironment(const std::vector<std::string>& environment,
                                    ServerOptions& options, OptionSources& sources);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_OPTIONS_ENVIRONMENT_H_
