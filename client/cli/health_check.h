// SPDX-License-Identifier: Apache-2.0
// grpc.health.v1.Health/Check.
#ifndef OVERTONE_CLIENT_CLI_HEALTH_CHECK_H_
#define OVERTONE_CLIENT_CLI_HEALTH_CHECK_H_

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "grpcpp/channel.h"
#include "grpcpp/client_context.h"

namespace overtone {

// "SERVING", "NOT_SERVING", "UNKNOWN" or "SERVICE_UNKNOWN". An empty `service` is the server as a
// whole. The call's own error; NotFound: no such service.
absl::StatusOr<std::string> CheckHealth(const std::shared_ptr<grpc::Channel>& channel,
                                        grpc::ClientContext& context, const std::string& service);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_HEALTH_CHECK_H_
