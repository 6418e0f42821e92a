// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_MAP_ADMIN_SERVICE_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_MAP_ADMIN_SERVICE_H_

#include "grpcpp/grpcpp.h"
#include "overtone/services/mapping_server/cloud_exporter.h"
#include "overtone/services/mapping_server/map_maintenance.h"
#include "overtone/services/mapping_server/map_registry.h"
#include "overtone/services/mapping_server/security/access_control.h"
#include "overtone/services/mapping_server/upload_sessions.h"
#include "overtone/v1/map_admin_service.grpc.pb.h"

namespace overtone {

// The table of contents: what an operator calls. Every call asks for the right to administer its
// map first. All that it is given outlives the service.
class MapAdminService final : public v1::MapAdminService::CallbackService {
 public:
  MapAdminService(int64_t max_message_bytes, v1::GetConfigurationResponse configuration,
                  const AccessControl* access, const MapRegistry* registry,
                  const UploadSessions* sessions, MapMaintenance* maintenance);

  grpc::ServerUnaryReactor* ListMaps(grpc::CallbackServerContext* context,
                                     const v1::ListMapsRequest* request,
                                     v1::ListMapsResponse* response) override;
  grpc::ServerUnaryReactor* ListRobots(grpc::CallbackServerContext* context,
                                       const v1::ListRobotsRequest* request,
                                       v1::ListRobotsResponse* response) override;
  grpc::ServerUnaryReactor* ListMissions(grpc::CallbackServerContext* context,
                                         const v1::ListMissionsRequest* request,
                                         v1::ListMissionsResponse* response) override;
  grpc::ServerUnaryReactor* ListLoopClosures(grpc::CallbackServerContext* context,
                                             const v1::ListLoopClosuresRequest* request,
                                             v1::ListLoopClosuresResponse* response) override;
  grpc::ServerUnaryReactor* ExplainLoopClosures(grpc::CallbackServerContext* context,
                                                const v1::ExplainLoopClosuresRequest* request,
                                                v1::ExplainLoopClosuresResponse* response) override;
  grpc::ServerUnaryReactor* VetoLoopClosure(grpc::CallbackServerContext* context,
                                            const v1::VetoLoopClosureRequest* request,
                                            v1::VetoLoopClosureResponse* response) override;
  grpc::ServerUnaryReactor* ForceLoopClosure(grpc::CallbackServerContext* context,
                                             const v1::ForceLoopClosureRequest* request,
                                             v1::ForceLoopClosureResponse* response) override;
  grpc::ServerUnaryReactor* ListRevisions(grpc::CallbackServerContext* context,
                                          const v1::ListRevisionsRequest* request,
                                          v1::ListRevisionsResponse* response) override;
  grpc::ServerUnaryReactor* RollBack(grpc::CallbackServerContext* context,
                                     const v1::RollBackRequest* request,
                                     v1::RollBackResponse* response) override;
  grpc::ServerUnaryReactor* GetTrajectory(grpc::CallbackServerContext* context,
                                          const v1::GetTrajectoryRequest* request,
                                          v1::GetTrajectoryResponse* response) override;
  grpc::ServerUnaryReactor* GetStatusReport(grpc::CallbackServerContext* context,
                                            const v1::GetStatusReportRequest* request,
                                            v1::GetStatusReportResponse* response) override;
  grpc::ServerUnaryReactor* GetConfiguration(grpc::CallbackServerContext* context,
                                             const v1::GetConfigurationRequest* request,
                                             v1::GetConfigurationResponse* response) override;
  grpc::ServerWriteReactor<v1::ExportMapResponse>* ExportMap(
      grpc::CallbackServerContext* context, const v1::ExportMapRequest* request) override;
  grpc::ServerWriteReactor<v1::BackupMapResponse>* BackupMap(
      grpc::CallbackServerContext* context, const v1::BackupMapRequest* request) override;
  grpc::ServerReadReactor<v1::RestoreMapRequest>* RestoreMap(
      grpc::CallbackServerContext* context, v1::RestoreMapResponse* response) override;
  grpc::ServerUnaryReactor* VerifyMap(grpc::CallbackServerContext* context,
                                      const v1::VerifyMapRequest* request,
                                      v1::VerifyMapResponse* response) override;
  grpc::ServerUnaryReactor* DeleteMission(grpc::CallbackServerContext* context,
                                          const v1::DeleteMissionRequest* request,
                                          v1::DeleteMissionResponse* response) override;
  grpc::ServerUnaryReactor* DeleteMap(grpc::CallbackServerContext* context,
                                      const v1::DeleteMapRequest* request,
                                      v1::DeleteMapResponse* response) override;

 private:
  // Makes the call if the caller may administer the map that the request names.
  template <typename Request, typename Call>
  grpc::ServerUnaryReactor* Administer(grpc::CallbackServerContext* context, const Request& request,
                                       Call call) const;

  const int64_t max_message_bytes_;
  const v1::GetConfigurationResponse configuration_;
  const AccessControl* const access_;
  const MapRegistry* const registry_;
  const UploadSessions* const sessions_;
  MapMaintenance* const maintenance_;
  CloudExporter exporter_;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_MAP_ADMIN_SERVICE_H_
