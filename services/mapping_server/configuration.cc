// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/configuration.h"

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/string_view.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/services/mapping_server/options_environment.h"
#include "overtone/services/mapping_server/options_file.h"

namespace overtone {
namespace {

absl::Status SetFlags(const std::map<std::string, std::string>& flags,
                      Configuration& configuration) {
  for (const Option& option : OptionTable(configuration.options)) {
    const auto flag = flags.find(option.key);
    if (flag == flags.end()) continue;
    const std::string name = absl::StrCat("--", absl::StrReplaceAll(option.key, {{"_", "-"}}));
    if (!option.set(flag->second)) {
      return absl::InvalidArgumentError(absl::StrCat(name, " is not ", option.type));
    }
    configuration.sources[option.key] = {OptionSource::Kind::kFlag, name};
  }
  return absl::OkStatus();
}

// Validate() says "key: why" or "key must ..."; who gave the key that value stands before it.
absl::Status AtSource(const absl::Status& status, const OptionSources& sources) {
  for (const auto& [key, source] : sources) {
    const absl::string_view said = status.message();
    if (absl::StartsWith(said, absl::StrCat(key, ":")) ||
        absl::StartsWith(said, absl::StrCat(key, " "))) {
      return absl::Status(status.code(), absl::StrCat(source.place, ": ", status.message()));
    }
  }
  return status;
}

const char* SourceName(const OptionSource& source) {
  switch (source.kind) {
    case OptionSource::Kind::kFile:
      return "file";
    case OptionSource::Kind::kEnvironment:
      return "environment";
    case OptionSource::Kind::kFlag:
      return "flag";
  }
  return "";
}

}  // namespace

absl::StatusOr<Configuration> ReadConfiguration(const ConfigurationInput& input) {
  Configuration configuration;
  if (!input.file.empty()) {
    RETURN_IF_ERROR(ReadOptionsFile(input.file, configuration.options, configuration.sources));
  }
  RETURN_IF_ERROR(
      ReadOptionsEnvironment(input.environment, configuration.options, configuration.sources));
  RETURN_IF_ERROR(SetFlags(input.flags, configuration));
  RETURN_IF_ERROR(AtSource(configuration.options.Validate(), configuration.sources));
  return configuration;
}

v1::GetConfigurationResponse DescribeConfiguration(const Configuration& configuration) {
  const std::map<std::string, std::string> defaults = OptionValues(ServerOptions());
  ServerOptions options = configuration.options;
  v1::GetConfigurationResponse response;
  for (const Option& option : OptionTable(options)) {
    v1::ConfigurationValue& value = *response.add_values();
    value.set_key(option.key);
    value.set_value(option.get());
    value.set_default_value(defaults.at(option.key));
    const auto source = configuration.sources.find(option.key);
    if (source != configuration.sources.end()) {
      value.set_source(SourceName(source->second));
    } else if (value.value() == value.default_value()) {
      value.set_source("default");
    }
  }
  return response;
}

}  // namespace overtone
