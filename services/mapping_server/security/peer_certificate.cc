// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/security/peer_certificate.h"

#include <memory>
#include <vector>

#include "grpc/grpc_security_constants.h"

namespace overtone {
namespace {

// `values`: from the name of a property to all that it has.
template <typename Values>
PeerCertificate FromProperties(const Values& values) {
  PeerCertificate peer;
  peer.names.uris = values(GRPC_PEER_URI_PROPERTY_NAME);
  peer.names.dns = values(GRPC_PEER_DNS_PROPERTY_NAME);
  const std::vector<std::string> pem = values(GRPC_X509_PEM_CERT_PROPERTY_NAME);
  if (!pem.empty()) peer.pem = pem.front();
  return peer;
}

}  // namespace

PeerCertificate PeerCertificateOf(const grpc::CallbackServerContext& context) {
  const std::shared_ptr<const grpc::AuthContext> auth = context.auth_context();
  return FromProperties([&](const char* name) {
    std::vector<std::string> values;
    if (auth == nullptr) return values;
    for (const grpc::string_ref& value : auth->FindPropertyValues(name)) {
      values.emplace_back(value.data(), value.size());
    }
    return values;
  });
}

PeerCertificate PeerCertificateOf(const grpc_auth_context& context) {
  return FromProperties([&](const char* name) {
    std::vector<std::string> values;
    grpc_auth_property_iterator it = grpc_auth_context_find_properties_by_name(&context, name);
    while (const grpc_auth_property* property = grpc_auth_property_iterator_next(&it)) {
      values.emplace_back(property->value, property->value_length);
    }
    return values;
  });
}

}  // namespace overtone
