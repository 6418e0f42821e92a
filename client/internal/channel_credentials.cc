// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/channel_credentials.h"

#include "grpcpp/security/tls_certificate_provider.h"
#include "grpcpp/security/tls_credentials_options.h"
#include "overtone/core/security/certificate_io.h"

namespace overtone {

absl::Status CheckFiles(const TlsFiles& tls) {
  if (!tls.enabled()) return absl::OkStatus();
  return ReadCertificates({tls.ca_file, tls.certificate_file, tls.key_file}).status();
}

std::shared_ptr<grpc::ChannelCredentials> MakeChannelCredentials(
    const TlsFiles& tls, grpc::ChannelArguments* arguments) {
  if (!tls.enabled()) return grpc::InsecureChannelCredentials();
  if (!tls.server_name.empty()) arguments->SetSslTargetNameOverride(tls.server_name);
  grpc::experimental::TlsChannelCredentialsOptions options;
  options.set_certificate_provider(
      std::make_shared<grpc::experimental::FileWatcherCertificateProvider>(
          tls.key_file, tls.certificate_file, tls.ca_file,
          static_cast<unsigned int>(absl::ToInt64Seconds(tls.reload_every))));
  options.watch_root_certs();
  options.watch_identity_key_cert_pairs();
  return grpc::experimental::TlsCredentials(options);
}

}  // namespace overtone
