// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/health_check.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/synchronization/notification.h"
#include "google/protobuf/empty.pb.h"
#include "google/protobuf/unknown_field_set.h"
#include "grpcpp/generic/generic_stub.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/status_conversion.h"

namespace overtone {
namespace {

using google::protobuf::Empty;
using google::protobuf::UnknownField;

constexpr int kServiceField = 1;  // of HealthCheckRequest, a string
constexpr int kStatusField = 1;   // of HealthCheckResponse, an enum

std::string StatusName(uint64_t status) {
  static constexpr const char* kNames[] = {"UNKNOWN", "SERVING", "NOT_SERVING", "SERVICE_UNKNOWN"};
  return status < 4 ? kNames[status] : absl::StrCat("status ", status);
}

}  // namespace

// A message of nothing but fields that it does not know is as good as any.
absl::StatusOr<std::string> CheckHealth(const std::shared_ptr<grpc::Channel>& channel,
                                        grpc::ClientContext& context, const std::string& service) {
  Empty message;
  if (!service.empty()) {
    message.GetReflection()->MutableUnknownFields(&message)->AddLengthDelimited(kServiceField,
                                                                                service);
  }
  const grpc::Slice slice(message.SerializeAsString());
  const grpc::ByteBuffer request(&slice, 1);
  grpc::ByteBuffer response;
  grpc::Status status;
  absl::Notification done;
  grpc::GenericStub(channel).UnaryCall(&context, "/grpc.health.v1.Health/Check", {}, &request,
                                       &response, [&](grpc::Status ended) {
                                         status = std::move(ended);
                                         done.Notify();
                                       });
  done.WaitForNotification();
  RETURN_IF_ERROR(FromGrpcStatus(status));
  grpc::Slice bytes;
  if (!response.DumpToSingleSlice(&bytes).ok() ||
      !message.ParseFromArray(bytes.begin(), static_cast<int>(bytes.size()))) {
    return absl::InternalError("the answer is no HealthCheckResponse");
  }
  uint64_t health = 0;  // which is left out on the wire
  const auto& fields = message.GetReflection()->GetUnknownFields(message);
  for (int i = 0; i < fields.field_count(); ++i) {
    const UnknownField& field = fields.field(i);
    if (field.number() == kStatusField && field.type() == UnknownField::TYPE_VARINT) {
      health = field.varint();
    }
  }
  return StatusName(health);
}

}  // namespace overtone
