// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/admin_client.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "grpcpp/create_channel.h"
#include "overtone/client/cli/health_check.h"
#include "overtone/client/cli/server_error.h"
#include "overtone/client/internal/channel_credentials.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/id_conversion.h"
#include "overtone/proto/conversion/sha256.h"
#include "overtone/proto/conversion/status_conversion.h"

namespace overtone {
namespace {

constexpr int kPageSize = 1000;
constexpr int kMaxMessageBytes = 256 << 20;  // a trajectory of a million keyframes

std::shared_ptr<grpc::Channel> CreateAdminChannel(const std::string& server, const TlsFiles& tls) {
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(kMaxMessageBytes);
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 200);
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, 200);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 1000);
  const auto credentials = MakeChannelCredentials(tls, &arguments);
  return grpc::CreateCustomChannel(server, credentials, arguments);
}

void Prepare(grpc::ClientContext* context, absl::Duration timeout) {
  context->set_deadline(absl::ToChronoTime(absl::Now() + timeout));
}

}  // namespace

AdminClient::AdminClient(std::string server, absl::Duration timeout, const TlsFiles& tls)
    : server_(std::move(server)),
      timeout_(timeout),
      tls_(tls),
      channel_(CreateAdminChannel(server_, tls)),
      stub_(v1::MapAdminService::NewStub(channel_)) {}

template <typename Request, typename Response>
absl::StatusOr<Response> AdminClient::Call(Method<Request, Response> method,
                                           const Request& request) {
  grpc::ClientContext context;
  Prepare(&context, timeout_);
  Response response;
  RETURN_IF_ERROR(ServerError(server_, tls_, (stub_.get()->*method)(&context, request, &response)));
  return response;
}

template <typename Item, typename Request, typename Response>
absl::StatusOr<std::vector<Item>> AdminClient::AllPages(
    Method<Request, Response> method, Request request,
    const google::protobuf::RepeatedPtrField<Item>& (Response::*items)() const) {
  request.set_page_size(kPageSize);
  std::vector<Item> all;
  do {
    ASSIGN_OR_RETURN(const Response response, Call(method, request));
    all.insert(all.end(), (response.*items)().begin(), (response.*items)().end());
    request.set_page_token(response.next_page_token());
  } while (!request.page_token().empty());
  return all;
}

AdminClient::Link AdminClient::CheckLink() {
  switch (channel_->GetState(/*try_to_connect=*/true)) {
    case GRPC_CHANNEL_READY:
      return Link::kUp;
    case GRPC_CHANNEL_TRANSIENT_FAILURE:
      return Link::kLost;
    default:
      return Link::kUnknown;
  }
}

absl::StatusOr<std::vector<v1::MapSummary>> AdminClient::ListMaps() {
  return AllPages(&v1::MapAdminService::Stub::ListMaps, v1::ListMapsRequest(),
                  &v1::ListMapsResponse::maps);
}

absl::StatusOr<v1::MapSummary> AdminClient::GetMap(const std::string& map) {
  ASSIGN_OR_RETURN(const std::vector<v1::MapSummary> maps, ListMaps());
  for (const v1::MapSummary& summary : maps) {
    if (summary.map() == map) return summary;
  }
  return ServerError(server_, tls_,
                     {grpc::StatusCode::NOT_FOUND, absl::StrCat("map: there is no '", map, "'")});
}

absl::StatusOr<std::vector<v1::Robot>> AdminClient::ListRobots(const std::string& map) {
  v1::ListRobotsRequest request;
  request.set_map(map);
  return AllPages(&v1::MapAdminService::Stub::ListRobots, request, &v1::ListRobotsResponse::robots);
}

absl::StatusOr<std::vector<v1::Mission>> AdminClient::ListMissions(const std::string& map) {
  v1::ListMissionsRequest request;
  request.set_map(map);
  return AllPages(&v1::MapAdminService::Stub::ListMissions, request,
                  &v1::ListMissionsResponse::missions);
}

absl::StatusOr<std::vector<v1::LoopClosureStatus>> AdminClient::ListLoopClosures(
    const std::string& map) {
  v1::ListLoopClosuresRequest request;
  request.set_map(map);
  return ListLoopClosures(request);
}

absl::StatusOr<std::vector<v1::LoopClosureStatus>> AdminClient::ListLoopClosures(
    v1::ListLoopClosuresRequest request) {
  return AllPages(&v1::MapAdminService::Stub::ListLoopClosures, std::move(request),
                  &v1::ListLoopClosuresResponse::loop_closures);
}

absl::StatusOr<v1::ExplainLoopClosuresResponse> AdminClient::ExplainLoopClosures(
    const v1::ExplainLoopClosuresRequest& request) {
  return Call(&v1::MapAdminService::Stub::ExplainLoopClosures, request);
}

absl::Status AdminClient::VetoLoopClosure(const std::string& map, const std::string& id) {
  v1::VetoLoopClosureRequest request;
  request.set_map(map);
  request.set_id(id);
  return Call(&v1::MapAdminService::Stub::VetoLoopClosure, request).status();
}

absl::Status AdminClient::ForceLoopClosure(const std::string& map, const std::string& id) {
  v1::ForceLoopClosureRequest request;
  request.set_map(map);
  request.set_id(id);
  return Call(&v1::MapAdminService::Stub::ForceLoopClosure, request).status();
}

absl::StatusOr<std::vector<v1::Revision>> AdminClient::ListRevisions(const std::string& map) {
  v1::ListRevisionsRequest request;
  request.set_map(map);
  return AllPages(&v1::MapAdminService::Stub::ListRevisions, request,
                  &v1::ListRevisionsResponse::revisions);
}

