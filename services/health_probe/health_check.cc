// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/health_probe/health_check.h"

#include <memory>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "grpc/health/v1/health.grpc.pb.h"
#include "grpcpp/create_channel.h"
#include "grpcpp/security/credentials.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

using grpc::health::v1::Health;
using grpc::health::v1::HealthCheckRequest;
using grpc::health::v1::HealthCheckResponse;

absl::StatusOr<std::shared_ptr<grpc::Channel>> Connect(const HealthCheckOptions& options) {
  const CertificateFiles& files = options.tls;
  if (files.ca_file.empty() && files.certificate_file.empty() && files.key_file.empty()) {
    return grpc::CreateChannel(options.server, grpc::InsecureChannelCredentials());
  }
  ASSIGN_OR_RETURN(const Certificates tls, ReadCertificates(files));
  grpc::ChannelArguments arguments;
  if (!options.server_name.empty()) arguments.SetSslTargetNameOverride(options.server_name);
  return grpc::CreateCustomChannel(
      options.server, grpc::SslCredentials({tls.ca_pem, tls.key_pem, tls.certificate_pem}),
      arguments);
}

}  // namespace

absl::Status CheckHealth(const HealthCheckOptions& options) {
  ASSIGN_OR_RETURN(const std::shared_ptr<grpc::Channel> channel, Connect(options));
  grpc::ClientContext context;
  context.set_deadline(absl::ToChronoTime(absl::Now() + options.timeout));
  HealthCheckRequest request;
  request.set_service(options.service);
  HealthCheckResponse response;
  const grpc::Status status = Health::NewStub(channel)->Check(&context, request, &response);
  if (status.error_code() == grpc::StatusCode::NOT_FOUND) {
    return absl::NotFoundError(absl::StrCat("the server has no service \"", options.service, "\""));
  }
  if (!status.ok()) {
    return absl::UnavailableError(absl::StrCat(options.server, ": ", status.error_message()));
  }
  if (response.status() == HealthCheckResponse::SERVING) return absl::OkStatus();
  return absl::UnavailableError(absl::StrCat(options.server, " does not serve"));
}

}  // namespace overtone
