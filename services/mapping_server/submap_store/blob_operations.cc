// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/submap_store/blob_operations.h"

#include "absl/time/clock.h"
#include "overtone/services/mapping_server/failpoint.h"

namespace overtone {

absl::Status PutBlobOperation::Write(BatchPlan& plan, StoreTables& tables) {
  added_ = plan.AdmitBlob(sha256_, bytes());
  if (!added_.ok() || !*added_) return absl::OkStatus();
  id_ = plan.NextBlobId();
  plan.Changed();
  return tables.PutBlob(id_, sha256_, *blob_);
}

void PutBlobOperation::Publish(StoreIndex& index, SinkCalls& calls) {
  if (!added_.ok() || !*added_) return;
  for (const NodeId& keyframe : index.AddBlob(sha256_, id_, bytes())) {
    calls.push_back([keyframe, sha256 = sha256_](const SubmapStore::Sink& sink) {
      sink.on_cloud(keyframe.mission, keyframe.index, sha256);
    });
  }
}

void PutBlobOperation::Finish(const absl::Status& batch) {
  done_(batch.ok() ? added_.status() : batch);
}

absl::Status AbandonOperation::Write(BatchPlan& plan, StoreTables& tables) {
  plan.Changed();
  return tables.PutAbandoned({plan.NextAbandonedId(), mission_, sha256_});
}

void AbandonOperation::Publish(StoreIndex& index, SinkCalls& calls) {
  // It came after all: another robot had it, and was faster.
  if (!index.IsAwaited(sha256_)) return;
  for (const NodeId& keyframe : keyframes_) {
    calls.push_back([keyframe](const SubmapStore::Sink& sink) {
      sink.on_cloud_gone(keyframe.mission, keyframe.index);
    });
  }
}

absl::Status PutSnapshotOperation::Write(BatchPlan& plan, StoreTables& tables) {
  Failpoint("snapshot_before_write");
  plan.Changed();
  return tables.PutSnapshot(absl::ToUnixMicros(absl::Now()), snapshot_);
}

// The snapshot is durable.
void PutSnapshotOperation::Publish(StoreIndex&, SinkCalls&) { Failpoint("snapshot_after_write"); }

}  // namespace overtone
