// SPDX-License-Identifier: Apache-2.0
// Sends every new revision of a map to its readers; the newest wins. A reader is sent the next
// frame when it has taken the one before, made at that moment from where it stands to the newest
// revision: a slow reader skips revisions and costs one shared buffer, never a queue.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_GRAPH_PUBLISHER_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_GRAPH_PUBLISHER_H_

#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <unordered_map>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "overtone/services/mapping_server/graph_frames.h"

namespace overtone {

// One open WatchGraph. Called on the publisher's thread.
class GraphReader {
 public:
  virtual ~GraphReader() = default;
  // A serialised WatchGraphResponse, with which the reader has `revision`. It calls Ready() when it
  // is written; until then no other comes.
  virtual void Send(const grpc::ByteBuffer& frame, uint64_t revision) = 0;
  // The last call.
  virtual void End(const absl::Status& status) = 0;
};

struct Subscription {
  GraphQuery query;
  GraphEncoding encoding = v1::GRAPH_ENCODING_COMPACT;
  GraphPosition position;  // resume after it
};

// Thread-safe; its own thread builds and serialises. No call waits for that.
class GraphPublisher {
 public:
  GraphPublisher(const std::string& map, uint64_t map_epoch, const ServerOptions& options);
  // As Stop.
  ~GraphPublisher();

  void Publish(std::shared_ptr<const MapSnapshot> snapshot);

  void Subscribe(std::shared_ptr<GraphReader> reader, Subscription subscription);
  // The reader has written its frame.
  void Ready(const GraphReader* reader);
  // No call to the reader begins once this has been worked off; unknown readers are ignored.
  void Unsubscribe(const GraphReader* reader);

  // Answers on the publisher's thread, with Unavailable after Stop.
  void GetNewest(GraphQuery query, GraphEncoding encoding,
                 std::function<void(absl::StatusOr<v1::Graph>)> done);

  // Ends every reader with UNAVAILABLE, saying why, and the thread. Not from the publisher's
  // thread.
  void Stop(const std::string& why = "the server is shutting down");

 private:
  struct Reader {
    std::shared_ptr<GraphReader> reader;
    Subscription subscription;
    absl::Time last_sent;
    bool ready = true;
  };
  using Command = std::function<void()>;

  // False after Stop: the command is not taken.
  bool Enqueue(Command command);
  void Run();
  // Sleeps until there is something to do or a heartbeat is due. False: the end.
  bool TakeWork(std::vector<Command>& commands, std::shared_ptr<const MapSnapshot>& snapshot);
  void Serve();
  // False: the reader was ended.
  bool ServeReader(Reader& reader, absl::Time now);
  void EndReaders();
  absl::Status Stopped();

  const std::string map_;
  const int max_readers_;
  const absl::Duration heartbeat_;
  // The thread's own.
  GraphFrames frames_;
  std::unordered_map<const GraphReader*, Reader> readers_;
  absl::Time next_heartbeat_ = absl::InfiniteFuture();

  absl::Mutex mutex_;
  std::vector<Command> commands_ ABSL_GUARDED_BY(mutex_);
  std::shared_ptr<const MapSnapshot> snapshot_ ABSL_GUARDED_BY(mutex_);  // newest, not taken yet
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
  std::string why_ ABSL_GUARDED_BY(mutex_);  // it stops
  std::thread thread_;                       // last: starts when all else is there
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_GRAPH_PUBLISHER_H_
