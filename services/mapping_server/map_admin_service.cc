// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/map_admin_service.h"

#include <utility>

#include "overtone/services/mapping_server/closure_listing.h"
#include "overtone/services/mapping_server/map_listing.h"
#include "overtone/services/mapping_server/rpc/backup_map.h"
#include "overtone/services/mapping_server/rpc/call_fields.h"
#include "overtone/services/mapping_server/rpc/decisions.h"
#include "overtone/services/mapping_server/rpc/export_map.h"
#include "overtone/services/mapping_server/rpc/housekeeping.h"
#include "overtone/services/mapping_server/rpc/report_status.h"
#include "overtone/services/mapping_server/rpc/restore_map.h"
#include "overtone/services/mapping_server/rpc/unary.h"

namespace overtone {

MapAdminService::MapAdminService(int64_t max_message_bytes,
                                 v1::GetConfigurationResponse configuration,
                                 const AccessControl* access, const MapRegistry* registry,
                                 const UploadSessions* sessions, MapMaintenance* maintenance)
    : max_message_bytes_(max_message_bytes),
      configuration_(std::move(configuration)),
      access_(access),
      registry_(registry),
      sessions_(sessions),
      maintenance_(maintenance),
      exporter_(registry) {}

template <typename Request, typename Call>
grpc::ServerUnaryReactor* MapAdminService::Administer(grpc::CallbackServerContext* context,
                                                      const Request& request, Call call) const {
  CallFields::Get().Set(context, LogFieldsOf(request.map()));
  return Guarded(context, access_->MayAdminister(*context, request.map()), std::move(call));
}

grpc::ServerUnaryReactor* MapAdminService::ListMaps(grpc::CallbackServerContext* context,
                                                    const v1::ListMapsRequest* request,
                                                    v1::ListMapsResponse* response) {
  const absl::StatusOr<AccessControl::MapFilter> visible = access_->VisibleMaps(*context);
  return Guarded(context, visible.status(), [&] {
    return Answer(context, overtone::ListMaps(*registry_, *visible, *request), response);
  });
}

grpc::ServerUnaryReactor* MapAdminService::ListRobots(grpc::CallbackServerContext* context,
                                                      const v1::ListRobotsRequest* request,
                                                      v1::ListRobotsResponse* response) {
  return Administer(context, *request, [&] {
    return Answer(context, overtone::ListRobots(*registry_, *sessions_, *request), response);
  });
}

grpc::ServerUnaryReactor* MapAdminService::ListMissions(grpc::CallbackServerContext* context,
                                                        const v1::ListMissionsRequest* request,
                                                        v1::ListMissionsResponse* response) {
  return Administer(context, *request, [&] {
    return Answer(context, overtone::ListMissions(*registry_, *request), response);
  });
}

grpc::ServerUnaryReactor* MapAdminService::ListLoopClosures(
    grpc::CallbackServerContext* context, const v1::ListLoopClosuresRequest* request,
    v1::ListLoopClosuresResponse* response) {
  return Administer(context, *request, [&] {
    return Answer(context, overtone::ListLoopClosures(*registry_, *request), response);
  });
}

grpc::ServerUnaryReactor* MapAdminService::ExplainLoopClosures(
    grpc::CallbackServerContext* context, const v1::ExplainLoopClosuresRequest* request,
    v1::ExplainLoopClosuresResponse* response) {
  return Administer(context, *request, [&] {
    return Answer(context, overtone::ExplainLoopClosures(*registry_, *request), response);
  });
}

grpc::ServerUnaryReactor* MapAdminService::ListRevisions(grpc::CallbackServerContext* context,
                                                         const v1::ListRevisionsRequest* request,
                                                         v1::ListRevisionsResponse* response) {
  return Administer(context, *request, [&] {
    return Answer(context, overtone::ListRevisions(*registry_, *request), response);
  });
}

grpc::ServerUnaryReactor* MapAdminService::VetoLoopClosure(
    grpc::CallbackServerContext* context, const v1::VetoLoopClosureRequest* request,
    v1::VetoLoopClosureResponse*) {
  return Administer(context, *request,
                    [&] { return overtone::VetoLoopClosure(context, *registry_, *request); });
}

grpc::ServerUnaryReactor* MapAdminService::ForceLoopClosure(
    grpc::CallbackServerContext* context, const v1::ForceLoopClosureRequest* request,
    v1::ForceLoopClosureResponse*) {
  return Administer(context, *request,
                    [&] { return overtone::ForceLoopClosure(context, *registry_, *request); });
}

grpc::ServerUnaryReactor* MapAdminService::RollBack(grpc::CallbackServerContext* context,
                                                    const v1::RollBackRequest* request,
                                                    v1::RollBackResponse* response) {
  return Administer(context, *request,
                    [&] { return overtone::RollBack(context, *registry_, *request, response); });
}

grpc::ServerUnaryReactor* MapAdminService::GetTrajectory(grpc::CallbackServerContext* context,
                                                         const v1::GetTrajectoryRequest* request,
                                                         v1::GetTrajectoryResponse* response) {
  return Administer(context, *request, [&] {
    return Answer(context, overtone::GetTrajectory(*registry_, *request, max_message_bytes_),
                  response);
  });
}

grpc::ServerUnaryReactor* MapAdminService::GetStatusReport(
    grpc::CallbackServerContext* context, const v1::GetStatusReportRequest* request,
    v1::GetStatusReportResponse* response) {
  return Administer(context, *request, [&] {
    return Answer(context, overtone::GetStatusReport(*registry_, *request), response);
  });
}

grpc::ServerUnaryReactor* MapAdminService::GetConfiguration(
    grpc::CallbackServerContext* context, const v1::GetConfigurationRequest*,
    v1::GetConfigurationResponse* response) {
  return Guarded(context, access_->MayOperate(*context), [&] {
    return Answer<v1::GetConfigurationResponse>(context, configuration_, response);
  });
}

grpc::ServerWriteReactor<v1::ExportMapResponse>* MapAdminService::ExportMap(
    grpc::CallbackServerContext* context, const v1::ExportMapRequest* request) {
  return new overtone::ExportMap(access_->MayAdminister(*context, request->map()), *registry_,
                                 &exporter_, *request);
}

grpc::ServerWriteReactor<v1::BackupMapResponse>* MapAdminService::BackupMap(
    grpc::CallbackServerContext* context, const v1::BackupMapRequest* request) {
  return new overtone::BackupMap(maintenance_, context, request->map(),
                                 access_->MayAdminister(*context, request->map()));
}

grpc::ServerReadReactor<v1::RestoreMapRequest>* MapAdminService::RestoreMap(
    grpc::CallbackServerContext* context, v1::RestoreMapResponse* response) {
  return new overtone::RestoreMap(maintenance_, access_, context, response);
}

grpc::ServerUnaryReactor* MapAdminService::VerifyMap(grpc::CallbackServerContext* context,
                                                     const v1::VerifyMapRequest* request,
                                                     v1::VerifyMapResponse* response) {
  return Administer(context, *request,
                    [&] { return overtone::VerifyMap(context, maintenance_, request, response); });
}

grpc::ServerUnaryReactor* MapAdminService::DeleteMission(grpc::CallbackServerContext* context,
                                                         const v1::DeleteMissionRequest* request,
                                                         v1::DeleteMissionResponse* response) {
  return Administer(context, *request, [&] {
    return overtone::DeleteMission(context, maintenance_, request, response);
  });
}

grpc::ServerUnaryReactor* MapAdminService::DeleteMap(grpc::CallbackServerContext* context,
                                                     const v1::DeleteMapRequest* request,
                                                     v1::DeleteMapResponse* response) {
  return Administer(context, *request,
                    [&] { return overtone::DeleteMap(context, maintenance_, request, response); });
}

}  // namespace overtone
