// SPDX-License-Identifier: Apache-2.0
#include "overtone/tests/fault/submap_ledger.h"

#include "overtone/proto/conversion/limits.h"
#include "overtone/proto/conversion/sha256.h"

namespace overtone {

grpc::Status SubmapLedger::Serve(ScriptedMappingServer::Upload& upload) {
  upload.Ready(static_cast<int64_t>(books().submaps.size()));
  Stream stream;
  while (true) {
    Ask(stream, upload);
    const v1::UploadSubmapsRequest frame = upload.ReadFrame();
    if (frame.has_submap()) {
      Take(frame.submap(), upload);
    } else if (frame.has_blob()) {
      Take(frame.blob(), stream, upload);
    } else {
      return grpc::Status::OK;
    }
  }
}

SubmapLedger::Books SubmapLedger::books() const {
  absl::MutexLock lock(&mutex_);
  Books books = books_;
  books.clouds_lacking = static_cast<int64_t>(lacking_.size());
  return books;
}

void SubmapLedger::Take(const v1::Submap& submap, ScriptedMappingServer::Upload& upload) {
  {
    absl::MutexLock lock(&mutex_);
    const int64_t next = static_cast<int64_t>(books_.submaps.size());
    std::string bytes = submap.SerializeAsString();
    if (submap.sequence() > next) {
      ++books_.gaps;
      return;
    }
    if (submap.sequence() < next) {
      ++(bytes == books_.submaps[submap.sequence()] ? books_.sent_again : books_.conflicts);
    } else {
      books_.submaps.push_back(std::move(bytes));
      for (const v1::CloudReference& cloud : submap.clouds()) {
        lacking_[cloud.sha256()] = cloud.encoded_bytes();
      }
    }
  }
  upload.Ack(submap.sequence());
}

void SubmapLedger::Take(const v1::BlobChunk& chunk, Stream& stream,
                        ScriptedMappingServer::Upload& upload) {
  if (chunk.offset() == 0) stream.assembled.clear();
  stream.assembled += chunk.data();
  {
    absl::MutexLock lock(&mutex_);
    const auto it = lacking_.find(chunk.sha256());
    const bool whole =
        it == lacking_.end() || static_cast<int64_t>(stream.assembled.size()) >= it->second;
    if (!whole && !chunk.gone()) return;
    books_.clouds_gone += chunk.gone();
    if (it != lacking_.end() && Sha256(stream.assembled) == chunk.sha256()) {
      ++books_.clouds;
      lacking_.erase(it);
    }
  }
  stream.asked.erase(chunk.sha256());
  upload.BlobResult(chunk.sha256(),
                    chunk.gone() ? grpc::StatusCode::NOT_FOUND : grpc::StatusCode::OK);
}

void SubmapLedger::Ask(Stream& stream, ScriptedMappingServer::Upload& upload) {
  std::vector<std::string> wanted;
  bool nothing_lacks = false;
  {
    absl::MutexLock lock(&mutex_);
    nothing_lacks = lacking_.empty();
    for (const auto& [sha256, bytes] : lacking_) {
      if (stream.asked.size() >= limits::kMaxWantsPerFrame) break;
      if (stream.asked.insert(sha256).second) wanted.push_back(sha256);
    }
  }
  if (nothing_lacks || !wanted.empty()) upload.Want(wanted);
}

}  // namespace overtone
