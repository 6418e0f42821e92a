// SPDX-License-Identifier: Apache-2.0
// The one list of the server's options, whoever sets them: file, environment or flag.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_OPTION_TABLE_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_OPTION_TABLE_H_

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "overtone/services/mapping_server/server_options.h"

namespace overtone {

struct Option {
  std::string key;   // as in the file, "section.name" or "name"
  std::string type;  // for people: "integer", "number", "text", "true or false", or its values
  std::function<bool(const std::string&)> set;  // false: the text is not of the type
  std::function<std::string()> get;             // the value as the file would say it
};

// In the order of configs/default.yaml, which documents them. Refers to `options`, which must
// outlive it. A new option is a line here and a paragraph there.
std::vector<Option> OptionTable(ServerOptions& options);

const std::vector<std::string>& OptionKeys();

// Every key with its value as the file would say it.
std::map<std::string, std::string> OptionValues(ServerOptions options);

// Who gave an option its value.
struct OptionSource {
  enum class Kind { kFile, kEnvironment, kFlag };
  Kind kind = Kind::kFile;
  std::string place;  // "server.yaml:12", "OVERTONE_DATA_DIR" or "--data-dir"
};
using OptionSources = std::map<std::string, OptionSource>;  // by key; the rest are defaults

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_OPTION_TABLE_H_
