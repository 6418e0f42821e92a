// SPDX-License-Identifier: Apache-2.0
// The calls of the public API that the dashboard makes, for one map.
#ifndef OVERTONE_SERVICES_DASHBOARD_MAP_API_H_
#define OVERTONE_SERVICES_DASHBOARD_MAP_API_H_

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "grpcpp/channel.h"
#include "overtone/v1/map_admin_service.grpc.pb.h"
#include "overtone/v1/mapping_service.grpc.pb.h"

namespace overtone {

// Thread-safe. Every call waits up to `timeout` and returns the server's status.
class MapApi {
 public:
  MapApi(const std::shared_ptr<grpc::Channel>& channel, std::string map, absl::Duration timeout);

  const std::string& map() const { return map_; }

  absl::StatusOr<std::vector<v1::MapSummary>> Maps();
  absl::StatusOr<v1::GetServerInfoResponse> ServerInfo();
  absl::StatusOr<std::vector<v1::Robot>> Robots();
  absl::StatusOr<std::vector<v1::Mission>> Missions();
  // The first `max`, in the server's order.
  absl::StatusOr<std::vector<v1::LoopClosureStatus>> LoopClosures(size_t max);
  // The newest `max`, newest first.
  absl::StatusOr<std::vector<v1::Revision>> Revisions(size_t max);
  absl::StatusOr<v1::GetTrajectoryResponse> Trajectory(const v1::MissionId& mission);
  absl::StatusOr<v1::StatusReport> Report(const v1::MissionId& mission);
  absl::Status Veto(const std::string& closure);
  // A PLY file. ResourceExhausted: more than `max_bytes`.
  absl::StatusOr<std::string> Cloud(double voxel_m, int64_t max_points, size_t max_bytes);

 private:
  template <typename Request, typename Response>
  using Method = grpc::Status (v1::MapAdminService::Stub::*)(grpc::ClientContext*, const Request&,
                                                             Response*);
  template <typename Request, typename Response>
  absl::StatusOr<Response> Call(Method<Request, Response> method, const Request& request);
  // Pages until there are `max` or no more.
  template <typename Item, typename Request, typename Response>
  absl::StatusOr<std::vector<Item>> Pages(
      Method<Request, Response> method, Request request,
      const google::protobuf::RepeatedPtrField<Item>& (Response::*items)() const, size_t max);

  const std::string map_;
  const absl::Duration timeout_;
  const std::unique_ptr<v1::MapAdminService::Stub> admin_;
  const std::unique_ptr<v1::MappingService::Stub> mapping_;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_DASHBOARD_MAP_API_H_
