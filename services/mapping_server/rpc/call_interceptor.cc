// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/rpc/call_interceptor.h"

#include <map>

#include "overtone/proto/conversion/status_conversion.h"
#include "overtone/services/mapping_server/log_fields.h"
#include "overtone/services/mapping_server/log_limit.h"
#include "overtone/services/mapping_server/request_id.h"
#include "overtone/services/mapping_server/rpc/call_fields.h"

namespace overtone {
namespace {

using grpc::experimental::InterceptionHookPoints;

// The end of a call that nobody did wrong: a reader that has had enough, a server that goes.
bool IsOrdinaryEnd(grpc::StatusCode code) {
  return code == grpc::StatusCode::OK || code == grpc::StatusCode::CANCELLED;
}

// Our own failures, against what a peer may bring about.
spdlog::level::level_enum LevelOf(grpc::StatusCode code) {
  switch (code) {
    case grpc::StatusCode::INTERNAL:
    case grpc::StatusCode::UNKNOWN:
    case grpc::StatusCode::DATA_LOSS:
      return spdlog::level::err;
    default:
      return spdlog::level::info;
  }
}

}  // namespace

CallInterceptor::CallInterceptor(MethodMetrics* metrics, grpc::experimental::ServerRpcInfo* info)
    : metrics_(metrics), info_(info) {
  ++metrics_->started;
  ++metrics_->in_progress;
}

CallInterceptor::~CallInterceptor() {
  --metrics_->in_progress;
  CallFields::Get().Take(info_->server_context());
  if (ended_) return;
  // It never came to a status: the peer went away.
  const std::chrono::duration<double> duration = Clock::now() - begin_;
  metrics_->duration_s[grpc::StatusCode::CANCELLED].Observe(duration.count());
}

void CallInterceptor::Intercept(Methods* methods) {
  if (methods->QueryInterceptionHookPoint(InterceptionHookPoints::POST_RECV_INITIAL_METADATA)) {
    OnReceivedMetadata(methods);
  }
  if (methods->QueryInterceptionHookPoint(InterceptionHookPoints::PRE_SEND_INITIAL_METADATA)) {
    methods->GetSendInitialMetadata()->insert({kRequestIdKey, request_id_});
  }
  if (methods->QueryInterceptionHookPoint(InterceptionHookPoints::PRE_SEND_STATUS)) {
    OnStatus(methods);
  }
  methods->Proceed();
}

void CallInterceptor::OnReceivedMetadata(Methods* methods) {
  std::multimap<grpc::string_ref, grpc::string_ref>& metadata = *methods->GetRecvInitialMetadata();
  const auto [first, last] = metadata.equal_range(kRequestIdKey);
  if (first != last && IsRequestId({first->second.data(), first->second.size()})) {
    request_id_.assign(first->second.data(), first->second.size());
  } else {
    request_id_ = NewRequestId();
  }
  metadata.erase(first, last);
  metadata.emplace(kRequestIdKey, request_id_);  // which lives as long as the call
}

void CallInterceptor::OnStatus(Methods* methods) {
  const grpc::Status status = methods->GetSendStatus();
  const std::chrono::duration<double> duration = Clock::now() - begin_;
  const int code = status.error_code();
  const bool known = code >= 0 && code < kStatusCodes;
  metrics_->duration_s[known ? code : grpc::StatusCode::UNKNOWN].Observe(duration.count());
  ended_ = true;
  if (status.ok()) return;
  methods->GetSendTrailingMetadata()->insert({kRequestIdKey, request_id_});
  methods->ModifySendStatus(WithRequestId(status, request_id_));
  Log(status);
}

void CallInterceptor::Log(const grpc::Status& status) const {
  if (IsOrdinaryEnd(status.error_code())) return;
  // A stream's are those of the thread that ends it.
  LogFields fields = CallFields::Get().Take(info_->server_context());
  if (fields.map.empty() && LogScope::Fields() != nullptr) fields = *LogScope::Fields();
  fields.request_id = request_id_;
  const LogScope scope(&fields);
  const std::string code = CodeName(status.error_code());
  LogPeer(LevelOf(status.error_code()), code.c_str(), "{} from {} refused: {}: {}", metrics_->name,
          HeaderSafe(info_->server_context()->peer()), code, HeaderSafe(status.error_message()));
}

}  // namespace overtone
