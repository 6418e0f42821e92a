// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/blob_sender.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/client/internal/backoff.h"
#include "overtone/proto/conversion/limits.h"

namespace overtone {
namespace {

constexpr size_t kMaxWanted = 4 * limits::kMaxWantsPerFrame;

}  // namespace

absl::Status BlobSender::OnWant(const v1::UploadWant& want, int64_t acknowledged_through) {
  acknowledged_through_ = acknowledged_through;
  if (want.sha256().empty()) {
    nothing_lacks_through_ = acknowledged_through;
    outbox_->RemoveBlobsThrough(nothing_lacks_through_);
  }
  if (wanted_.size() + want.sha256_size() > kMaxWanted) {
    return absl::InternalError(absl::StrCat("the server wants more than ", kMaxWanted, " blobs"));
  }
  wanted_.insert(wanted_.end(), want.sha256().begin(), want.sha256().end());
  return absl::OkStatus();
}

absl::Status BlobSender::OnResult(const v1::UploadBlobResult& result) {
  const auto it = in_flight_.find(result.sha256());
  if (it == in_flight_.end()) {
    return absl::InternalError("the server answered a blob that it was not sent");
  }
  in_flight_bytes_ -= it->second;
  in_flight_.erase(it);
  if (sending_.has_value() && sending_->sha256 == result.sha256()) sending_.reset();
  const auto code = static_cast<absl::StatusCode>(result.code());
  if (code == absl::StatusCode::kOk) {
    outbox_->RemoveBlob(result.sha256());
  } else if (IsRetryable(code)) {
    wanted_.clear();  // the next stream's Want says when
  } else {
    outbox_->DropBlob(result.sha256());
  }
  return absl::OkStatus();
}

std::optional<v1::UploadSubmapsRequest> BlobSender::Next(int64_t window_bytes,
                                                         int64_t max_chunk_bytes) {
  // What has been handed over since then of the same submaps.
  outbox_->RemoveBlobsThrough(nothing_lacks_through_);
  if (sending_.has_value()) return NextChunk(max_chunk_bytes);
  if (wanted_.empty()) return std::nullopt;
  const std::optional<int64_t> known_size = outbox_->BlobSize(wanted_.front());
  // A host that started over hands over again all that the server has, from the first submap on.
  if (!known_size && outbox_->LastSequence() < acknowledged_through_) return std::nullopt;
  const int64_t size = known_size.value_or(0);
  const bool fits = in_flight_bytes_ + size <= window_bytes / 4;
  if (!fits && in_flight_bytes_ > 0) return std::nullopt;  // the next result makes room
  std::string sha256 = std::move(wanted_.front());
  wanted_.pop_front();
  if (!in_flight_.emplace(sha256, size).second) return std::nullopt;
  in_flight_bytes_ += size;
  SharedBytes bytes = outbox_->FindBlob(sha256);
  if (bytes == nullptr) return Gone(sha256);
  sending_ = Sending{std::move(sha256), std::move(bytes)};
  return NextChunk(max_chunk_bytes);
}

v1::UploadSubmapsRequest BlobSender::NextChunk(int64_t max_chunk_bytes) {
  v1::UploadSubmapsRequest request;
  v1::BlobChunk& chunk = *request.mutable_blob();
  chunk.set_sha256(sending_->sha256);
  chunk.set_offset(static_cast<int64_t>(sending_->offset));
  chunk.set_data(sending_->bytes->substr(sending_->offset, max_chunk_bytes));
  sending_->offset += chunk.data().size();
  if (sending_->offset == sending_->bytes->size()) sending_.reset();
  return request;
}

v1::UploadSubmapsRequest BlobSender::Gone(const std::string& sha256) {
  v1::UploadSubmapsRequest request;
  request.mutable_blob()->set_sha256(sha256);
  request.mutable_blob()->set_gone(true);
  return request;
}

}  // namespace overtone
