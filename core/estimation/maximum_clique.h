// SPDX-License-Identifier: Apache-2.0
// The largest set of nodes that are all neighbours of each other. NP-hard in general, quick on the
// graphs of consistent measurements, where one dense set stands out.
//
// Exact by branch and bound over bit sets: San Segundo, Rodriguez-Losada & Jimenez, "An exact
// bit-parallel algorithm for the maximum clique problem", Comput. Oper. Res. 38(2), 2011 (BBMC),
// with the bound of Tomita & Seki: nodes that can be coloured with c colours hold no clique of more
// than c. It starts from a clique found greedily, and only nodes whose core number allows a larger
// one take part. When the budget ends first, the best clique so far and a proven bound are
// returned.
#ifndef OVERTONE_CORE_ESTIMATION_MAXIMUM_CLIQUE_H_
#define OVERTONE_CORE_ESTIMATION_MAXIMUM_CLIQUE_H_

#include <cstdint>
#include <vector>

#include "absl/status/status.h"
#include "overtone/core/estimation/bit_graph.h"

namespace overtone {

struct CliqueOptions {
  // Branches of the search; a count and not a time, so that equal input gives equal output. One
  // costs about n^2 / 64 operations over the n nodes that take part.
  int64_t max_branches = 100000;

  absl::Status Validate() const;
};

struct Clique {
  std::vector<int> members;  // increasing
  int upper_bound = 0;       // no clique is larger; >= members.size()
  bool proven_maximum = true;
  int64_t branches = 0;
};

// preferred: nodes in range, best a clique found earlier. The ones that are neighbours of all
// before them are extended to a clique, which is kept unless there is a strictly larger one: equal
// evidence does not overturn what was chosen.
Clique MaximumClique(const BitGraph& graph, const std::vector<int>& preferred,
                     const CliqueOptions& options);

// The same among the nodes 0..node, from what is `known` of those before `node`: a larger clique
// must contain it, so only its neighbours are searched.
Clique MaximumCliqueWithOneMore(const BitGraph& graph, int node, const Clique& known,
                                const CliqueOptions& options);

}  // namespace overtone

#endif  // OVERTONE_CORE_ESTIMATION_MAXIMUM_CLIQUE_H_
