// SPDX-License-Identifier: Apache-2.0
// A certificate authority of one's own, for development and tests. EC P-256 keys, X.509 v3.
#ifndef OVERTONE_CLIENT_CLI_DEVELOPMENT_CERTIFICATES_H_
#define OVERTONE_CLIENT_CLI_DEVELOPMENT_CERTIFICATES_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"

namespace overtone {

struct CertificateAndKey {
  std::string certificate_pem;
  std::string key_pem;
};

// Which end of a connection a certificate may stand at.
enum class CertificateUse { kClient, kServer };

struct CertificateRequest {
  CertificateUse use = CertificateUse::kClient;
  std::string common_name;  // for people
  std::vector<std::string> uris;
  std::vector<std::string> dns;
  std::vector<std::string> ips;
  absl::Time not_before;
  absl::Time not_after;
};

// Signs itself, and may sign others; no other names and no `use` count. Internal: OpenSSL would
// not, with its reason.
absl::StatusOr<CertificateAndKey> MakeCertificateAuthority(const CertificateRequest& request);

// For one end of a connection. InvalidArgument: a name that is none, or a CA that is not PEM.
absl::StatusOr<CertificateAndKey> IssueCertificate(const CertificateAndKey& authority,
                                                   const CertificateRequest& request);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_DEVELOPMENT_CERTIFICATES_H_
