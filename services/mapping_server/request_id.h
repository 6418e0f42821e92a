// SPDX-License-Identifier: Apache-2.0
// The name of one call, which its log lines, its answer and its error have in common.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_REQUEST_ID_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_REQUEST_ID_H_

#include <string>

#include "grpcpp/grpcpp.h"
#include "overtone/services/mapping_server/log_fields.h"

namespace overtone {

// The metadata that carries it, in both directions.
inline constexpr char kRequestIdKey[] = "x-request-id";

// 16 hexadecimal digits, not given before by this process, hardly by another. Thread-safe.
std::string NewRequestId();

// Of the call as the interceptor has seen it (call_interceptor.h): the peer's own if it had a sane
// one, else the server's; empty where there is no interceptor.
std::string RequestIdOf(const grpc::CallbackServerContext& context);

// What the log's lines about a call say.
LogFields AboutCall(const grpc::CallbackServerContext& context, const std::string& map);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_REQUEST_ID_H_
