// SPDX-License-Identifier: Apache-2.0
// The three files of one end of mutual TLS, checked before they are used.
#ifndef OVERTONE_CORE_SECURITY_CERTIFICATE_IO_H_
#define OVERTONE_CORE_SECURITY_CERTIFICATE_IO_H_

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"

namespace overtone {

// Paths of PEM files.
struct CertificateFiles {
  std::string ca_file;           // whom we trust; may hold several
  std::string certificate_file;  // our own, then what leads from it to the CA
  std::string key_file;          // of our certificate, without a passphrase
};

// What was in them.
struct Certificates {
  std::string ca_pem;
  std::string certificate_pem;
  std::string key_pem;
  absl::Time not_after;  // of our own certificate; it may well have passed

  friend bool operator==(const Certificates& a, const Certificates& b) {
    return a.ca_pem == b.ca_pem && a.certificate_pem == b.certificate_pem && a.key_pem == b.key_pem;
  }
};

// Errors begin with the member that names the file, "key_file: /etc/overtone/server.key: why".
// NotFound: cannot be read. InvalidArgument: empty path, not PEM, or the key is not the
// certificate's.
absl::StatusOr<Certificates> ReadCertificates(const CertificateFiles& files);

// SHA-256 over the first certificate's DER, 64 lower-case hexadecimal digits: what
// `openssl x509 -fingerprint -sha256` prints, without the colons. InvalidArgument: not PEM.
absl::StatusOr<std::string> CertificateFingerprint(absl::string_view pem);

}  // namespace overtone

#endif  // OVERTONE_CORE_SECURITY_CERTIFICATE_IO_H_
