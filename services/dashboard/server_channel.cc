// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/dashboard/server_channel.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "grpcpp/create_channel.h"
#include "grpcpp/security/credentials.h"
#include "grpcpp/security/tls_certificate_provider.h"
#include "grpcpp/security/tls_credentials_options.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/security/loopback_address.h"

namespace overtone {
namespace {

constexpr int kMaxMessageBytes = 256 << 20;  // a trajectory of a million keyframes
constexpr int kMaxReconnectBackoffMs = 5'000;
constexpr unsigned kReloadS = 10;

std::shared_ptr<grpc::ChannelCredentials> Credentials(const ServerConnection& connection) {
  if (!connection.has_certificates()) return grpc::InsecureChannelCredentials();
  grpc::experimental::TlsChannelCredentialsOptions options;
  options.set_certificate_provider(
      std::make_shared<grpc::experimental::FileWatcherCertificateProvider>(
          connection.files.key_file, connection.files.certificate_file, connection.files.ca_file,
          kReloadS));
  options.watch_root_certs();
  options.watch_identity_key_cert_pairs();
  return grpc::experimental::TlsCredentials(options);
}

absl::Status ByFlag(const absl::Status& status) {
  return absl::Status(status.code(),
                      absl::StrReplaceAll(status.message(), {{"ca_file", "--tls-ca"},
                                                             {"certificate_file", "--tls-cert"},
                                                             {"key_file", "--tls-key"}}));
}

}  // namespace

absl::Status ServerConnection::Validate() const {
  if (server.empty()) return absl::InvalidArgumentError("--server: empty; host:port is needed");
  if (has_certificates()) {
    if (insecure) return absl::InvalidArgumentError("--insecure: contradicts the --tls files");
    for (const auto& [flag, file] : {std::make_pair("--tls-ca", files.ca_file),
                                     std::make_pair("--tls-cert", files.certificate_file),
                                     std::make_pair("--tls-key", files.key_file)}) {
      if (file.empty()) {
        return absl::InvalidArgumentError(
            absl::StrCat(flag, ": missing; TLS needs --tls-ca, --tls-cert and --tls-key"));
      }
    }
    return absl::OkStatus();
  }
  if (!server_name.empty()) {
    return absl::InvalidArgumentError(
        "--tls-server-name: without certificates there is no name to check");
  }
  if (insecure || IsLoopback(server)) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      "--tls-ca: missing, and ", server,
      " is another host. Give --tls-ca, --tls-cert and --tls-key, or --insecure where every host "
      "of the network is trusted"));
}

absl::StatusOr<std::shared_ptr<grpc::Channel>> MakeServerChannel(
    const ServerConnection& connection) {
  RETURN_IF_ERROR(connection.Validate());
  if (connection.has_certificates()) {
    RETURN_IF_ERROR(ByFlag(ReadCertificates(connection.files).status()));
  }
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(kMaxMessageBytes);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, kMaxReconnectBackoffMs);
  if (!connection.server_name.empty()) arguments.SetSslTargetNameOverride(connection.server_name);
  return grpc::CreateCustomChannel(connection.server, Credentials(connection), arguments);
}

}  // namespace overtone
