// SPDX-License-Identifier: Apache-2.0
// gRPC's end of the server's mutual TLS.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SECURITY_TLS_SERVER_CREDENTIALS_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SECURITY_TLS_SERVER_CREDENTIALS_H_

#include <memory>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "grpcpp/security/server_credentials.h"
#include "overtone/core/security/certificate_io.h"
#include "overtone/services/mapping_server/security/access_control.h"

namespace overtone {

// The certificates that the next handshake uses. Thread-safe.
class ServingCertificates {
 public:
  explicit ServingCertificates(Certificates certificates)
      : certificates_(std::move(certificates)) {}

  // False: they are the ones that we have.
  bool Set(Certificates certificates);
  // What is new since the last call, the first time all.
  absl::optional<Certificates> TakeNew();

 private:
  absl::Mutex mutex_;
  Certificates certificates_ ABSL_GUARDED_BY(mutex_);
  bool taken_ ABSL_GUARDED_BY(mutex_) = false;
};

// TLS 1.2 or 1.3 with a client certificate that the CA has signed, or no connection; and for every
// call, of whatever service, an identity (AccessControl::Authenticate), or UNAUTHENTICATED. For one
// server with one port. `certificates` and `access` outlive that server.
//
// Not gRPC's experimental TlsServerCredentials with their file watcher: in 1.51 that one drops the
// certificates it has before it looks at the new ones, so that a half-written file closes the door
// on everybody.
std::shared_ptr<grpc::ServerCredentials> MakeTlsServerCredentials(ServingCertificates* certificates,
                                                                  const AccessControl* access);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SECURITY_TLS_SERVER_CREDENTIALS_H_
