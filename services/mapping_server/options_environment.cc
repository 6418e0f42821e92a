// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/options_environment.h"

#include <unistd.h>

#include <algorithm>
#include <initializer_list>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "overtone/services/mapping_server/suggestion.h"

namespace overtone {
namespace {

constexpr absl::string_view kPrefix = "OVERTONE_";

// A pod finds NAME_SERVICE_HOST, NAME_SERVICE_PORT, NAME_SERVICE_PORT_GRPC, NAME_PORT,
// NAME_PORT_7077_TCP and NAME_PORT_7077_TCP_ADDR for each Service NAME of its namespace.
bool IsOfKubernetes(absl::string_view name) {
  if (absl::EndsWith(name, "_SERVICE_HOST") || absl::EndsWith(name, "_PORT")) return true;
  if (absl::StrContains(name, "_SERVICE_PORT")) return true;
  const std::vector<absl::string_view> words = absl::StrSplit(name, '_');
  for (size_t i = 2; i < words.size(); ++i) {
    const bool number = !words[i - 1].empty() &&
                        words[i - 1].find_first_not_of("0123456789") == absl::string_view::npos;
    const bool protocol = words[i] == "TCP" || words[i] == "UDP" || words[i] == "SCTP";
    if (words[i - 2] == "PORT" && number && protocol) return true;
  }
  return false;
}

bool IsOfOthers(absl::string_view name) {
  const std::initializer_list<absl::string_view> others = {
      "OVERTONE_CONFIG",          "OVERTONE_SERVER",          "OVERTONE_MAP",
      "OVERTONE_TLS_CA",          "OVERTONE_TLS_CERT",        "OVERTONE_TLS_KEY",
      "OVERTONE_TLS_SERVER_NAME", "OVERTONE_TLS_ROBOT_CERTS", "OVERTONE_FAILPOINT"};
  return std::find(others.begin(), others.end(), name) != others.end() ||
         absl::StartsWith(name, "OVERTONE_TEST_") ||
         absl::StartsWith(name, "OVERTONE_DASHBOARD_") || IsOfKubernetes(name);
}

std::string Unknown(absl::string_view name) {
  std::vector<std::string> known;  // without what all have in common
  for (const std::string& key : OptionKeys()) {
    known.push_back(EnvironmentName(key).substr(kPrefix.size()));
  }
  std::string nearest = NearestName(name.substr(kPrefix.size()), known);
  if (!nearest.empty()) nearest = absl::StrCat(kPrefix, nearest);
  return absl::StrCat("the environment's ", name, " is no option of the server",
                      DidYouMean(nearest));
}

// A mistake, or nothing.
std::string Set(const std::vector<Option>& table, absl::string_view name, const std::string& value,
                OptionSources& sources) {
  const auto option = std::find_if(table.begin(), table.end(), [&](const Option& candidate) {
    return EnvironmentName(candidate.key) == name;
  });
  if (option == table.end()) return IsOfOthers(name) ? "" : Unknown(name);
  if (!option->set(value)) {
    return absl::StrCat("the environment's ", name, " is not ", option->type, ": '", value, "'");
  }
  sources[option->key] = {OptionSource::Kind::kEnvironment, std::string(name)};
  return "";
}

}  // namespace

std::string EnvironmentName(absl::string_view key) {
  return absl::StrCat(kPrefix, absl::AsciiStrToUpper(absl::StrReplaceAll(key, {{".", "_"}})));
}

std::vector<std::string> Environment() {
  std::vector<std::string> all;
  for (char** variable = environ; variable != nullptr && *variable != nullptr; ++variable) {
    all.emplace_back(*variable);
  }
  return all;
}

absl::Status ReadOptionsEnvironment(const std::vector<std::string>& environment,
                                    ServerOptions& options, OptionSources& sources) {
  const std::vector<Option> table = OptionTable(options);
  std::vector<std::string> mistakes;
  for (const std::string& variable : environment) {
    if (!absl::StartsWith(variable, kPrefix)) continue;
    const std::pair<std::string, std::string> parts =
        absl::StrSplit(variable, absl::MaxSplits('=', 1));
    std::string mistake = Set(table, parts.first, parts.second, sources);
    if (!mistake.empty()) mistakes.push_back(std::move(mistake));
  }
  if (mistakes.empty()) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrJoin(mistakes, "\n"));
}

}  // namespace overtone
