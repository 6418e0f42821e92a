// SPDX-License-Identifier: Apache-2.0
// Who may do what, as the access file says it (access_file.h).
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SECURITY_ACCESS_RULES_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SECURITY_ACCESS_RULES_H_

#include <map>
#include <set>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "overtone/services/mapping_server/security/peer_identity.h"

namespace overtone {

// The names that a map is granted to; "*" is every name.
struct MapGrants {
  std::set<std::string> robots;
  std::set<std::string> operators;

  friend bool operator==(const MapGrants& a, const MapGrants& b) {
    return a.robots == b.robots && a.operators == b.operators;
  }
};

struct AccessRules {
  std::map<std::string, MapGrants> maps;  // by id; "*" is every map
  std::set<PeerIdentity> revoked;
  std::set<std::string> revoked_fingerprints;  // as CertificateFingerprint

  friend bool operator==(const AccessRules& a, const AccessRules& b) {
    return a.maps == b.maps && a.revoked == b.revoked &&
           a.revoked_fingerprints == b.revoked_fingerprints;
  }

  bool IsGranted(const PeerIdentity& peer, const std::string& map) const;

  // PermissionDenied, in the same words whether the map exists or not.
  // `prefix` stands before the field's name in the error: "header." or nothing.
  absl::Status MayRead(const PeerIdentity& peer, const std::string& map,
                       absl::string_view prefix = "") const;
  // The missions of `robot`, the request's mission.robot.
  absl::Status MayWrite(const PeerIdentity& peer, const std::string& map, absl::string_view robot,
                        absl::string_view prefix = "") const;
  absl::Status MayAdminister(const PeerIdentity& peer, const std::string& map) const;
};

// The right that does not depend on the map. PermissionDenied: a robot.
absl::Status MustBeOperator(const PeerIdentity& peer);
absl::Status MustBeRobot(const PeerIdentity& peer);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SECURITY_ACCESS_RULES_H_
