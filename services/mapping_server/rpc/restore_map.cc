// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/rpc/restore_map.h"

#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/field_path.h"
#include "overtone/proto/conversion/limits.h"
#include "overtone/proto/conversion/status_conversion.h"
#include "overtone/services/mapping_server/log_fields.h"
#include "overtone/services/mapping_server/rpc/housekeeping.h"

namespace overtone {

RestoreMap::RestoreMap(MapMaintenance* maintenance, const AccessControl* access,
                       const grpc::CallbackServerContext* context, v1::RestoreMapResponse* response)
    : maintenance_(maintenance), access_(access), context_(context), response_(response) {
  StartRead(&request_);
}

void RestoreMap::OnReadDone(bool ok) {
  const absl::Status status = ok ? OnMessage() : CheckWhole();
  if (!status.ok()) return End(status);
  if (ok) return StartRead(&request_);
  maintenance_->Post([this] { End(Restore()); });
}

absl::Status RestoreMap::OnMessage() {
  if (request_.has_header() != (file_ == nullptr)) {
    return InvalidField("header", "the first message must have it, and no other may");
  }
  if (request_.has_header()) RETURN_IF_ERROR(OnHeader(request_.header()));
  return OnChunk(request_.chunk());
}

absl::Status RestoreMap::OnHeader(const v1::RestoreHeader& header) {
  RETURN_IF_ERROR(access_->MayAdminister(*context_, header.map()));
  if (header.sha256().size() != limits::kSha256Bytes) {
    return InvalidField("header.sha256", absl::StrCat(header.sha256().size(), " bytes, not 32"));
  }
  header_ = header;
  ASSIGN_OR_RETURN(
      file_, maintenance_->BeginRestore(header.map(), header.total_bytes(), header.replace()));
  return absl::OkStatus();
}

absl::Status RestoreMap::OnChunk(const std::string& chunk) {
  if (chunk.size() > kTransferChunkBytes) {
    return InvalidField("chunk", absl::StrCat(chunk.size(), " bytes, at most 256 KiB are taken"));
  }
  bytes_ += static_cast<int64_t>(chunk.size());
  if (bytes_ > header_.total_bytes()) {
    return InvalidField("chunk", absl::StrCat("more than the ", header_.total_bytes(),
                                              " bytes of header.total_bytes"));
  }
  if (chunk.empty()) return absl::OkStatus();
  sum_.Add(chunk);
  return file_->Append(chunk);
}

absl::Status RestoreMap::CheckWhole() {
  if (context_->IsCancelled()) return absl::CancelledError("the peer is gone");
  if (file_ == nullptr) return InvalidField("header", "the stream ended before it");
  if (bytes_ != header_.total_bytes()) {
    return InvalidField("header.total_bytes",
                        absl::StrCat(header_.total_bytes(), ", but ", bytes_, " came"));
  }
  if (sum_.Finish() == header_.sha256()) return absl::OkStatus();
  return InvalidField("header.sha256", "is not that of the bytes that came");
}

absl::Status RestoreMap::Restore() {
  const LogFields about = LogFieldsOf(header_.map());
  const LogScope scope(&about);
  if (context_->IsCancelled()) return absl::CancelledError("the peer is gone");
  ASSIGN_OR_RETURN(MapMaintenance::Restored restored,
                   maintenance_->Restore(header_.map(), header_.replace(), *file_));
  response_->set_map_epoch(restored.map_epoch);
  *response_->mutable_report() = ToProto(restored.report);
  return absl::OkStatus();
}

void RestoreMap::End(const absl::Status& status) {
  file_.reset();
  Finish(ToGrpcStatus(status));
}

}  // namespace overtone
