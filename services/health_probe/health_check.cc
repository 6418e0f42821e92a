// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/health_probe/health_check.h"

#include <memory>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "grpcpp/create_channel.h"
#include "grpcpp/generic/generic_stub.h"
#include "grpcpp/security/credentials.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

constexpr size_t kMaxServiceName = 127;  // one byte of length

// Debian ships no stubs of grpc.health.v1: its two messages have one field each.
// HealthCheckRequest{string service = 1}
grpc::ByteBuffer Request(const std::string& service) {
  const grpc::Slice bytes(
      absl::StrCat("\x0a", std::string(1, static_cast<char>(service.size())), service));
  return grpc::ByteBuffer(&bytes, 1);
}

// HealthCheckResponse{ServingStatus status = 1}, where SERVING is 1 and 0 is left out.
bool IsServing(const grpc::ByteBuffer& response) {
  grpc::Slice bytes;
  return response.DumpToSingleSlice(&bytes).ok() && bytes.size() >= 2 && bytes.begin()[0] == 0x08 &&
         bytes.begin()[1] == 1;
}

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

grpc::Status Call(const std::shared_ptr<grpc::Channel>& channel, const HealthCheckOptions& options,
                  grpc::ByteBuffer* response) {
  grpc::ClientContext context;
  context.set_deadline(absl::ToChronoTime(absl::Now() + options.timeout));
  grpc::CompletionQueue queue;
  grpc::GenericStub stub(channel);
  const auto call = stub.PrepareUnaryCall(&context, "/grpc.health.v1.Health/Check",
                                          Request(options.service), &queue);
  grpc::Status status;
  call->StartCall();
  call->Finish(response, &status, nullptr);
  void* tag = nullptr;
  bool ok = false;
  queue.Next(&tag, &ok);  // the deadline ends it
  return status;
}

}  // namespace

absl::Status CheckHealth(const HealthCheckOptions& options) {
  if (options.service.size() > kMaxServiceName) {
    return absl::InvalidArgumentError(
        absl::StrCat("service: longer than ", kMaxServiceName, " bytes"));
  }
  ASSIGN_OR_RETURN(const std::shared_ptr<grpc::Channel> channel, Connect(options));
  grpc::ByteBuffer response;
  const grpc::Status status = Call(channel, options, &response);
  if (status.error_code() == grpc::StatusCode::NOT_FOUND) {
    return absl::NotFoundError(absl::StrCat("the server has no service \"", options.service, "\""));
  }
  if (!status.ok()) {
    return absl::UnavailableError(absl::StrCat(options.server, ": ", status.error_message()));
  }
  if (IsServing(response)) return absl::OkStatus();
  return absl::UnavailableError(absl::StrCat(options.server, " does not serve"));
}

}  // namespace overtone
