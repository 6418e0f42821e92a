// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/rpc/export_map.h"

#include <memory>
#include <string>
#include <utility>

#include "overtone/proto/conversion/status_conversion.h"
#include "overtone/services/mapping_server/map_file.h"

namespace overtone {
namespace {

constexpr size_t kChunkBytes = 256 << 10;

CloudExporter::NextChunk ChunksOf(std::string text) {
  return [text = std::move(text), next = size_t{0}]() mutable {
    std::string chunk = text.substr(next, kChunkBytes);
    next += chunk.size();
    return chunk;
  };
}

}  // namespace

ExportMap::ExportMap(const absl::Status& may, const MapRegistry& registry, CloudExporter* exporter,
                     const v1::ExportMapRequest& request) {
  if (!may.ok()) {
    Begin(may);
  } else if (request.format() == v1::EXPORT_FORMAT_PLY) {
    exporter->Start(
        request, [this] { return !cancelled_; },
        [this](absl::StatusOr<NextChunk> file) { Begin(std::move(file)); });
  } else {
    absl::StatusOr<std::string> text = MapFile(registry, request);
    Begin(text.ok() ? absl::StatusOr<NextChunk>(ChunksOf(*std::move(text))) : text.status());
  }
}

void ExportMap::Begin(absl::StatusOr<NextChunk> file) {
  absl::MutexLock lock(&mutex_);
  making_ = false;
  if (!file.ok()) return FinishWith(file.status());
  if (cancelled_) return FinishWith(absl::CancelledError("the peer is gone"));
  next_chunk_ = *std::move(file);
  WriteNext();
}

void ExportMap::WriteNext() {
  response_.set_chunk(next_chunk_());
  if (response_.chunk().empty()) return FinishWith(absl::OkStatus());
  StartWrite(&response_);
}

void ExportMap::OnWriteDone(bool ok) {
  absl::MutexLock lock(&mutex_);
  if (finished_) return;
  if (!ok) return FinishWith(absl::CancelledError("the peer is gone"));
  WriteNext();
}

void ExportMap::OnCancel() {
  cancelled_ = true;
  absl::MutexLock lock(&mutex_);
  if (!finished_ && !making_) FinishWith(absl::CancelledError("the peer is gone"));
}

void ExportMap::FinishWith(const absl::Status& status) {
  finished_ = true;
  Finish(ToGrpcStatus(status));
}

void ExportMap::OnDone() { delete this; }

}  // namespace overtone
