// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SECURITY_SECURITY_OPTIONS_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SECURITY_SECURITY_OPTIONS_H_

#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "overtone/core/security/certificate_io.h"

namespace overtone {

// Who may come in. Either nothing is given and the server listens on loopback only, or all files.
struct SecurityOptions {
  // PEM, reloaded when they change. All three switch mutual TLS on.
  CertificateFiles files;
  // Take <id>.robot.<domain> and <name>.operator.<domain> for an identity, for CAs that issue no
  // spiffe:// names. Off: a host's DNS name should not make it a robot by accident.
  bool accept_dns_names = false;
  // Who may do what on which map (access_file.h), reloaded when it changes. With TLS only.
  std::string access_file;
  // How often the files are looked at.
  double reload_s = 10.0;
  // Serve without TLS where others can reach us.
  bool insecure = false;

  bool tls() const {
    return !files.ca_file.empty() || !files.certificate_file.empty() || !files.key_file.empty();
  }

  // For a server that listens there. InvalidArgument naming the option as in the configuration
  // file. Reads no file.
  absl::Status Validate(absl::string_view listen) const;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SECURITY_SECURITY_OPTIONS_H_
