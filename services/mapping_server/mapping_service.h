// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_MAPPING_SERVICE_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_MAPPING_SERVICE_H_

#include "grpcpp/grpcpp.h"
#include "overtone/services/mapping_server/map_registry.h"
#include "overtone/services/mapping_server/quota/stream_quota.h"
#include "overtone/services/mapping_server/security/access_control.h"
#include "overtone/services/mapping_server/server_options.h"
#include "overtone/services/mapping_server/upload_sessions.h"
#include "overtone/v1/mapping_service.grpc.pb.h"

namespace overtone {

// Callback API for all, and WatchGraph raw: its frames are serialised once for all readers.
using MappingServiceBase = v1::MappingService::WithCallbackMethod_GetServerInfo<
    v1::MappingService::WithCallbackMethod_UploadSubmaps<
        v1::MappingService::WithCallbackMethod_GetUploadState<
            v1::MappingService::WithCallbackMethod_AddLoopClosures<
                v1::MappingService::WithRawCallbackMethod_WatchGraph<
                    v1::MappingService::WithCallbackMethod_GetGraph<
                        v1::MappingService::WithCallbackMethod_ReportStatus<
                            v1::MappingService::Service>>>>>>>;

// The table of contents: what a robot calls, who may and how often, and where it is done. Access
// control, quotas, registry and sessions outlive the service.
class MappingService final : public MappingServiceBase {
 public:
  MappingService(const ServerOptions& options, AccessControl* access, RobotQuotas* quotas,
                 MapRegistry* registry, UploadSessions* sessions);

  grpc::ServerUnaryReactor* GetServerInfo(grpc::CallbackServerContext* context,
                                          const v1::GetServerInfoRequest* request,
                                          v1::GetServerInfoResponse* response) override;
  grpc::ServerBidiReactor<v1::UploadSubmapsRequest, v1::UploadSubmapsResponse>* UploadSubmaps(
      grpc::CallbackServerContext* context) override;
  grpc::ServerUnaryReactor* GetUploadState(grpc::CallbackServerContext* context,
                                           const v1::GetUploadStateRequest* request,
                                           v1::GetUploadStateResponse* response) override;
  grpc::ServerUnaryReactor* AddLoopClosures(grpc::CallbackServerContext* context,
                                            const v1::AddLoopClosuresRequest* request,
                                            v1::AddLoopClosuresResponse* response) override;
  grpc::ServerWriteReactor<grpc::ByteBuffer>* WatchGraph(grpc::CallbackServerContext* context,
                                                         const grpc::ByteBuffer* request) override;
  grpc::ServerUnaryReactor* GetGraph(grpc::CallbackServerContext* context,
                                     const v1::GetGraphRequest* request,
                                     v1::GetGraphResponse* response) override;
  grpc::ServerUnaryReactor* ReportStatus(grpc::CallbackServerContext* context,
                                         const v1::ReportStatusRequest* request,
                                         v1::ReportStatusResponse* response) override;

 private:
  // Whether the call is within its caller's quota, and then `allowed`.
  absl::Status Admit(const grpc::CallbackServerContext& context, const absl::Status& allowed,
                     absl::string_view robot = "") const;
  StreamQuota Quota(const grpc::CallbackServerContext& context) const;

  const ServerOptions options_;
  AccessControl* const access_;
  RobotQuotas* const quotas_;
  MapRegistry* const registry_;
  UploadSessions* const sessions_;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_MAPPING_SERVICE_H_
