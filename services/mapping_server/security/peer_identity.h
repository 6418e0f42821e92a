// SPDX-License-Identifier: Apache-2.0
// Who is at the other end, as its verified certificate says.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SECURITY_PEER_IDENTITY_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SECURITY_PEER_IDENTITY_H_

#include <string>
#include <tuple>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/optional.h"

namespace overtone {

enum class PeerRole { kRobot, kOperator };

struct PeerIdentity {
  PeerRole role = PeerRole::kRobot;
  std::string name;  // id rule of core/common/ids.h

  friend bool operator==(const PeerIdentity& a, const PeerIdentity& b) {
    return a.role == b.role && a.name == b.name;
  }
  friend bool operator<(const PeerIdentity& a, const PeerIdentity& b) {
    return std::tie(a.role, a.name) < std::tie(b.role, b.name);
  }
};

// "robot/anna", "operator/olga", as in certificates and in the access file.
std::string ToString(const PeerIdentity& identity);
// Nullopt: neither of the two.
absl::optional<PeerIdentity> ParseRoleAndName(absl::string_view text);

// The subject alternative names of one certificate.
struct PeerNames {
  std::vector<std::string> uris;
  std::vector<std::string> dns;
};

// The one identity that the names give:
//   URI  spiffe://<trust domain>/robot/<id>   or  spiffe://<trust domain>/operator/<name>
//   DNS  <id>.robot.<domain>                  or  <name>.operator.<domain>,  if accept_dns_names
// Any trust domain and domain: what the CA may sign is the CA's affair. Other names count for
// nothing. Unauthenticated: no identity, or two that differ.
absl::StatusOr<PeerIdentity> ParsePeerIdentity(const PeerNames& names, bool accept_dns_names);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SECURITY_PEER_IDENTITY_H_
