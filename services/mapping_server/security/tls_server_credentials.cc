// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/security/tls_server_credentials.h"

#include <string>

#include "grpc/grpc.h"
#include "grpc/grpc_security.h"
#include "overtone/proto/conversion/status_conversion.h"

namespace overtone {
namespace {

// Called for every handshake.
grpc_ssl_certificate_config_reload_status FetchCertificates(
    void* certificates, grpc_ssl_server_certificate_config** config) {
  const absl::optional<Certificates> fresh =
      static_cast<ServingCertificates*>(certificates)->TakeNew();
  if (!fresh.has_value()) return GRPC_SSL_CERTIFICATE_CONFIG_RELOAD_UNCHANGED;
  const grpc_ssl_pem_key_cert_pair pair = {fresh->key_pem.c_str(), fresh->certificate_pem.c_str()};
  *config = grpc_ssl_server_certificate_config_create(fresh->ca_pem.c_str(), &pair, 1);
  return GRPC_SSL_CERTIFICATE_CONFIG_RELOAD_NEW;
}

// Called for every call.
void AuthenticateCall(void* access, grpc_auth_context* context, const grpc_metadata*, size_t,
                      grpc_process_auth_metadata_done_cb done, void* user_data) {
  const grpc::Status status = ToGrpcStatus(static_cast<const AccessControl*>(access)
                                               ->Authenticate(PeerCertificateOf(*context))
                                               .status());
  done(user_data, nullptr, 0, nullptr, 0, static_cast<grpc_status_code>(status.error_code()),
       status.ok() ? nullptr : status.error_message().c_str());
}

class TlsServerCredentials final : public grpc::ServerCredentials {
 public:
  TlsServerCredentials(ServingCertificates* certificates, const AccessControl* access)
      : credentials_(grpc_ssl_server_credentials_create_with_options(
            grpc_ssl_server_credentials_create_options_using_config_fetcher(
                GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY, FetchCertificates,
                certificates))) {
    grpc_server_credentials_set_auth_metadata_processor(
        credentials_, {AuthenticateCall, nullptr, const_cast<AccessControl*>(access)});
  }
  ~TlsServerCredentials() override { grpc_server_credentials_release(credentials_); }

  // Ours is set.
  void SetAuthMetadataProcessor(const std::shared_ptr<grpc::AuthMetadataProcessor>&) override {}

 private:
  int AddPortToServer(const std::string& address, grpc_server* server) override {
    return grpc_server_add_http2_port(server, address.c_str(), credentials_);
  }

  grpc_server_credentials* const credentials_;
};

}  // namespace

bool ServingCertificates::Set(Certificates certificates) {
  absl::MutexLock lock(&mutex_);
  if (certificates == certificates_) return false;
  certificates_ = std::move(certificates);
  taken_ = false;
  return true;
}

absl::optional<Certificates> ServingCertificates::TakeNew() {
  absl::MutexLock lock(&mutex_);
  if (taken_) return absl::nullopt;
  taken_ = true;
  return certificates_;
}

std::shared_ptr<grpc::ServerCredentials> MakeTlsServerCredentials(ServingCertificates* certificates,
                                                                  const AccessControl* access) {
  return std::make_shared<TlsServerCredentials>(certificates, access);
}

}  // namespace overtone
