// SPDX-License-Identifier: Apache-2.0
// What optimisation has made of a map, and what operators decided. Given the same submaps,
// closures, candidates and motions in the same order, MultiRobotMap::Restore makes the map again
// from it, without solving anything.
#ifndef OVERTONE_CORE_MAPPING_MAP_CHECKPOINT_H_
#define OVERTONE_CORE_MAPPING_MAP_CHECKPOINT_H_

#include <cstdint>
#include <string>
#include <vector>

#include "overtone/core/common/ids.h"
#include "overtone/core/geometry/se3.h"
#include "overtone/core/mapping/loop_closure.h"
#include "overtone/core/mapping/revision_history.h"

namespace overtone {

// What an operator said of a closure last. A roll-back must know which vetoed ones were forced.
enum class ClosureDecision { kNone, kForced, kVetoed, kVetoedAfterForced };

// All decisions that stand, none of them kNone, and the epoch that the last roll-back began.
struct MapDecisions {
  struct Decision {
    std::string id;  // of the closure
    ClosureDecision decision = ClosureDecision::kNone;
  };
  uint64_t map_epoch = 0;
  std::vector<Decision> decisions;
};

struct MapCheckpoint {
  struct Mission {
    MissionId id;
    int frame = 0;  // the position of its oldest mission, or -1: the world
    std::vector<Rigid3d> frame_from_body;
  };
  struct Closure {
    std::string id;
    ClosureVerdict verdict = ClosureVerdict::kPending;
    double weight = 0;
    double chi_square = 0;
    uint64_t since_revision = 0;
    int consistent_set = 0;
  };
  struct Landmark {
    int frame = 0;
    std::string id;
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
  };

  uint64_t revision = 0;
  std::vector<Mission> missions;  // in the order in which they came
  std::vector<Closure> closures;  // likewise
  std::vector<double> sighting_weights;
  std::vector<double> absolute_weights;
  std::vector<Landmark> landmarks;
  MapDecisions decisions;
  std::vector<RevisionRecord> revisions;  // oldest first
  double initial_cost = 0;
  double final_cost = 0;
  bool converged = true;
  double optimisation_s = 0;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_MAPPING_MAP_CHECKPOINT_H_
