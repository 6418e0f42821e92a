// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SECURITY_SERVER_SECURITY_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SECURITY_SERVER_SECURITY_H_

#include <memory>
#include <string>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "grpcpp/security/server_credentials.h"
#include "overtone/services/mapping_server/security/access_control.h"
#include "overtone/services/mapping_server/security/periodic_task.h"
#include "overtone/services/mapping_server/security/security_options.h"
#include "overtone/services/mapping_server/security/tls_server_credentials.h"

namespace overtone {

// The files of SecurityOptions, read at the start and whenever they change. Outlives the server
// that it makes credentials for. Thread-safe.
class ServerSecurity {
 public:
  // An error names the option, "tls.key_file: ..." or "access_file: ...".
  static absl::StatusOr<std::unique_ptr<ServerSecurity>> Create(const SecurityOptions& options);

  AccessControl* access() { return &access_; }
  std::shared_ptr<grpc::ServerCredentials> Credentials();

  // Looks at the files now. Bad ones are logged, once for each reason, and what was in force stays.
  // New certificates count for new connections, new rules for every call and for open streams.
  void Reload();

 private:
  ServerSecurity(const SecurityOptions& options, Certificates certificates, AccessRules rules);
  explicit ServerSecurity(const SecurityOptions& options) : options_(options) {}

  // The result of reading one of the files; remembers in `last_error` what was logged.
  static void Log(const char* what, const absl::StatusOr<bool>& changed, std::string& last_error);
  absl::StatusOr<bool> ReloadCertificates() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  absl::StatusOr<bool> ReloadRules() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const SecurityOptions options_;
  std::unique_ptr<ServingCertificates> certificates_;  // null: no TLS
  AccessControl access_;
  absl::Mutex mutex_;  // one reload at a time
  AccessRules rules_ ABSL_GUARDED_BY(mutex_);
  std::string certificates_error_ ABSL_GUARDED_BY(mutex_);
  std::string rules_error_ ABSL_GUARDED_BY(mutex_);
  std::unique_ptr<PeriodicTask> reload_;  // last: it uses all the rest
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SECURITY_SERVER_SECURITY_H_
