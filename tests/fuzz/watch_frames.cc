// SPDX-License-Identifier: Apache-2.0
// What a robot is sent on WatchGraph: snapshots and deltas, one after the other.
#include "overtone/proto/conversion/graph_conversion.h"
#include "overtone/tests/fuzz/message_input.h"
#include "overtone/tests/proto/conversion_fixture.h"
#include "overtone/v1/mapping_service.pb.h"

namespace overtone::fuzz {
namespace {

GraphFormat Whole(GraphEncoding encoding) {
  GraphFormat format;
  format.encoding = encoding;
  format.include_edges = true;
  return format;
}

// A graph that was taken can be passed on as it is: whole, and as the difference to the one before.
void CheckPassedOn(const MapGraph& base, const MapGraph& graph) {
  const GraphFormat plain = Whole(v1::GRAPH_ENCODING_PLAIN);
  const absl::StatusOr<MapGraph> again = FromProto(ToProto(graph, plain));
  FUZZ_CHECK(again.ok(), again.status().ToString());
  FUZZ_CHECK(testing::SameGraph(*again, graph), "changed on its way");
  // There are deltas only from one revision to a later one of its epoch.
  if (base.map_epoch != graph.map_epoch || base.revision >= graph.revision) return;
  const absl::StatusOr<MapGraph> applied = ApplyDelta(base, MakeDelta(base, graph, plain));
  FUZZ_CHECK(applied.ok(), applied.status().ToString());
  FUZZ_CHECK(testing::SameGraph(*applied, graph), "the delta makes another graph");
}

void Run(absl::string_view input) {
  MapGraph held;
  for (const absl::string_view bytes : Messages(input)) {
    v1::WatchGraphResponse frame;
    if (!Parse(bytes, &frame)) continue;
    if (!frame.has_snapshot() && !frame.has_delta()) continue;
    const absl::StatusOr<MapGraph> graph =
        frame.has_snapshot() ? FromProto(frame.snapshot()) : ApplyDelta(held, frame.delta());
    if (!graph.ok()) continue;
    CheckPassedOn(held, *graph);
    held = *graph;
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
  return overtone::fuzz::MutateFrames<overtone::v1::WatchGraphResponse>(data, size, max_size, seed);
}
