// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/health_check.h"

#include "absl/strings/str_cat.h"
#include "grpc/health/v1/health.grpc.pb.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/status_conversion.h"

namespace overtone {

absl::StatusOr<std::string> CheckHealth(const std::shared_ptr<grpc::Channel>& channel,
                                        grpc::ClientContext& context, const std::string& service) {
  grpc::health::v1::HealthCheckRequest request;
  request.set_service(service);
  grpc::health::v1::HealthCheckResponse response;
  const auto stub = grpc::health::v1::Health::NewStub(channel);
  RETURN_IF_ERROR(FromGrpcStatus(stub->Check(&context, request, &response)));
  const std::string name =
      grpc::health::v1::HealthCheckResponse::ServingStatus_Name(response.status());
  return name.empty() ? absl::StrCat("status ", response.status()) : name;  // of a later schema
}

}  // namespace overtone
