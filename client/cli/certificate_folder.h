// SPDX-License-Identifier: Apache-2.0
// What `overtone certs` keeps in a folder: a CA, certificates, and the server's access file.
#ifndef OVERTONE_CLIENT_CLI_CERTIFICATE_FOLDER_H_
#define OVERTONE_CLIENT_CLI_CERTIFICATE_FOLDER_H_

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"

namespace overtone {

struct CertificateFolderOptions {
  std::string folder = "certs";
  std::vector<std::string> server_names = {"localhost", "127.0.0.1", "::1"};  // DNS or IP
  std::vector<std::string> robots;
  std::vector<std::string> operators;
  std::string map = "default";
  std::string trust_domain = "overtone.local";
  int days = 365;
  bool force = false;  // make everything anew, the CA too

  // InvalidArgument naming the flag.
  absl::Status Validate() const;
};

struct CertificateFolderChanges {
  std::vector<std::string> written;  // files
  std::vector<std::string> kept;
};

// Writes what is not there yet: ca.{crt,key}, server.{crt,key}, robot-<id>.{crt,key},
// operator-<name>.{crt,key} and access.yaml. Keys are readable to their owner only. A file that is
// there is kept, unless `force`. FailedPrecondition: one half of a pair is there without the other.
// Unavailable: the folder cannot be written.
absl::StatusOr<CertificateFolderChanges> FillCertificateFolder(
    const CertificateFolderOptions& options, absl::Time now);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_CERTIFICATE_FOLDER_H_
