// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SECURITY_PEER_CERTIFICATE_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SECURITY_PEER_CERTIFICATE_H_

#include <string>

#include "grpc/grpc_security.h"
#include "grpcpp/grpcpp.h"
#include "overtone/services/mapping_server/security/peer_identity.h"

namespace overtone {

// What the handshake has verified of a peer; all empty without TLS.
struct PeerCertificate {
  PeerNames names;
  std::string pem;
};

PeerCertificate PeerCertificateOf(const grpc::CallbackServerContext& context);
PeerCertificate PeerCertificateOf(const grpc_auth_context& context);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SECURITY_PEER_CERTIFICATE_H_
