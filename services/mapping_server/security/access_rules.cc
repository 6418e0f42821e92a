// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/security/access_rules.h"

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

bool Contains(const std::set<std::string>& names, const std::string& name) {
  return names.count("*") > 0 || names.count(name) > 0;
}

}  // namespace

bool AccessRules::IsGranted(const PeerIdentity& peer, const std::string& map) const {
  for (const std::string& id : {map, std::string("*")}) {
    const auto it = maps.find(id);
    if (it == maps.end()) continue;
    const MapGrants& grants = it->second;
    if (Contains(peer.role == PeerRole::kRobot ? grants.robots : grants.operators, peer.name)) {
      return true;
    }
  }
  return false;
}

absl::Status AccessRules::MayRead(const PeerIdentity& peer, const std::string& map,
                                  absl::string_view prefix) const {
  if (IsGranted(peer, map)) return absl::OkStatus();
  return absl::PermissionDeniedError(
      absl::StrCat(prefix, "map: ", ToString(peer), " has no access to '", map, "'"));
}

absl::Status AccessRules::MayWrite(const PeerIdentity& peer, const std::string& map,
                                   absl::string_view robot, absl::string_view prefix) const {
  RETURN_IF_ERROR(MustBeRobot(peer));
  RETURN_IF_ERROR(MayRead(peer, map, prefix));
  if (robot == peer.name) return absl::OkStatus();
  return absl::PermissionDeniedError(absl::StrCat(
      prefix, "mission.robot: '", robot, "', but the certificate is ", ToString(peer), "'s"));
}

absl::Status AccessRules::MayAdminister(const PeerIdentity& peer, const std::string& map) const {
  RETURN_IF_ERROR(MustBeOperator(peer));
  return MayRead(peer, map);
}

absl::Status MustBeOperator(const PeerIdentity& peer) {
  if (peer.role == PeerRole::kOperator) return absl::OkStatus();
  return absl::PermissionDeniedError(
      absl::StrCat("MapAdminService is for operators, the certificate is ", ToString(peer), "'s"));
}

absl::Status MustBeRobot(const PeerIdentity& peer) {
  if (peer.role == PeerRole::kRobot) return absl::OkStatus();
  return absl::PermissionDeniedError(
      absl::StrCat("only robots write missions, the certificate is ", ToString(peer), "'s"));
}

}  // namespace overtone
