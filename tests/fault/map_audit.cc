// SPDX-License-Identifier: Apache-2.0
#include "overtone/tests/fault/map_audit.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/synchronization/notification.h"
#include "absl/time/clock.h"
#include "grpcpp/create_channel.h"
#include "grpcpp/security/credentials.h"
#include "overtone/client/cli/admin_client.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/storage/sqlite_database.h"
#include "overtone/proto/conversion/id_conversion.h"
#include "overtone/proto/conversion/status_conversion.h"
#include "overtone/tests/fault/busy_robot.h"
#include "overtone/tests/support/straight_mission.h"

namespace overtone {
namespace {

constexpr absl::Duration kCallTimeout = absl::Seconds(20);
// Every measurement agrees with every other one: the optimum is what was sent.
constexpr double kPoseTolerance_m = 1e-3;

bool IsAsSent(const v1::Node& node) {
  const v1::Vector3& position = node.map_tform_body().position();
  return node.stamp_ns() == StampOf(node.index()).ns &&
         std::abs(position.x() - static_cast<double>(node.index())) < kPoseTolerance_m &&
         std::hypot(position.y(), position.z()) < kPoseTolerance_m;
}

void AuditNodes(const v1::GetTrajectoryResponse& trajectory, int64_t keyframes, MapAudit& audit) {
  std::vector<int> seen(keyframes);
  for (const v1::Node& node : trajectory.nodes()) {
    if (node.index() < 0 || node.index() >= keyframes || seen[node.index()]++ > 0) {
      ++audit.keyframes_doubled;
    }
    audit.wrong_poses += !IsAsSent(node);
  }
  audit.keyframes_lost += std::count(seen.begin(), seen.end(), 0);
}

int64_t Excess(int64_t a, int64_t b) { return std::max<int64_t>(0, a - b); }

}  // namespace

void MapAudit::Add(const MapAudit& other) {
  submaps_lost += other.submaps_lost;
  submaps_doubled += other.submaps_doubled;
  keyframes_lost += other.keyframes_lost;
  keyframes_doubled += other.keyframes_doubled;
  wrong_poses += other.wrong_poses;
  clouds_lost += other.clouds_lost;
  closures_lost += other.closures_lost;
  closures_doubled += other.closures_doubled;
}

std::string ToString(const MapAudit& audit) {
  return absl::StrCat("submaps lost ", audit.submaps_lost, ", doubled ", audit.submaps_doubled,
                      "; keyframes lost ", audit.keyframes_lost, ", doubled ",
                      audit.keyframes_doubled, ", not as sent ", audit.wrong_poses,
                      "; clouds lost ", audit.clouds_lost, "; closures lost ", audit.closures_lost,
                      ", doubled ", audit.closures_doubled);
}

absl::Status AwaitMapped(const std::string& address, const std::string& map, int64_t keyframes,
                         absl::Duration timeout) {
  AdminClient admin(address, kCallTimeout);
  const absl::Time deadline = absl::Now() + timeout;
  while (true) {
    ASSIGN_OR_RETURN(const v1::MapSummary summary, admin.GetMap(map));
    if (summary.keyframes() >= keyframes) return absl::OkStatus();
    if (absl::Now() > deadline) return absl::DeadlineExceededError(summary.ShortDebugString());
    // Only asking tells how far it is; the pause leaves it the processor.
    absl::Notification().WaitForNotificationWithTimeout(absl::Milliseconds(50));
  }
}

absl::StatusOr<MapAudit> AuditMap(const std::string& address, const std::string& map,
                                  const HandedOver& handed_over) {
  AdminClient admin(address, kCallTimeout);
  MapAudit audit;
  int64_t clouds = 0, closures = 0;
  ASSIGN_OR_RETURN(const std::vector<v1::Mission> missions, admin.ListMissions(map));
  for (const auto& [id, submaps] : handed_over) {
    clouds += submaps;
    closures += Excess(submaps, 1);
    int64_t stored = 0;
    for (const v1::Mission& mission : missions) {
      if (mission.id().robot() == id.robot && mission.id().mission() == id.mission) {
        stored += mission.submaps();
      }
    }
    audit.submaps_lost += Excess(submaps, stored);
    audit.submaps_doubled += Excess(stored, submaps);
    ASSIGN_OR_RETURN(const v1::GetTrajectoryResponse trajectory, admin.GetTrajectory(map, id));
    AuditNodes(trajectory, submaps * kBusyKeyframes, audit);
  }
  ASSIGN_OR_RETURN(const v1::MapSummary summary, admin.GetMap(map));
  audit.clouds_lost = Excess(clouds, summary.clouds()) + summary.missing_blobs();
  ASSIGN_OR_RETURN(const auto listed, admin.ListLoopClosures(map));
  const int64_t from_robots =
      std::count_if(listed.begin(), listed.end(), [](const v1::LoopClosureStatus& closure) {
        return closure.proposer() == v1::LOOP_CLOSURE_PROPOSER_ROBOT;
      });
  audit.closures_lost = Excess(closures, from_robots);
  audit.closures_doubled = Excess(from_robots, closures);
  return audit;
}

absl::StatusOr<int64_t> SubmapsStoredTwice(const std::string& data_dir, const std::string& map) {
  const std::string path = absl::StrCat(data_dir, "/maps/", map, "/map.db");
  ASSIGN_OR_RETURN(const auto database,
                   SqliteDatabase::Open(path, SqliteDatabase::Mode::kReadWrite));
  ASSIGN_OR_RETURN(SqliteStatement check, database->Prepare("PRAGMA integrity_check"));
  RETURN_IF_ERROR(check.ForEach([](const SqliteStatement& row) {
    return row.Bytes(0) == "ok" ? absl::OkStatus() : absl::DataLossError(row.String(0));
  }));
  return database->QueryInt(
      "SELECT COUNT(*) - COUNT(DISTINCT about || ' ' || sequence) FROM log WHERE kind = 1");
}

absl::StatusOr<v1::GetUploadStateResponse> UploadStateOf(const std::string& address,
                                                         const std::string& map,
                                                         const MissionId& mission) {
  const auto stub =
      v1::MappingService::NewStub(grpc::CreateChannel(address, grpc::InsecureChannelCredentials()));
  v1::GetUploadStateRequest request;
  request.set_map(map);
  *request.mutable_mission() = ToProto(mission);
  grpc::ClientContext context;
  context.set_deadline(absl::ToChronoTime(absl::Now() + kCallTimeout));
  v1::GetUploadStateResponse response;
  RETURN_IF_ERROR(FromGrpcStatus(stub->GetUploadState(&context, request, &response)));
  return response;
}

}  // namespace overtone
