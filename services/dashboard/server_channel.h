// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_SERVICES_DASHBOARD_SERVER_CHANNEL_H_
#define OVERTONE_SERVICES_DASHBOARD_SERVER_CHANNEL_H_

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "grpcpp/channel.h"
#include "overtone/core/security/certificate_io.h"

namespace overtone {

// The mapping server, and our end of mutual TLS with it.
struct ServerConnection {
  std::string server = "localhost:7077";  // host:port
  CertificateFiles files;                 // all three, or none: plaintext
  std::string server_name;                // of its certificate, when not that of `server`
  bool insecure = false;                  // plaintext to another host

  bool has_certificates() const {
    return !files.ca_file.empty() || !files.certificate_file.empty() || !files.key_file.empty();
  }
  // InvalidArgument, naming the flag. Reads no file.
  absl::Status Validate() const;
};

// Connects when it is first used, and again whenever the link is lost. Files that are replaced are
// read again; those that are bad now are refused, with the flag's name.
absl::StatusOr<std::shared_ptr<grpc::Channel>> MakeServerChannel(
    const ServerConnection& connection);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_DASHBOARD_SERVER_CHANNEL_H_
