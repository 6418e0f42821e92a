// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/mapping_service.h"

#include <string>
#include <utility>

#include "overtone/core/common/status_macros.h"
#include "overtone/services/mapping_server/log_fields.h"
#include "overtone/services/mapping_server/quota/quota_subject.h"
#include "overtone/services/mapping_server/request_id.h"
#include "overtone/services/mapping_server/rpc/call_fields.h"
#include "overtone/services/mapping_server/rpc/report_status.h"
#include "overtone/services/mapping_server/rpc/unary.h"
#include "overtone/services/mapping_server/rpc/upload_submaps.h"
#include "overtone/services/mapping_server/rpc/watch_graph.h"

namespace overtone {
namespace {

void Describe(const grpc::CallbackServerContext* context, LogFields about) {
  CallFields::Get().Set(context, std::move(about));
}

}  // namespace

MappingService::MappingService(const ServerOptions& options, AccessControl* access,
                               RobotQuotas* quotas, MapRegistry* registry, UploadSessions* sessions)
    : options_(options),
      access_(access),
      quotas_(quotas),
      registry_(registry),
      sessions_(sessions) {}

absl::Status MappingService::Admit(const grpc::CallbackServerContext& context,
                                   const absl::Status& allowed, absl::string_view robot) const {
  const std::string peer = QuotaSubject(context, *access_);
  RETURN_IF_ERROR(quotas_->AdmitCall(QuotaSubjectOfRobot(peer, robot)));
  return allowed;
}

StreamQuota MappingService::Quota(const grpc::CallbackServerContext& context) const {
  return StreamQuota(quotas_, QuotaSubject(context, *access_));
}

grpc::ServerUnaryReactor* MappingService::GetServerInfo(grpc::CallbackServerContext* context,
                                                        const v1::GetServerInfoRequest*,
                                                        v1::GetServerInfoResponse* response) {
  return Guarded(context, Admit(*context, absl::OkStatus()),
                 [&] { return Answer(context, ServerInfo(options_), response); });
}

grpc::ServerBidiReactor<v1::UploadSubmapsRequest, v1::UploadSubmapsResponse>*
MappingService::UploadSubmaps(grpc::CallbackServerContext* context) {
  return overtone::UploadSubmaps::Start(StreamAccess(access_, *context), Quota(*context), registry_,
                                        sessions_, options_.limits, RequestIdOf(*context));
}

grpc::ServerUnaryReactor* MappingService::GetUploadState(grpc::CallbackServerContext* context,
                                                         const v1::GetUploadStateRequest* request,
                                                         v1::GetUploadStateResponse* response) {
  const std::string& robot = request->mission().robot();
  Describe(context, LogFieldsOf(request->map(), robot, request->mission().mission()));
  const absl::Status may = access_->MayWrite(*context, request->map(), robot, "");
  return Guarded(context, Admit(*context, may, robot), [&] {
    return Answer(context, overtone::GetUploadState(*registry_, *request), response);
  });
}

grpc::ServerUnaryReactor* MappingService::AddLoopClosures(grpc::CallbackServerContext* context,
                                                          const v1::AddLoopClosuresRequest* request,
                                                          v1::AddLoopClosuresResponse* response) {
  Describe(context, LogFieldsOf(request->map()));
  const absl::Status may = access_->MayAddClosures(*context, *request);
  return Guarded(context, Admit(*context, may), [&] {
    return overtone::AddLoopClosures(context, *registry_, *request, response);
  });
}

grpc::ServerWriteReactor<grpc::ByteBuffer>* MappingService::WatchGraph(
    grpc::CallbackServerContext* context, const grpc::ByteBuffer* request) {
  return overtone::WatchGraph::Start(StreamAccess(access_, *context), Quota(*context), registry_,
                                     options_, *request);
}

grpc::ServerUnaryReactor* MappingService::GetGraph(grpc::CallbackServerContext* context,
                                                   const v1::GetGraphRequest* request,
                                                   v1::GetGraphResponse* response) {
  Describe(context, LogFieldsOf(request->map()));
  const absl::Status may = access_->MayRead(*context, request->map());
  return Guarded(context, Admit(*context, may), [&] {
    return overtone::GetGraph(context, *registry_, options_.graph.max_nodes, *request, response);
  });
}

grpc::ServerUnaryReactor* MappingService::ReportStatus(grpc::CallbackServerContext* context,
                                                       const v1::ReportStatusRequest* request,
                                                       v1::ReportStatusResponse* response) {
  const std::string& robot = request->mission().robot();
  Describe(context, LogFieldsOf(request->map(), robot, request->mission().mission()));
  const absl::Status may = access_->MayWrite(*context, request->map(), robot, "");
  return Guarded(context, Admit(*context, may, robot), [&] {
    return Answer(context, overtone::ReportStatus(*registry_, *request), response);
  });
}

}  // namespace overtone
