// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/dashboard/map_api.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "grpcpp/client_context.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/status_conversion.h"

namespace overtone {
namespace {

using Stub = v1::MapAdminService::Stub;

constexpr size_t kPageSize = 1000;
constexpr size_t kAll = std::numeric_limits<size_t>::max();
// The server merges all clouds of a map first.
constexpr absl::Duration kCloudTimeout = absl::Seconds(120);

void SetTimeout(grpc::ClientContext& context, absl::Duration timeout) {
  context.set_deadline(absl::ToChronoTime(absl::Now() + timeout));
}

}  // namespace

MapApi::MapApi(const std::shared_ptr<grpc::Channel>& channel, std::string map,
               absl::Duration timeout)
    : map_(std::move(map)),
      timeout_(timeout),
      admin_(v1::MapAdminService::NewStub(channel)),
      mapping_(v1::MappingService::NewStub(channel)) {}

template <typename Request, typename Response>
absl::StatusOr<Response> MapApi::Call(Method<Request, Response> method, const Request& request) {
  grpc::ClientContext context;
  SetTimeout(context, timeout_);
  Response response;
  RETURN_IF_ERROR(FromGrpcStatus((admin_.get()->*method)(&context, request, &response)));
  return response;
}

template <typename Item, typename Request, typename Response>
absl::StatusOr<std::vector<Item>> MapApi::Pages(
    Method<Request, Response> method, Request request,
    const google::protobuf::RepeatedPtrField<Item>& (Response::*items)() const, size_t max) {
  std::vector<Item> all;
  do {
    request.set_page_size(static_cast<int32_t>(std::min(kPageSize, max - all.size())));
    ASSIGN_OR_RETURN(const Response response, Call(method, request));
    all.insert(all.end(), (response.*items)().begin(), (response.*items)().end());
    request.set_page_token(response.next_page_token());
  } while (!request.page_token().empty() && all.size() < max);
  return all;
}

absl::StatusOr<std::vector<v1::MapSummary>> MapApi::Maps() {
  return Pages(&Stub::ListMaps, v1::ListMapsRequest(), &v1::ListMapsResponse::maps, kAll);
}

absl::StatusOr<v1::GetServerInfoResponse> MapApi::ServerInfo() {
  grpc::ClientContext context;
  SetTimeout(context, timeout_);
  v1::GetServerInfoResponse response;
  RETURN_IF_ERROR(
      FromGrpcStatus(mapping_->GetServerInfo(&context, v1::GetServerInfoRequest(), &response)));
  return response;
}

absl::StatusOr<std::vector<v1::Robot>> MapApi::Robots() {
  v1::ListRobotsRequest request;
  request.set_map(map_);
  return Pages(&Stub::ListRobots, request, &v1::ListRobotsResponse::robots, kAll);
}

absl::StatusOr<std::vector<v1::Mission>> MapApi::Missions() {
  v1::ListMissionsRequest request;
  request.set_map(map_);
  return Pages(&Stub::ListMissions, request, &v1::ListMissionsResponse::missions, kAll);
}

absl::StatusOr<std::vector<v1::LoopClosureStatus>> MapApi::LoopClosures(size_t max) {
  v1::ListLoopClosuresRequest request;
  request.set_map(map_);
  return Pages(&Stub::ListLoopClosures, request, &v1::ListLoopClosuresResponse::loop_closures, max);
}

absl::StatusOr<std::vector<v1::Revision>> MapApi::Revisions(size_t max) {
  v1::ListRevisionsRequest request;
  request.set_map(map_);
  return Pages(&Stub::ListRevisions, request, &v1::ListRevisionsResponse::revisions, max);
}

absl::StatusOr<v1::GetTrajectoryResponse> MapApi::Trajectory(const v1::MissionId& mission) {
  v1::GetTrajectoryRequest request;
  request.set_map(map_);
  *request.mutable_mission() = mission;
  request.set_odometry(true);
  return Call(&Stub::GetTrajectory, request);
}

absl::StatusOr<v1::StatusReport> MapApi::Report(const v1::MissionId& mission) {
  v1::GetStatusReportRequest request;
  request.set_map(map_);
  *request.mutable_mission() = mission;
  ASSIGN_OR_RETURN(v1::GetStatusReportResponse response, Call(&Stub::GetStatusReport, request));
  return std::move(*response.mutable_report());
}

absl::Status MapApi::Veto(const std::string& closure) {
  v1::VetoLoopClosureRequest request;
  request.set_map(map_);
  request.set_id(closure);
  return Call(&Stub::VetoLoopClosure, request).status();
}

absl::StatusOr<std::string> MapApi::Cloud(double voxel_m, int64_t max_points, size_t max_bytes) {
  v1::ExportMapRequest request;
  request.set_map(map_);
  request.set_format(v1::EXPORT_FORMAT_PLY);
  request.set_voxel_m(voxel_m);
  request.set_max_points(max_points);
  grpc::ClientContext context;
  SetTimeout(context, kCloudTimeout);
  const auto reader = admin_->ExportMap(&context, request);
  std::string file;
  v1::ExportMapResponse response;
  while (reader->Read(&response)) {
    if (file.size() + response.chunk().size() > max_bytes) {
      context.TryCancel();
      reader->Finish();
      return absl::ResourceExhaustedError(
          absl::StrCat("the cloud has more than ", max_bytes, " bytes"));
    }
    file += response.chunk();
  }
  RETURN_IF_ERROR(FromGrpcStatus(reader->Finish()));
  return file;
}

}  // namespace overtone
