// SPDX-License-Identifier: Apache-2.0
// g2o, planar and spatial: what is read can be written, and has as many vertices and edges then.
#include <sstream>

#include "overtone/core/graph/g2o_io.h"
#include "overtone/tests/fuzz/fuzz_input.h"

namespace overtone::fuzz {
namespace {

void Run(absl::string_view input) {
  std::istringstream in{std::string(input)};
  const absl::StatusOr<G2oFile> graph = ReadG2o(in, "fuzz");
  if (!graph.ok()) return;
  FUZZ_CHECK(graph->graph.poses.size() == graph->vertex_ids.size(), "ids and poses differ");
  for (const PoseGraphEdge& edge : graph->graph.edges) {
    const int vertices = static_cast<int>(graph->graph.poses.size());
    FUZZ_CHECK(edge.from >= 0 && edge.from < vertices, "an edge from nowhere");
    FUZZ_CHECK(edge.to >= 0 && edge.to < vertices, "an edge to nowhere");
  }
  std::stringstream file;
  WriteG2o(file, *graph);
  const absl::StatusOr<G2oFile> again = ReadG2o(file, "written");
  // Vertices that edges placed may lie further out than a file may say.
  if (!again.ok()) return;
  FUZZ_CHECK(again->vertex_ids == graph->vertex_ids, "vertices changed");
  FUZZ_CHECK(again->graph.edges.size() == graph->graph.edges.size(), "edges are lost");
}

}  // namespace
}  // namespace overtone::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  overtone::fuzz::Run(overtone::fuzz::AsText(data, size));
  return 0;
}
