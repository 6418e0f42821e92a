// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/security/access_file.h"

#include <algorithm>
#include <fstream>
#include <functional>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/strip.h"
#include "overtone/core/common/ids.h"
#include "overtone/core/common/status_macros.h"
#include "yaml-cpp/yaml.h"

namespace overtone {
namespace {

// 64 lower-case hexadecimal digits; empty: not a fingerprint.
std::string Fingerprint(absl::string_view text) {
  const std::string digits = absl::AsciiStrToLower(absl::StrReplaceAll(text, {{":", ""}}));
  const bool hexadecimal = std::all_of(digits.begin(), digits.end(), absl::ascii_isxdigit);
  return digits.size() == 64 && hexadecimal ? digits : "";
}

bool IsName(const std::string& name) { return name == "*" || ValidateId(name, "").ok(); }

class Reader {
 public:
  explicit Reader(const std::string& path) : path_(path) {}

  absl::StatusOr<AccessRules> Read(const YAML::Node& root) {
    RETURN_IF_ERROR(ReadMapping(root, "the file", [this](const auto& key, const auto& value) {
      if (key.Scalar() == "maps") {
        return ReadMapping(value, "maps", [this](const auto& map, const auto& grants) {
          return ReadGrants(map, grants);
        });
      }
      if (key.Scalar() == "revoked") {
        return ReadList(value, "revoked", [this](const auto& entry) { return Revoke(entry); });
      }
      return Unknown(key, "maps, revoked");
    }));
    return std::move(rules_);
  }

 private:
  using OnEntry = std::function<absl::Status(const YAML::Node& key, const YAML::Node& value)>;

  // An empty one is null in YAML.
  absl::Status ReadMapping(const YAML::Node& node, const std::string& what,
                           const OnEntry& on_entry) {
    if (node.IsNull()) return absl::OkStatus();
    if (!node.IsMap()) return Error(node, absl::StrCat(what, " must be a mapping"));
    std::set<std::string> seen;
    for (const auto& entry : node) {
      if (!entry.first.IsScalar()) return Error(entry.first, "a key must be a name");
      if (!seen.insert(entry.first.Scalar()).second) {
        return Error(entry.first, absl::StrCat("'", entry.first.Scalar(), "' is given twice"));
      }
      RETURN_IF_ERROR(on_entry(entry.first, entry.second));
    }
    return absl::OkStatus();
  }

  absl::Status ReadList(const YAML::Node& node, const std::string& what,
                        const std::function<absl::Status(const YAML::Node&)>& on_entry) {
    if (node.IsNull()) return absl::OkStatus();
    if (!node.IsSequence()) return Error(node, absl::StrCat(what, " must be a list"));
    for (const auto& entry : node) {
      if (!entry.IsScalar()) return Error(entry, absl::StrCat(what, " must be a list of names"));
      RETURN_IF_ERROR(on_entry(entry));
    }
    return absl::OkStatus();
  }

  absl::Status ReadGrants(const YAML::Node& map, const YAML::Node& value) {
    if (!IsName(map.Scalar())) return NotAName(map);
    MapGrants& grants = rules_.maps[map.Scalar()];
    return ReadMapping(value, map.Scalar(), [&](const YAML::Node& key, const YAML::Node& names) {
      if (key.Scalar() == "robots") return ReadNames(names, "robots", grants.robots);
      if (key.Scalar() == "operators") return ReadNames(names, "operators", grants.operators);
      return Unknown(key, "robots, operators");
    });
  }

  absl::Status ReadNames(const YAML::Node& node, const std::string& what,
                         std::set<std::string>& names) {
    return ReadList(node, what, [&](const YAML::Node& name) {
      if (!IsName(name.Scalar())) return NotAName(name);
      names.insert(name.Scalar());
      return absl::OkStatus();
    });
  }

  absl::Status Revoke(const YAML::Node& entry) {
    absl::string_view text = entry.Scalar();
    if (absl::ConsumePrefix(&text, "sha256:")) {
      const std::string fingerprint = Fingerprint(text);
      if (fingerprint.empty()) return Error(entry, "sha256: must be followed by 64 hex digits");
      rules_.revoked_fingerprints.insert(fingerprint);
      return absl::OkStatus();
    }
    const absl::optional<PeerIdentity> identity = ParseRoleAndName(text);
    if (!identity.has_value()) {
      return Error(entry, absl::StrCat("'", text,
                                       "' is none of robot/<id>, operator/<name>, "
                                       "sha256:<fingerprint>"));
    }
    rules_.revoked.insert(*identity);
    return absl::OkStatus();
  }

  absl::Status NotAName(const YAML::Node& node) const {
    return Error(node,
                 absl::StrCat("'", node.Scalar(), "' is neither \"*\" nor a name of [a-z0-9_-]"));
  }
  absl::Status Unknown(const YAML::Node& key, absl::string_view known) const {
    return Error(key, absl::StrCat("unknown key '", key.Scalar(), "'; known are ", known));
  }
  absl::Status Error(const YAML::Node& node, absl::string_view what) const {
    return absl::InvalidArgumentError(absl::StrCat(path_, ":", node.Mark().line + 1, ": ", what));
  }

  const std::string path_;
  AccessRules rules_;
};

}  // namespace

absl::StatusOr<AccessRules> ReadAccessFile(const std::string& path) {
  std::ifstream in(path);
  if (!in) return absl::NotFoundError(absl::StrCat(path, ": cannot be read"));
  try {
    return Reader(path).Read(YAML::Load(in));
  } catch (const YAML::Exception& error) {
    return absl::InvalidArgumentError(
        absl::StrCat(path, ":", error.mark.line + 1, ": ", error.msg));
  }
}

}  // namespace overtone
