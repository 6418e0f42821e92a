// SPDX-License-Identifier: Apache-2.0
// What is to be known about each option, for people: names and types from option_table.h, texts
// from the comments of configs/default.yaml.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_OPTION_REFERENCE_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_OPTION_REFERENCE_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace overtone {

struct OptionText {
  std::string key;   // or a section's name
  std::string text;  // one line
};

// The keys and sections of a file written as default.yaml is, each with the comment right above it.
std::vector<OptionText> OptionTexts(absl::string_view yaml);

// "s", "m", "bytes", "1/s", ...; empty: none. Keys end with their unit.
std::string OptionUnit(absl::string_view key);

// docs/configuration.md.
std::string ConfigurationReference();

// About a key, all of a section, or for "" about everything. NotFound with the nearest key.
absl::StatusOr<std::string> ExplainOption(const std::string& name);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_OPTION_REFERENCE_H_
