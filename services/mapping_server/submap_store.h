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

// What the robot sent, checked, and the bytes that are stored: the message serialised
// deterministically (submap_digest.h).
struct SubmapRecord {
  MissionId mission;
  std::shared_ptr<const Submap> submap;
  std::string bytes;   // overtone.v1.Submap
  std::string digest;  // SHA-256 of `bytes`
};

struct LoopClosureRecord {
  LoopClosure closure;
  std::string bytes;  // overtone.v1.LoopClosure
  std::string digest;
};

// What the server found out itself, or an operator decided: the map's own affair (map_log.h), bytes
// to the store.
struct FindingRecord {
  std::string bytes;
  std::vector<MissionId> missions;  // that it is about: it goes when one of these is deleted
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

// What a store holds and what it lost to damage (a bit that flipped, a page that cannot be read).
struct StoreReport {
  int64_t missions = 0;
  int64_t submaps = 0;
  int64_t loop_closures = 0;
  int64_t findings = 0;
  int64_t blobs = 0;
  int64_t bytes_on_disk = 0;
  std::vector<std::string> losses;  // a sentence each, what and which; empty: all is whole
};

// Thread-safe. All missions of one map: a log of submaps, loop closures and findings in the order
// in which they were stored, the blobs of their clouds, and a snapshot of the map made from them.
//
// A damaged entry is left out, set aside in the store and reported. A mission that lost a submap
// keeps those before it, and takes no more (DataLoss): its keyframes would hang in the air.
class SubmapStore {
 public:
  // Called once for everything newly stored, in the order in which it was stored, after it is
  // durable and before it is acknowledged; and by Replay. No call overlaps another.
  struct Sink {
    std::function<void(const MissionId&, std::shared_ptr<const Submap>)> on_submap;
    std::function<void(const LoopClosure&)> on_loop_closure;
    std::function<void(const std::string& bytes)> on_finding;
    // A keyframe's cloud, when submap and blob are both there. Of the store it may call GetBlob,
    // and nothing else.
    std::function<void(const MissionId&, int64_t index, const std::string& sha256)> on_cloud;
    // The robot cannot send it, so that on_cloud will hardly follow.
    std::function<void(const MissionId&, int64_t index)> on_cloud_gone;
  };

  virtual ~SubmapStore() = default;

  // Hands all that is stored to the sink: the log in its order, then the clouds by mission and
  // keyframe. To be called once, before all else. An error says that nothing can be read at all.
  virtual absl::Status Replay() = 0;

  // Stores the next submap of a mission. `done` is called exactly once, from any thread, possibly
  // before this returns and possibly after many further calls: appends may be made durable
  // together. Done with
  //   AlreadyExists       the sequence is there with another digest
  //   OutOfRange          the sequence leaves a gap
  //   InvalidArgument     first_index or the first stamp does not continue the mission
  //   ResourceExhausted   a limit of the map, or the disk is full or fails: may work later
  //   DataLoss            the mission lost an earlier submap to damage
  // and then nothing is stored.
  virtual void Append(SubmapRecord record,
                      std::function<void(absl::StatusOr<AppendResult>)> done) = 0;

  // Stores all or none; gives the number of those that were new. ResourceExhausted: a limit of the
  // map.
  virtual void AppendLoopClosures(std::vector<LoopClosureRecord> records,
                                  std::function<void(absl::StatusOr<int>)> done) = 0;

  // Stored in the order of these calls. `done` as in Append.
  virtual void AppendFinding(FindingRecord record, std::function<void(absl::Status)> done) = 0;

  // Stores a blob that a stored submap refers to; all missions share it. The caller has checked the
  // digest. A blob that is there already is Ok. `done` as in Append; NotFound: no cloud waits for
  // it; ResourceExhausted: limits.max_stored_blob_bytes.
  virtual void PutBlob(const std::string& sha256, SharedBlob blob,
                       std::function<void(absl::Status)> done) = 0;

  // NotFound: not there. DataLoss: damaged; it is set aside and its clouds are wanted again.
  // ResourceExhausted: the disk fails.
  virtual absl::StatusOr<SharedBlob> GetBlob(const std::string& sha256) const = 0;

  // The mission's robot cannot send this blob: it is not missing any more, but its cloud comes into
  // being should another mission send it. True at once; made durable like all else, but should the
  // disk be full, it is asked for again after a restart.
  virtual void AbandonBlob(const MissionId& mission, const std::string& sha256) = 0;

  // The mission's first `max` missing blobs, each once, by keyframe.
  virtual std::vector<MissingBlob> MissingBlobs(const MissionId& mission, size_t max) const = 0;

  virtual CloudCounts Clouds() const = 0;

  // The map as it was last solved, in place of the one before; bytes to the store (map_log.h).
  virtual void PutSnapshot(std::string bytes, std::function<void(absl::Status)> done) = 0;
  // NotFound: none, or it is damaged.
  virtual absl::StatusOr<std::string> GetSnapshot() const = 0;

  // Deletes the mission's submaps, the findings about it, loop closures with an end in it, the
  // blobs that no other mission refers to, and the snapshot, and gives their space back to the file
  // system. What other missions' submaps say of it stays in them. The sink is told nothing: the map
  // has to be made anew. Not to be called from sink or `done`. NotFound: no such mission.
  virtual absl::Status DeleteMission(const MissionId& mission) = 0;

  // Reads all that is stored and checks it against its digests, while the store goes on.
  virtual StoreReport Verify() const = 0;
  // A consistent copy as a new file, while the store goes on. AlreadyExists: the file is there.
  virtual absl::Status Backup(const std::string& path) const = 0;

  // Waits until all that was given to it so far is done: sinks and `done`s called.
  virtual void Drain() = 0;
  // How much of it is not done yet.
  virtual int64_t Backlog() const = 0;

  // A mission that is not there expects sequence 0.
  virtual UploadState State(const MissionId& mission) const = 0;
  virtual std::map<MissionId, UploadState> Missions() const = 0;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_H_
