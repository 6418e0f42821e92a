// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/security/peer_identity.h"

#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/string_view.h"
#include "absl/strings/strip.h"
#include "overtone/core/common/ids.h"

namespace overtone {
namespace {

absl::optional<PeerIdentity> MakeIdentity(absl::string_view role, absl::string_view name) {
  if (role != "robot" && role != "operator") return absl::nullopt;
  if (!ValidateId(name, "name").ok()) return absl::nullopt;
  return PeerIdentity{role == "robot" ? PeerRole::kRobot : PeerRole::kOperator, std::string(name)};
}

// The scheme and the trust domain are case-insensitive (SPIFFE-ID section 2), the path is not.
absl::optional<PeerIdentity> FromUri(absl::string_view uri) {
  if (!absl::StartsWithIgnoreCase(uri, "spiffe://")) return absl::nullopt;
  const std::vector<absl::string_view> parts =
      absl::StrSplit(uri.substr(absl::string_view("spiffe://").size()), '/');
  if (parts.size() != 3 || parts[0].empty()) return absl::nullopt;
  return MakeIdentity(parts[1], parts[2]);
}

absl::optional<PeerIdentity> FromDns(absl::string_view dns) {
  const std::string name = absl::AsciiStrToLower(dns);
  const std::vector<absl::string_view> labels = absl::StrSplit(name, absl::MaxSplits('.', 2));
  if (labels.size() != 3 || labels[2].empty()) return absl::nullopt;
  return MakeIdentity(labels[1], labels[0]);
}

}  // namespace

std::string ToString(const PeerIdentity& identity) {
  return absl::StrCat(identity.role == PeerRole::kRobot ? "robot/" : "operator/", identity.name);
}

absl::optional<PeerIdentity> ParseRoleAndName(absl::string_view text) {
  const std::pair<absl::string_view, absl::string_view> words =
      absl::StrSplit(text, absl::MaxSplits('/', 1));
  return MakeIdentity(words.first, words.second);
}

absl::StatusOr<PeerIdentity> ParsePeerIdentity(const PeerNames& names, bool accept_dns_names) {
  std::vector<PeerIdentity> found;
  const auto add = [&found](absl::optional<PeerIdentity> identity) {
    if (identity.has_value()) found.push_back(*std::move(identity));
  };
  for (const std::string& uri : names.uris) add(FromUri(uri));
  if (accept_dns_names) {
    for (const std::string& dns : names.dns) add(FromDns(dns));
  }
  if (found.empty()) {
    return absl::UnauthenticatedError(absl::StrCat(
        "certificate: no name spiffe://<trust domain>/robot/<id> or .../operator/<name>",
        accept_dns_names ? ", nor <id>.robot.<domain> or <name>.operator.<domain>" : ""));
  }
  for (const PeerIdentity& identity : found) {
    if (identity == found.front()) continue;
    return absl::UnauthenticatedError(absl::StrCat(
        "certificate: says both ", ToString(found.front()), " and ", ToString(identity)));
  }
  return found.front();
}

}  // namespace overtone
