// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/options_file.h"

#include <algorithm>
#include <fstream>
#include <set>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/string_view.h"
#include "overtone/services/mapping_server/suggestion.h"
#include "yaml-cpp/yaml.h"

namespace overtone {
namespace {

constexpr size_t kMaxMistakes = 20;  // of a file that is something else altogether

class Reader {
 public:
  Reader(std::string path, std::vector<Option> table, OptionSources& sources)
      : path_(std::move(path)), table_(std::move(table)), sources_(sources) {}

  // Walks a mapping; `prefix` is "" or "section.".
  void ReadMapping(const YAML::Node& mapping, const std::string& prefix) {
    for (const auto& entry : mapping) {
      if (!entry.first.IsScalar()) {
        Mistake(entry.first.Mark(), "a key is not a word");
        continue;
      }
      const std::string key = prefix + entry.first.Scalar();
      const bool section = entry.second.IsMap() && prefix.empty();
      if (section && Find(key) == nullptr) {
        ReadMapping(entry.second, key + ".");
      } else {
        ReadScalar(entry.first, key, entry.second);
      }
    }
  }

  absl::Status status() const {
    if (mistakes_.empty()) return absl::OkStatus();
    return absl::InvalidArgumentError(absl::StrJoin(mistakes_, "\n"));
  }

 private:
  const Option* Find(const std::string& key) const {
    const auto it = std::find_if(table_.begin(), table_.end(),
                                 [&](const Option& option) { return option.key == key; });
    return it == table_.end() ? nullptr : &*it;
  }

  void ReadScalar(const YAML::Node& name, const std::string& key, const YAML::Node& value) {
    if (mistakes_.size() == kMaxMistakes) return;  // not worth the search for what was meant
    const Option* option = Find(key);
    if (option == nullptr) {
      return Mistake(name.Mark(), absl::StrCat("unknown key '", key, "'",
                                               DidYouMean(NearestName(key, OptionKeys()))));
    }
    if (!seen_.insert(key).second) {
      return Mistake(name.Mark(), absl::StrCat(key, " is given twice"));
    }
    if (!value.IsScalar() || !option->set(value.Scalar())) {
      return Mistake(value.Mark(),
                     absl::StrCat(key, " has a value of the wrong type: not ", option->type));
    }
    sources_[key] = {OptionSource::Kind::kFile, Place(value.Mark())};
  }

  std::string Place(const YAML::Mark& mark) const {
    return absl::StrCat(path_, ":", mark.line + 1);
  }

  void Mistake(const YAML::Mark& mark, absl::string_view what) {
    if (mistakes_.size() < kMaxMistakes) mistakes_.push_back(absl::StrCat(Place(mark), ": ", what));
  }

  const std::string path_;
  const std::vector<Option> table_;
  OptionSources& sources_;
  std::set<std::string> seen_;
  std::vector<std::string> mistakes_;
};

}  // namespace

absl::Status ReadOptionsFile(const std::string& path, ServerOptions& options,
                             OptionSources& sources) {
  std::ifstream in(path);
  if (!in) return absl::NotFoundError(absl::StrCat(path, ": cannot be read"));
  try {
    const YAML::Node root = YAML::Load(in);
    if (root.IsNull()) return absl::OkStatus();
    if (!root.IsMap()) return absl::InvalidArgumentError(absl::StrCat(path, ":1: not a mapping"));
    Reader reader(path, OptionTable(options), sources);
    reader.ReadMapping(root, "");
    return reader.status();
  } catch (const YAML::Exception& error) {
    return absl::InvalidArgumentError(
        absl::StrCat(path, ":", error.mark.line + 1, ": ", error.msg));
  }
}

}  // namespace overtone
