// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/rpc/export_map.h"

#include <utility>

#include "overtone/proto/conversion/status_conversion.h"

namespace overtone {
namespace {

constexpr size_t kChunkBytes = 256 << 10;

}  // namespace

ExportMap::ExportMap(absl::StatusOr<std::string> file) {
  absl::MutexLock lock(&mutex_);
  if (file.ok()) {
    file_ = *std::move(file);
    WriteNext();
  } else {
    FinishWith(file.status());
  }
}

void ExportMap::WriteNext() {
  if (next_ >= file_.size()) return FinishWith(absl::OkStatus());
  response_.set_chunk(file_.substr(next_, kChunkBytes));
  next_ += response_.chunk().size();
  StartWrite(&response_);
}

void ExportMap::OnWriteDone(bool ok) {
  absl::MutexLock lock(&mutex_);
  if (finished_) return;
  if (!ok) return FinishWith(absl::CancelledError("the peer is gone"));
  WriteNext();
}

void ExportMap::OnCancel() {
  absl::MutexLock lock(&mutex_);
  if (!finished_) FinishWith(absl::CancelledError("the peer is gone"));
}

void ExportMap::FinishWith(const absl::Status& status) {
  finished_ = true;
  Finish(ToGrpcStatus(status));
}

void ExportMap::OnDone() { delete this; }

}  // namespace overtone
