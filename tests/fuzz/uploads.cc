// SPDX-License-Identifier: Apache-2.0
// UploadSubmaps: header, submaps and blobs of one stream, as rpc/upload_submaps.cc takes them. What
// is taken must be fit for the map; the store is but its rules.
#include "overtone/core/mapping/multi_robot_map.h"
#include "overtone/proto/conversion/field_path.h"
#include "overtone/proto/conversion/id_conversion.h"
#include "overtone/proto/conversion/status_conversion.h"
#include "overtone/proto/conversion/submap_conversion.h"
#include "overtone/services/mapping_server/cloud_ledger.h"
#include "overtone/services/mapping_server/rpc/blob_assembly.h"
#include "overtone/services/mapping_server/server_options.h"
#include "overtone/services/mapping_server/upload_rules.h"
#include "overtone/tests/fuzz/message_input.h"

namespace overtone::fuzz {
namespace {

constexpr size_t kMaxWanted = 256;

// What is kept of a submap goes out and comes in again as it is.
void CheckPassedOn(const Submap& submap, const MissionId& mission) {
  const v1::Submap message = ToProto(submap);
  const absl::StatusOr<Submap> again = FromProto(message, mission);
  FUZZ_CHECK(again.ok(), again.status().ToString());
  FUZZ_CHECK(ToProto(*again).SerializeAsString() == message.SerializeAsString(),
             "changed on its way");
}

class Stream {
 public:
  Stream() : map_(MultiRobotMapOptions()) {}

  // False: the stream ends.
  bool Take(const v1::UploadSubmapsRequest& frame) {
    switch (frame.frame_case()) {
      case v1::UploadSubmapsRequest::kHeader:
        return TakeHeader(frame.header());
      case v1::UploadSubmapsRequest::kSubmap:
        if (has_mission_) TakeSubmap(frame.submap());
        return has_mission_;
      case v1::UploadSubmapsRequest::kBlob:
        if (has_mission_) TakeBlob(frame.blob());
        return has_mission_;
      case v1::UploadSubmapsRequest::FRAME_NOT_SET:
        return false;
    }
    return false;
  }

 private:
  bool TakeHeader(const v1::UploadHeader& header) {
    if (has_mission_ || !ValidateId(header.map(), "header.map").ok()) return false;
    absl::StatusOr<MissionId> mission = AtField("header.mission", FromProto(header.mission()));
    has_mission_ = mission.ok();
    if (has_mission_) mission_ = *std::move(mission);
    return has_mission_;
  }

  void TakeSubmap(const v1::Submap& message) {
    const absl::StatusOr<Submap> submap = AtField("submap", FromProto(message, mission_));
    if (!submap.ok()) {
      FUZZ_CHECK(absl::IsInvalidArgument(submap.status()), submap.status().ToString());
      (void)ToGrpcStatus(submap.status());
      return;
    }
    CheckPassedOn(*submap, mission_);
    if (!CheckContinues(state_, *submap).ok()) return;
    AddToMap(*submap);
    state_.next_sequence = submap->sequence + 1;
    state_.next_index = submap->first_index + static_cast<int64_t>(submap->keyframes.size());
    state_.last_stamp = submap->keyframes.back().stamp;
    for (const KeyframeCloud& cloud : submap->clouds) clouds_.Await(mission_, cloud);
  }

  void AddToMap(const Submap& submap) {
    const absl::Status added = map_.AddSubmap(mission_, submap);
    FUZZ_CHECK(added.ok(), added.ToString());
    for (const ScoredCandidate& candidate : submap.candidates) {
      const absl::Status scored = map_.AddScoredCandidate(candidate);
      FUZZ_CHECK(scored.ok(), scored.ToString());
    }
  }

  void TakeBlob(const v1::BlobChunk& chunk) {
    absl::optional<int64_t> wanted_bytes;
    for (const MissingBlob& missing : clouds_.Missing(mission_, kMaxWanted)) {
      if (missing.sha256 == chunk.sha256()) wanted_bytes = missing.encoded_bytes;
    }
    absl::optional<BlobAssembly::Outcome> outcome = assembly_.Take(chunk, wanted_bytes);
    if (!outcome.has_value()) return;
    if (!outcome->status.ok()) {
      if (wanted_bytes.has_value()) clouds_.Abandon(mission_, outcome->sha256);
      return;
    }
    FUZZ_CHECK(!clouds_.Resolve(outcome->sha256).empty(), "taken, and nobody waited for it");
  }

  UploadState state_;
  CloudLedger clouds_;
  MultiRobotMap map_;
  BlobAssembly assembly_{ServerLimits().max_blob_bytes};
  bool has_mission_ = false;
  MissionId mission_;
};

void Run(absl::string_view input) {
  Stream stream;
  for (const absl::string_view bytes : Messages(input)) {
    v1::UploadSubmapsRequest frame;
    if (!Parse(bytes, &frame)) return;
    if (!stream.Take(frame)) return;
  }
}

}  // namespace
}  // namespace overtone::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  overtone::fuzz::Run(overtone::fuzz::AsText(data, size));
  return 0;
}

extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t max_size,
                                          unsigned seed) {
  return overtone::fuzz::MutateFrames<overtone::v1::UploadSubmapsRequest>(data, size, max_size,
                                                                          seed);
}
