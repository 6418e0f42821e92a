// SPDX-License-Identifier: Apache-2.0
// Where the submaps and closures of one map are kept. What it has taken, and nothing else, is
// acknowledged.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_H_

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "overtone/core/common/ids.h"
#include "overtone/core/graph/submap.h"

namespace overtone {

// How far a mission's upload has come.
struct UploadState {
  int64_t next_sequence = 0;
  int64_t next_index = 0;  // one past the last stored keyframe
  Timestamp last_stamp;    // of that keyframe; no meaning while next_index is 0
  absl::Time stored_at = absl::InfinitePast();  // server clock
  int64_t missing_blobs = 0;                    // clouds whose blobs are wanted
};

struct SubmapRecord {
  MissionId mission;
  std::shared_ptr<const Submap> submap;
  std::string digest;  // of what the robot sent
};

struct LoopClosureRecord {
  LoopClosure closure;
  std::string digest;
};

struct AppendResult {
  bool added = false;  // false: was there already, with the same digest
  UploadState state;   // of the mission, afterwards
};

// An encoded cloud, named by its SHA-256 (32 bytes).
using SharedBlob = std::shared_ptr<const std::string>;

struct MissingBlob {
  std::string sha256;
  int64_t encoded_bytes = 0;  // as the submap says
};

// Of a whole map.
struct CloudCounts {
  int64_t stored = 0;   // submap and blob are both there
  int64_t missing = 0;  // the blob is wanted
};

// Thread-safe. All missions of one map.
class SubmapStore {
 public:
  // Called once for everything newly stored, in the order in which it was stored, before it is
  // acknowledged.
  struct Sink {
    std::function<void(const MissionId&, std::shared_ptr<const Submap>)> on_submap;
    std::function<void(const LoopClosure&)> on_loop_closure;
    // A keyframe's cloud, when submap and blob are both there. Of the store it may call GetBlob,
    // and nothing else.
    std::function<void(const MissionId&, int64_t index, const std::string& sha256)> on_cloud;
    // The robot cannot send it, so that on_cloud will hardly follow.
    std::function<void(const MissionId&, int64_t index)> on_cloud_gone;
  };

  virtual ~SubmapStore() = default;

  // Stores the next submap of a mission. `done` is called exactly once, from any thread, possibly
  // before this returns and possibly after many further calls: appends may be made durable
  // together. Done with
  //   AlreadyExists       the sequence is there with another digest
  //   OutOfRange          the sequence leaves a gap
  //   InvalidArgument     first_index or the first stamp does not continue the mission
  //   ResourceExhausted   a limit of the map
  // and then nothing is stored.
  virtual void Append(SubmapRecord record,
                      std::function<void(absl::StatusOr<AppendResult>)> done) = 0;

  // Stores all or none; gives the number of those that were new. ResourceExhausted: a limit of the
  // map.
  virtual void AppendLoopClosures(std::vector<LoopClosureRecord> records,
                                  std::function<void(absl::StatusOr<int>)> done) = 0;

  // Stores a blob that a stored submap refers to; all missions share it. The caller has checked the
  // digest. A blob that is there already is Ok. `done` as in Append; NotFound: no cloud waits for
  // it; ResourceExhausted: limits.max_stored_blob_bytes.
  virtual void PutBlob(const std::string& sha256, SharedBlob blob,
                       std::function<void(absl::Status)> done) = 0;

  // NotFound: not there.
  virtual absl::StatusOr<SharedBlob> GetBlob(const std::string& sha256) const = 0;

  // The mission's robot cannot send this blob: it is not missing any more, but its cloud comes into
  // being should another mission send it.
  virtual void AbandonBlob(const MissionId& mission, const std::string& sha256) = 0;

  // The mission's first `max` missing blobs, each once, by keyframe.
  virtual std::vector<MissingBlob> MissingBlobs(const MissionId& mission, size_t max) const = 0;

  virtual CloudCounts Clouds() const = 0;

  // A mission that is not there expects sequence 0.
  virtual UploadState State(const MissionId& mission) const = 0;
  virtual std::map<MissionId, UploadState> Missions() const = 0;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_H_
