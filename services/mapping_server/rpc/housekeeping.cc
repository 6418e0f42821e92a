// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/rpc/housekeeping.h"

#include <string>
#include <utility>

#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/field_path.h"
#include "overtone/proto/conversion/id_conversion.h"
#include "overtone/proto/conversion/status_conversion.h"
#include "overtone/services/mapping_server/request_id.h"

namespace overtone {
namespace {

constexpr int kMaxLosses = 1000;
constexpr size_t kMaxLossBytes = 1024;

// Finishes the call with what `work` gives, on the maintenance's thread, unless nobody waits for it
// any more.
grpc::ServerUnaryReactor* Later(grpc::CallbackServerContext* context, MapMaintenance* maintenance,
                                const std::string& map, std::function<absl::Status()> work) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  maintenance->Post([context, reactor, work = std::move(work), about = AboutCall(*context, map)] {
    const LogScope scope(&about);
    const absl::Status status =
        context->IsCancelled() ? absl::CancelledError("the peer is gone") : work();
    reactor->Finish(ToGrpcStatus(status));
  });
  return reactor;
}

}  // namespace

v1::StoreReport ToProto(const StoreReport& report) {
  v1::StoreReport message;
  message.set_missions(report.missions);
  message.set_submaps(report.submaps);
  message.set_loop_closures(report.loop_closures);
  message.set_findings(report.findings);
  message.set_blobs(report.blobs);
  message.set_bytes_on_disk(report.bytes_on_disk);
  message.set_num_losses(static_cast<int64_t>(report.losses.size()));
  for (const std::string& loss : report.losses) {
    if (message.losses_size() == kMaxLosses) break;
    message.add_losses(HeaderSafe(loss.substr(0, kMaxLossBytes)));
  }
  return message;
}

grpc::ServerUnaryReactor* VerifyMap(grpc::CallbackServerContext* context,
                                    MapMaintenance* maintenance,
                                    const v1::VerifyMapRequest* request,
                                    v1::VerifyMapResponse* response) {
  return Later(context, maintenance, request->map(),
               [maintenance, request, response]() -> absl::Status {
                 ASSIGN_OR_RETURN(const StoreReport report, maintenance->Verify(request->map()));
                 *response->mutable_report() = ToProto(report);
                 return absl::OkStatus();
               });
}

grpc::ServerUnaryReactor* DeleteMission(grpc::CallbackServerContext* context,
                                        MapMaintenance* maintenance,
                                        const v1::DeleteMissionRequest* request,
                                        v1::DeleteMissionResponse* response) {
  return Later(
      context, maintenance, request->map(), [maintenance, request, response]() -> absl::Status {
        ASSIGN_OR_RETURN(const MissionId mission,
                         AtField("mission", FromProto(request->mission())));
        ASSIGN_OR_RETURN(const auto deleted, maintenance->DeleteMission(request->map(), mission));
        response->set_map_epoch(deleted.map_epoch);
        response->set_freed_bytes(deleted.freed_bytes);
        return absl::OkStatus();
      });
}

grpc::ServerUnaryReactor* DeleteMap(grpc::CallbackServerContext* context,
                                    MapMaintenance* maintenance,
                                    const v1::DeleteMapRequest* request,
                                    v1::DeleteMapResponse* response) {
  return Later(context, maintenance, request->map(),
               [maintenance, request, response]() -> absl::Status {
                 ASSIGN_OR_RETURN(const auto deleted, maintenance->DeleteMap(request->map()));
                 response->set_freed_bytes(deleted.freed_bytes);
                 return absl::OkStatus();
               });
}

}  // namespace overtone
