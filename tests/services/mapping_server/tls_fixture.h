// SPDX-License-Identifier: Apache-2.0
// A server with certificates and access rules in this process, and peers that show theirs.
#ifndef OVERTONE_TESTS_SERVICES_MAPPING_SERVER_TLS_FIXTURE_H_
#define OVERTONE_TESTS_SERVICES_MAPPING_SERVER_TLS_FIXTURE_H_

#include <memory>
#include <string>

#include "grpcpp/grpcpp.h"
#include "overtone/tests/services/mapping_server/server_fixture.h"
#include "overtone/tests/support/test_certificates.h"

namespace overtone::testing {

// A new connection to `address`; the certificate may be empty: none is shown.
inline std::shared_ptr<grpc::Channel> Connect(const std::string& address, const std::string& ca_pem,
                                              const CertificateAndKey& certificate,
                                              const std::string& server_name = "localhost") {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  arguments.SetSslTargetNameOverride(server_name);
  grpc::SslCredentialsOptions options;
  options.pem_root_certs = ca_pem;
  options.pem_private_key = certificate.key_pem;
  options.pem_cert_chain = certificate.certificate_pem;
  return grpc::CreateCustomChannel(address, grpc::SslCredentials(options), arguments);
}

// Its files; change them and call server->ReloadSecurity().
class TlsFolder {
 public:
  explicit TlsFolder(const std::string& access) {
    WriteCertificates(ca.ca_pem(), ca.Server());
    WriteAccess(access);
  }
  void WriteCertificates(const std::string& ca_pem, const CertificateAndKey& server) {
    folder.Write("ca.crt", ca_pem);
    folder.Write("server.crt", server.certificate_pem);
    folder.Write("server.key", server.key_pem);
  }
  void WriteAccess(const std::string& access) { folder.Write("access.yaml", access); }

  ServerOptions Options() const {
    ServerOptions options = TestOptions();
    const std::string& path = folder.path();
    options.security.files = {path + "/ca.crt", path + "/server.crt", path + "/server.key"};
    options.security.access_file = path + "/access.yaml";
    options.security.reload_s = 3600;  // when the test says so
    return options;
  }

  const TestAuthority ca;
  const TemporaryFolder folder;
};

}  // namespace overtone::testing

#endif  // OVERTONE_TESTS_SERVICES_MAPPING_SERVER_TLS_FIXTURE_H_
