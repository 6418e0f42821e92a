// SPDX-License-Identifier: Apache-2.0
// What is in force, and who said so: flags over environment over file over defaults.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_CONFIGURATION_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_CONFIGURATION_H_

#include <map>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "overtone/services/mapping_server/option_table.h"
#include "overtone/services/mapping_server/server_options.h"
#include "overtone/v1/map_admin_service.pb.h"

namespace overtone {

struct ConfigurationInput {
  std::string file;                          // empty: none
  std::vector<std::string> environment;      // "NAME=value"
  std::map<std::string, std::string> flags;  // by key; those that were given
};

struct Configuration {
  ServerOptions options;
  OptionSources sources;
};

// Valid options. NotFound: the file cannot be read. InvalidArgument saying where: "server.yaml:12:
// limits.max_maps: 0 is not in [1, 10000]".
absl::StatusOr<Configuration> ReadConfiguration(const ConfigurationInput& input);

// For operators. Where an option is not the default and nobody is known to have said so, its source
// is empty: a program runs the server in its own process.
v1::GetConfigurationResponse DescribeConfiguration(const Configuration& configuration);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_CONFIGURATION_H_
