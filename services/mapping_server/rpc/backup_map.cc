// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/rpc/backup_map.h"

#include <utility>

#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/status_conversion.h"
#include "overtone/services/mapping_server/request_id.h"

namespace overtone {

BackupMap::BackupMap(MapMaintenance* maintenance, const grpc::CallbackServerContext* context,
                     const std::string& map, const absl::Status& may) {
  if (!may.ok()) {
    End(may);
    return;
  }
  maintenance->Post([this, maintenance, context, map, about = AboutCall(*context, map)] {
    const LogScope scope(&about);
    const absl::Status status = Begin(*maintenance, *context, map);
    if (!status.ok()) End(status);
  });
}

absl::Status BackupMap::Begin(MapMaintenance& maintenance,
                              const grpc::CallbackServerContext& context, const std::string& map) {
  if (context.IsCancelled()) return absl::CancelledError("the peer is gone");
  ASSIGN_OR_RETURN(MapMaintenance::Backup backup, maintenance.BackUp(map));
  file_ = std::move(backup.file);
  response_.mutable_header()->set_total_bytes(backup.bytes);
  response_.mutable_header()->set_sha256(backup.sha256);
  StartWrite(&response_);
  return absl::OkStatus();
}

void BackupMap::OnWriteDone(bool ok) {
  const absl::Status status = ok ? WriteNext() : absl::CancelledError("the peer is gone");
  if (!status.ok()) End(status);
}

// On gRPC's thread: what was just written is read again, a chunk at a time.
absl::Status BackupMap::WriteNext() {
  response_.clear_header();
  ASSIGN_OR_RETURN(*response_.mutable_chunk(), file_->ReadNext());
  if (response_.chunk().empty()) {
    End(absl::OkStatus());
  } else {
    StartWrite(&response_);
  }
  return absl::OkStatus();
}

void BackupMap::End(const absl::Status& status) {
  file_.reset();
  Finish(ToGrpcStatus(status));
}

}  // namespace overtone
