// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/rpc/call_fields.h"

#include <utility>

namespace overtone {

CallFields& CallFields::Get() {
  static auto* const fields = new CallFields();
  return *fields;
}

void CallFields::Set(const grpc::ServerContextBase* call, LogFields fields) {
  absl::MutexLock lock(&mutex_);
  fields_[call] = std::move(fields);
}

LogFields CallFields::Take(const grpc::ServerContextBase* call) {
  absl::MutexLock lock(&mutex_);
  const auto it = fields_.find(call);
  if (it == fields_.end()) return LogFields();
  LogFields fields = std::move(it->second);
  fields_.erase(it);
  return fields;
}

}  // namespace overtone
