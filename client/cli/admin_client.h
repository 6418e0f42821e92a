// SPDX-License-Identifier: Apache-2.0
// The operator's end of a mapping server, call by call.
#ifndef OVERTONE_CLIENT_CLI_ADMIN_CLIENT_H_
#define OVERTONE_CLIENT_CLI_ADMIN_CLIENT_H_

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "overtone/client/tls_files.h"
#include "overtone/core/common/ids.h"
#include "overtone/v1/map_admin_service.grpc.pb.h"

namespace overtone {

// Errors are those of server_error.h: Unavailable when the server cannot be reached,
// DeadlineExceeded when it does not answer within `timeout`. A server that comes back is found
// again within a second. Thread-safe.
class AdminClient {
 public:
  AdminClient(std::string server, absl::Duration timeout, const TlsFiles& tls = TlsFiles());

  // What the connection has come to, without asking the server: up, lost (and being made again), or
  // neither yet.
  enum class Link { kUnknown, kUp, kLost };
  Link CheckLink();

  absl::StatusOr<std::vector<v1::MapSummary>> ListMaps();
  // NotFound: no such map.
  absl::StatusOr<v1::MapSummary> GetMap(const std::string& map);
  absl::StatusOr<std::vector<v1::Robot>> ListRobots(const std::string& map);
  absl::StatusOr<std::vector<v1::Mission>> ListMissions(const std::string& map);
  absl::StatusOr<std::vector<v1::LoopClosureStatus>> ListLoopClosures(const std::string& map);
  // The map and filters of `request`; all pages.
  absl::StatusOr<std::vector<v1::LoopClosureStatus>> ListLoopClosures(
      v1::ListLoopClosuresRequest request);
  absl::StatusOr<v1::ExplainLoopClosuresResponse> ExplainLoopClosures(
      const v1::ExplainLoopClosuresRequest& request);
  absl::Status VetoLoopClosure(const std::string& map, const std::string& id);
  absl::Status ForceLoopClosure(const std::string& map, const std::string& id);
  // Newest first.
  absl::StatusOr<std::vector<v1::Revision>> ListRevisions(const std::string& map);
  absl::StatusOr<v1::RollBackResponse> RollBack(const std::string& map, uint64_t revision);
  absl::StatusOr<v1::GetTrajectoryResponse> GetTrajectory(const std::string& map,
                                                          const MissionId& mission,
                                                          bool odometry = false);
  absl::StatusOr<v1::GetConfigurationResponse> GetConfiguration();
  absl::StatusOr<v1::StatusReport> GetStatusReport(const std::string& map,
                                                   const MissionId& mission);
  // `take` has the pieces in their order; its error ends the call and is returned.
  absl::Status ExportMap(const v1::ExportMapRequest& request,
                         const std::function<absl::Status(const std::string& chunk)>& take);
  // Of the service of that name, of the server as a whole without one: what grpc.health.v1 calls
  // "SERVING", "NOT_SERVING", ... NotFound: no such service.
  absl::StatusOr<std::string> Health(const std::string& service);
  // `take` has the pieces in their order; its error ends the call and is returned. DataLoss: what
  // came is not what was announced.
  using TakeChunk = std::function<absl::Status(const v1::BackupHeader&, const std::string& chunk)>;
  absl::StatusOr<v1::BackupHeader> BackupMap(const std::string& map, const TakeChunk& take);
  // `next` gives at most 256 KiB each time, and nothing at the end; its error ends the call and is
  // returned.
  using NextChunk = std::function<absl::StatusOr<std::string>()>;
  absl::StatusOr<v1::RestoreMapResponse> RestoreMap(const v1::RestoreHeader& header,
                                                    const NextChunk& next);
  absl::StatusOr<v1::StoreReport> VerifyMap(const std::string& map);
  absl::StatusOr<v1::DeleteMissionResponse> DeleteMission(const std::string& map,
                                                          const MissionId& mission);
  absl::StatusOr<v1::DeleteMapResponse> DeleteMap(const std::string& map);

 private:
  template <typename Request, typename Response>
  using Method = grpc::Status (v1::MapAdminService::Stub::*)(grpc::ClientContext*, const Request&,
                                                             Response*);
  template <typename Request, typename Response>
  absl::StatusOr<Response> Call(Method<Request, Response> method, const Request& request);
  // The items of all pages.
  template <typename Item, typename Request, typename Response>
  absl::StatusOr<std::vector<Item>> AllPages(
      Method<Request, Response> method, Request request,
      const google::protobuf::RepeatedPtrField<Item>& (Response::*items)() const);

  std::string server_;
  absl::Duration timeout_;
  TlsFiles tls_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<v1::MapAdminService::Stub> stub_;
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_ADMIN_CLIENT_H_
