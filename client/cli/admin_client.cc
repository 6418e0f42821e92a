// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/admin_client.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "grpcpp/create_channel.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/id_conversion.h"
#include "overtone/proto/conversion/status_conversion.h"

namespace overtone {
namespace {

constexpr int kPageSize = 1000;
constexpr int kMaxMessageBytes = 256 << 20;  // a trajectory of a million keyframes

std::shared_ptr<grpc::Channel> CreateAdminChannel(const std::string& server) {
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(kMaxMessageBytes);
  return grpc::CreateCustomChannel(server, grpc::InsecureChannelCredentials(), arguments);
}

void Prepare(grpc::ClientContext* context, absl::Duration timeout) {
  context->set_deadline(absl::ToChronoTime(absl::Now() + timeout));
}

absl::Status Named(const std::string& server, const grpc::Status& status) {
  const absl::Status plain = FromGrpcStatus(status);
  if (plain.ok()) return plain;
  return absl::Status(plain.code(), absl::StrCat("server ", server, ": ", plain.message()));
}

}  // namespace

AdminClient::AdminClient(std::string server, absl::Duration timeout)
    : server_(std::move(server)),
      timeout_(timeout),
      stub_(v1::MapAdminService::NewStub(CreateAdminChannel(server_))) {}

absl::StatusOr<std::vector<v1::MapSummary>> AdminClient::ListMaps() {
  v1::ListMapsRequest request;
  request.set_page_size(kPageSize);
  std::vector<v1::MapSummary> maps;
  do {
    grpc::ClientContext context;
    Prepare(&context, timeout_);
    v1::ListMapsResponse response;
    RETURN_IF_ERROR(Named(server_, stub_->ListMaps(&context, request, &response)));
    maps.insert(maps.end(), response.maps().begin(), response.maps().end());
    request.set_page_token(response.next_page_token());
  } while (!request.page_token().empty());
  return maps;
}

absl::StatusOr<v1::MapSummary> AdminClient::GetMap(const std::string& map) {
  ASSIGN_OR_RETURN(const std::vector<v1::MapSummary> maps, ListMaps());
  for (const v1::MapSummary& summary : maps) {
    if (summary.map() == map) return summary;
  }
  return absl::NotFoundError(absl::StrCat("server ", server_, " has no map \"", map, "\""));
}

absl::StatusOr<std::vector<v1::Mission>> AdminClient::ListMissions(const std::string& map) {
  v1::ListMissionsRequest request;
  request.set_map(map);
  request.set_page_size(kPageSize);
  std::vector<v1::Mission> missions;
  do {
    grpc::ClientContext context;
    Prepare(&context, timeout_);
    v1::ListMissionsResponse response;
    RETURN_IF_ERROR(Named(server_, stub_->ListMissions(&context, request, &response)));
    missions.insert(missions.end(), response.missions().begin(), response.missions().end());
    request.set_page_token(response.next_page_token());
  } while (!request.page_token().empty());
  return missions;
}

absl::StatusOr<std::vector<v1::LoopClosureStatus>> AdminClient::ListLoopClosures(
    const std::string& map) {
  v1::ListLoopClosuresRequest request;
  request.set_map(map);
  request.set_page_size(kPageSize);
  std::vector<v1::LoopClosureStatus> closures;
  do {
    grpc::ClientContext context;
    Prepare(&context, timeout_);
    v1::ListLoopClosuresResponse response;
    RETURN_IF_ERROR(Named(server_, stub_->ListLoopClosures(&context, request, &response)));
    closures.insert(closures.end(), response.loop_closures().begin(),
                    response.loop_closures().end());
    request.set_page_token(response.next_page_token());
  } while (!request.page_token().empty());
  return closures;
}

absl::StatusOr<v1::GetTrajectoryResponse> AdminClient::GetTrajectory(const std::string& map,
                                                                     const MissionId& mission) {
  v1::GetTrajectoryRequest request;
  request.set_map(map);
  *request.mutable_mission() = ToProto(mission);
  grpc::ClientContext context;
  Prepare(&context, timeout_);
  v1::GetTrajectoryResponse response;
  RETURN_IF_ERROR(Named(server_, stub_->GetTrajectory(&context, request, &response)));
  return response;
}

absl::Status AdminClient::ExportMap(const std::string& map, v1::ExportFormat format,
                                    std::ostream* out) {
  v1::ExportMapRequest request;
  request.set_map(map);
  request.set_format(format);
  grpc::ClientContext context;
  Prepare(&context, timeout_);
  const auto reader = stub_->ExportMap(&context, request);
  v1::ExportMapResponse response;
  while (reader->Read(&response)) out->write(response.chunk().data(), response.chunk().size());
  RETURN_IF_ERROR(Named(server_, reader->Finish()));
  if (!out->flush()) return absl::UnavailableError("the file cannot be written");
  return absl::OkStatus();
}

}  // namespace overtone
