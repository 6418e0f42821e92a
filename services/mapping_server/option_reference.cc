// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/option_reference.h"

#include <map>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "overtone/services/mapping_server/default_configuration.h"
#include "overtone/services/mapping_server/option_table.h"
#include "overtone/services/mapping_server/options_environment.h"
#include "overtone/services/mapping_server/suggestion.h"

namespace overtone {
namespace {

constexpr char kIntroduction[] =
    R"(<!-- Written by `overtone-mapping-server config reference`, and compared with it by a test. -->
# Configuration

The server reads one YAML file, `--config FILE` (or `OVERTONE_CONFIG`); every option has a default, so the file says only what
differs. An option `section.name` of the file is `OVERTONE_SECTION_NAME` in the environment, e.g. `OVERTONE_QUOTAS_MAX_STREAMS`;
`listen`, `data_dir`, `log_level`, `log_format` and `insecure` are also flags. Flags stand above the environment, the environment above the file,
the file above the defaults. What is in force is read once, when the server starts; only certificates and the access file are
looked at again.

A mistake is refused, not passed over: unknown keys and variables, and values of the wrong type or out of their range, with line
and the nearest name. Variables that begin with `OVERTONE_` and are nobody's count as mistakes, too; the command's own
(`OVERTONE_TLS_CA`, ...), tests' (`OVERTONE_TEST_...`) and those that Kubernetes makes for Services (`..._SERVICE_HOST`, `..._PORT`)
do not. `OVERTONE_INSECURE` is both the server's and the command's.

```sh
overtone config check server.yaml                 # mistakes with their line; exit code 2 where there are any
overtone config explain quotas.max_streams        # one option, or a section
overtone config default                           # every option with its default and comment, as a file to begin with
overtone config show --server localhost:7077      # what is in force at a running server, and who said it
```

`check`, `explain` and `default` run `overtone-mapping-server config`, which must be installed beside the command; `show` asks the
server (`MapAdminService.GetConfiguration`) and is for operators. Contents of keys and certificates are not among what it answers.
)";

struct OptionFacts {
  std::string key, type, value;
};

std::vector<OptionFacts> Facts() {
  ServerOptions defaults;
  std::vector<OptionFacts> facts;
  for (const Option& option : OptionTable(defaults)) {
    facts.push_back({option.key, option.type, option.get()});
  }
  return facts;
}

std::map<std::string, std::string> TextByKey() {
  std::map<std::string, std::string> texts;
  for (OptionText& option : OptionTexts(DefaultConfiguration())) {
    texts[std::move(option.key)] = std::move(option.text);
  }
  return texts;
}

std::string SectionOf(const std::string& key) {
  const size_t dot = key.find('.');
  return dot == std::string::npos ? "" : key.substr(0, dot);
}

std::string ForTable(absl::string_view text) {
  return absl::StrReplaceAll(text, {{"<", "&lt;"}, {">", "&gt;"}, {"|", "\\|"}});
}

std::string TableRow(const OptionFacts& option, const std::string& text) {
  const std::string value = option.value.empty() ? "" : absl::StrCat("`", option.value, "`");
  return absl::StrCat("| `", option.key, "` | ", option.type, " | ", value, " | ",
                      OptionUnit(option.key), " | ", ForTable(text), " |\n");
}

std::string Explanation(const OptionFacts& option, const std::string& text) {
  const std::string unit = OptionUnit(option.key);
  return absl::StrCat(option.key, ": ", option.type, unit.empty() ? "" : absl::StrCat(", ", unit),
                      "; default ", option.value.empty() ? "\"\"" : option.value, "; ",
                      EnvironmentName(option.key), "\n  ", text, "\n");
}

}  // namespace

std::vector<OptionText> OptionTexts(absl::string_view yaml) {
  std::vector<OptionText> texts;
  std::string section, comment;
  for (const absl::string_view line : absl::StrSplit(yaml, '\n')) {
    absl::string_view rest = absl::StripAsciiWhitespace(line);
    if (absl::ConsumePrefix(&rest, "#")) {
      absl::StrAppend(&comment, comment.empty() ? "" : " ", absl::StripAsciiWhitespace(rest));
      continue;
    }
    const size_t colon = rest.find(':');
    if (colon != absl::string_view::npos) {
      const std::string name(rest.substr(0, colon));
      if (line[0] != ' ') section.clear();
      texts.push_back({section.empty() ? name : absl::StrCat(section, ".", name), comment});
      if (colon + 1 == rest.size()) section = name;
    }
    comment.clear();
  }
  return texts;
}

std::string OptionUnit(absl::string_view key) {
  for (const auto& [ending, unit] :
       std::vector<std::pair<const char*, const char*>>{{"_bytes_per_s", "bytes/s"},
                                                        {"_per_s", "1/s"},
                                                        {"_bytes", "bytes"},
                                                        {"bytes_burst", "bytes"},
                                                        {"_ns", "ns"},
                                                        {"_rad", "rad"},
                                                        {"_m", "m"},
                                                        {"_s", "s"}}) {
    if (absl::EndsWith(key, ending)) return unit;
  }
  return "";
}

std::string ConfigurationReference() {
  std::map<std::string, std::string> texts = TextByKey();
  std::vector<std::string> order = {""};
  std::map<std::string, std::string> rows;  // by section
  for (const OptionFacts& option : Facts()) {
    const std::string section = SectionOf(option.key);
    if (rows.count(section) == 0 && !section.empty()) order.push_back(section);
    rows[section] += TableRow(option, texts[option.key]);
  }
  std::string page = kIntroduction;
  for (const std::string& section : order) {
    absl::StrAppend(&page, "\n## ", section.empty() ? "The server" : section, "\n\n");
    if (!section.empty()) absl::StrAppend(&page, ForTable(texts[section]), "\n\n");
    absl::StrAppend(&page, "| key | type | default | unit | |\n|---|---|---|---|---|\n",
                    rows[section]);
  }
  return page;
}

absl::StatusOr<std::string> ExplainOption(const std::string& name) {
  const std::map<std::string, std::string> texts = TextByKey();
  std::string explanation;
  for (const OptionFacts& option : Facts()) {
    if (name.empty() || name == option.key || name == SectionOf(option.key) ||
        name == EnvironmentName(option.key)) {
      const auto text = texts.find(option.key);
      explanation += Explanation(option, text == texts.end() ? "" : text->second);
    }
  }
  if (!explanation.empty()) return explanation;
  return absl::NotFoundError(
      absl::StrCat("there is no option '", name, "'", DidYouMean(NearestName(name, OptionKeys()))));
}

}  // namespace overtone
