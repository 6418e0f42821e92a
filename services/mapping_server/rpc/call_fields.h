// SPDX-License-Identifier: Apache-2.0
// What a unary call is about, for the line that its refusal gets: its handler knows, and its
// interceptor writes it after the handler has returned.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_RPC_CALL_FIELDS_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_RPC_CALL_FIELDS_H_

#include "absl/base/thread_annotations.h"
#include "absl/container/flat_hash_map.h"
#include "absl/synchronization/mutex.h"
#include "grpcpp/grpcpp.h"
#include "overtone/services/mapping_server/log_fields.h"

namespace overtone {

// By call, until it ends. Thread-safe.
class CallFields {
 public:
  // Of the process, as the log is.
  static CallFields& Get();

  // To be called by a handler, at most once. Only where there is an interceptor, which clears up.
  void Set(const grpc::ServerContextBase* call, LogFields fields);
  // Empty fields when nothing was set; afterwards nothing is.
  LogFields Take(const grpc::ServerContextBase* call);

 private:
  absl::Mutex mutex_;
  absl::flat_hash_map<const grpc::ServerContextBase*, LogFields> fields_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_RPC_CALL_FIELDS_H_