absl::StatusOr<v1::RollBackResponse> AdminClient::RollBack(const std::string& map,
                                                           uint64_t revision) {
  v1::RollBackRequest request;
  request.set_map(map);
  request.set_revision(revision);
  return Call(&v1::MapAdminService::Stub::RollBack, request);
}

absl::StatusOr<v1::GetTrajectoryResponse> AdminClient::GetTrajectory(const std::string& map,
                                                                     const MissionId& mission,
                                                                     bool odometry) {
  v1::GetTrajectoryRequest request;
  request.set_map(map);
  *request.mutable_mission() = ToProto(mission);
  request.set_odometry(odometry);
  return Call(&v1::MapAdminService::Stub::GetTrajectory, request);
}

absl::StatusOr<v1::GetConfigurationResponse> AdminClient::GetConfiguration() {
  return Call(&v1::MapAdminService::Stub::GetConfiguration, v1::GetConfigurationRequest());
}

absl::StatusOr<v1::StatusReport> AdminClient::GetStatusReport(const std::string& map,
                                                              const MissionId& mission) {
  v1::GetStatusReportRequest request;
  request.set_map(map);
  *request.mutable_mission() = ToProto(mission);
  ASSIGN_OR_RETURN(const v1::GetStatusReportResponse response,
                   Call(&v1::MapAdminService::Stub::GetStatusReport, request));
  return response.report();
}

absl::Status AdminClient::ExportMap(
    const v1::ExportMapRequest& request,
    const std::function<absl::Status(const std::string& chunk)>& take) {
  grpc::ClientContext context;
  Prepare(&context, timeout_);
  const auto reader = stub_->ExportMap(&context, request);
  v1::ExportMapResponse response;
  absl::Status taken;
  while (reader->Read(&response)) {
    if (!taken.ok()) continue;  // cancelled, and the rest is of no interest
    taken = take(response.chunk());
    if (!taken.ok()) context.TryCancel();
  }
  const grpc::Status status = reader->Finish();
  RETURN_IF_ERROR(taken);
  return ServerError(server_, tls_, status);
}

absl::StatusOr<std::string> AdminClient::Health(const std::string& service) {
  grpc::ClientContext context;
  Prepare(&context, timeout_);
  const absl::StatusOr<std::string> status = CheckHealth(channel_, context, service);
  if (status.ok()) return status;
  return ServerError(server_, tls_, ToGrpcStatus(status.status()));
}

absl::StatusOr<v1::BackupHeader> AdminClient::BackupMap(const std::string& map,
                                                        const TakeChunk& take) {
  v1::BackupMapRequest request;
  request.set_map(map);
  grpc::ClientContext context;
  Prepare(&context, timeout_);
  const auto reader = stub_->BackupMap(&context, request);
  v1::BackupHeader header;
  v1::BackupMapResponse response;
  Sha256Sum sum;
  int64_t bytes = 0;
  absl::Status taken;
  while (reader->Read(&response)) {
    if (!taken.ok()) continue;  // cancelled, and the rest is of no interest
    if (response.has_header()) header = response.header();
    bytes += static_cast<int64_t>(response.chunk().size());
    sum.Add(response.chunk());
    taken = take(header, response.chunk());
    if (!taken.ok()) context.TryCancel();
  }
  const grpc::Status status = reader->Finish();
  RETURN_IF_ERROR(taken);
  RETURN_IF_ERROR(ServerError(server_, tls_, status));
  if (bytes == header.total_bytes() && sum.Finish() == header.sha256()) return header;
  return absl::DataLossError(absl::StrCat("server ", server_, ": the ", bytes,
                                          " bytes that came are not those that it announced"));
}

absl::StatusOr<v1::RestoreMapResponse> AdminClient::RestoreMap(const v1::RestoreHeader& header,
                                                               const NextChunk& next) {
  grpc::ClientContext context;
  Prepare(&context, timeout_);
  v1::RestoreMapResponse response;
  const auto writer = stub_->RestoreMap(&context, &response);
  v1::RestoreMapRequest request;
  *request.mutable_header() = header;
  absl::StatusOr<std::string> chunk = std::string();
  // False: the server has ended the call and says why.
  while (writer->Write(request)) {
    chunk = next();
    if (!chunk.ok()) context.TryCancel();
    if (!chunk.ok() || chunk->empty()) break;
    request.clear_header();
    request.set_chunk(*std::move(chunk));
    chunk = std::string();
  }
  writer->WritesDone();
  const grpc::Status status = writer->Finish();
  if (!chunk.ok()) return chunk.status();
  RETURN_IF_ERROR(ServerError(server_, tls_, status));
  return response;
}

absl::StatusOr<v1::StoreReport> AdminClient::VerifyMap(const std::string& map) {
  v1::VerifyMapRequest request;
  request.set_map(map);
  ASSIGN_OR_RETURN(const v1::VerifyMapResponse response,
                   Call(&v1::MapAdminService::Stub::VerifyMap, request));
  return response.report();
}

absl::StatusOr<v1::DeleteMissionResponse> AdminClient::DeleteMission(const std::string& map,
                                                                     const MissionId& mission) {
  v1::DeleteMissionRequest request;
  request.set_map(map);
  *request.mutable_mission() = ToProto(mission);
  return Call(&v1::MapAdminService::Stub::DeleteMission, request);
}

absl::StatusOr<v1::DeleteMapResponse> AdminClient::DeleteMap(const std::string& map) {
  v1::DeleteMapRequest request;
  request.set_map(map);
  return Call(&v1::MapAdminService::Stub::DeleteMap, request);
}

}  // namespace overtone
