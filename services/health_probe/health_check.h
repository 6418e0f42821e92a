// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_SERVICES_HEALTH_PROBE_HEALTH_CHECK_H_
#define OVERTONE_SERVICES_HEALTH_PROBE_HEALTH_CHECK_H_

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "overtone/core/security/certificate_io.h"

namespace overtone {

struct HealthCheckOptions {
  std::string server = "localhost:7077";  // host:port
  std::string service;                    // grpc.health.v1's: empty for the server as a whole
  CertificateFiles tls;                   // all three, or none: plaintext
  std::string server_name;                // in the server's certificate, where `server` has another
  absl::Duration timeout = absl::Seconds(2);
};

// One grpc.health.v1.Health/Check. Any certificate of the server's CA will do.
// Unavailable: the server says that it does not serve, or cannot be reached in time.
// NotFound: it knows no such service. Errors about the certificates as of ReadCertificates().
absl::Status CheckHealth(const HealthCheckOptions& options);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_HEALTH_PROBE_HEALTH_CHECK_H_
