// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/metrics/rpc_metrics.h"

#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "overtone/v1/map_admin_service.pb.h"
#include "overtone/v1/mapping_service.pb.h"

namespace overtone {

MethodMetrics::MethodMetrics(std::string method_name) : name(std::move(method_name)) {
  for (int code = 0; code < kStatusCodes; ++code) duration_s.emplace_back(kRpcBoundsS);
}

RpcMetrics::RpcMetrics() {
  using google::protobuf::FileDescriptor;
  const FileDescriptor* const files[] = {v1::GetGraphRequest::descriptor()->file(),
                                         v1::ListMapsRequest::descriptor()->file()};
  for (const FileDescriptor* file : files) {
    for (int s = 0; s < file->service_count(); ++s) {
      for (int m = 0; m < file->service(s)->method_count(); ++m) {
        const std::string& service = file->service(s)->name();
        const std::string& method = file->service(s)->method(m)->name();
        methods_.push_back(std::make_unique<MethodMetrics>(absl::StrCat(service, "/", method)));
        by_path_[absl::StrCat("/", file->service(s)->full_name(), "/", method)] =
            methods_.back().get();
      }
    }
  }
  methods_.push_back(std::make_unique<MethodMetrics>("other"));
}

MethodMetrics& RpcMetrics::Of(absl::string_view path) {
  const auto it = by_path_.find(path);
  return it == by_path_.end() ? *methods_.back() : *it->second;
}

std::string CodeName(grpc::StatusCode code) {
  const int number = static_cast<int>(code);
  const bool known = number >= 0 && number < kStatusCodes;
  return absl::StatusCodeToString(known ? static_cast<absl::StatusCode>(number)
                                        : absl::StatusCode::kUnknown);
}

}  // namespace overtone
