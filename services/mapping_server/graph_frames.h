// SPDX-License-Identifier: Apache-2.0
// From snapshots to the bytes that readers are sent. Each revision is built once for each query,
// and each frame serialised once for all readers that ask for the same and stand at the same
// revision.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_GRAPH_FRAMES_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_GRAPH_FRAMES_H_

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <tuple>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "grpcpp/support/byte_buffer.h"
#include "overtone/core/graph/map_graph.h"
#include "overtone/core/mapping/map_snapshot.h"
#include "overtone/proto/conversion/graph_conversion.h"
#include "overtone/services/mapping_server/server_options.h"

namespace overtone {

// What a reader wants to see. Readers with equal queries share a graph and its history.
struct GraphQuery {
  int max_nodes = 0;
  bool include_edges = false;
  std::string robot;  // empty: all

  friend bool operator<(const GraphQuery& a, const GraphQuery& b) {
    return std::tie(a.max_nodes, a.include_edges, a.robot) <
           std::tie(b.max_nodes, b.include_edges, b.robot);
  }
};

// Where a reader stands. Revision 0: nowhere.
struct GraphPosition {
  uint64_t map_epoch = 0;
  uint64_t revision = 0;
};

// Checks a request and fills in the server's own limit and `default_encoding`. InvalidArgument
// naming the field.
absl::StatusOr<GraphQuery> ReadQuery(const v1::GraphRequestOptions& options, int server_max_nodes);
absl::StatusOr<GraphEncoding> ReadEncoding(const v1::GraphRequestOptions& options,
                                           GraphEncoding default_encoding);

// Not thread-safe: the publisher's thread owns it.
class GraphFrames {
 public:
  GraphFrames(std::string map, uint64_t first_epoch, const ServerOptions& options);

  // `snapshot` is newer than the one before, or the first, or of a new epoch.
  void SetSnapshot(std::shared_ptr<const MapSnapshot> snapshot);

  // The newest revision, 0 before the first snapshot.
  GraphPosition position() const;

  // The newest revision for a query. ResourceExhausted: too large for a message.
  absl::StatusOr<v1::Graph> Newest(const GraphQuery& query, GraphEncoding encoding);

  // A serialised WatchGraphResponse that takes a reader from where it stands to the newest
  // revision: a DELTA when its revision is still in the history, else a SNAPSHOT.
  // ResourceExhausted: too large for a message.
  absl::StatusOr<grpc::ByteBuffer> Frame(const GraphQuery& query, GraphEncoding encoding,
                                         const GraphPosition& reader);
  grpc::ByteBuffer Heartbeat() const;

 private:
  struct Variant {
    std::deque<MapGraph> history;  // as published, newest last
    int64_t nodes = 0;             // in the history
    uint64_t last_use = 0;
    // Of the newest revision, by encoding and base revision (0: snapshot).
    std::map<std::pair<GraphEncoding, uint64_t>, grpc::ByteBuffer> frames;
  };

  // The variant, with the newest revision at the end of its history.
  absl::StatusOr<Variant*> Updated(const GraphQuery& query);
  absl::StatusOr<MapGraph> Build(const GraphQuery& query) const;
  // Forgets the variants that were not used for longest, never the one in use.
  void MakeRoom();
  int64_t NodesToKeep() const;
  GraphFormat Format(const GraphQuery& query, GraphEncoding encoding) const;

  const std::string map_;
  const uint64_t first_epoch_;  // before the first snapshot
  const GraphMonitorOptions graph_options_;
  const PublisherOptions options_;
  const int64_t max_message_bytes_;
  const size_t max_variants_;                    // as many as can be watched at once
  std::shared_ptr<const MapSnapshot> snapshot_;  // null before the first
  std::map<GraphQuery, Variant> variants_;
  int64_t nodes_ = 0;  // of all variants
  uint64_t uses_ = 0;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_GRAPH_FRAMES_H_
