// SPDX-License-Identifier: Apache-2.0
// What a MultiRobotMap holds, and the steps of one optimisation. Internal: its sources share it.
//   multi_robot_map.cc              what comes in, and what goes out as a snapshot
//   multi_robot_map_motions.cc      odometry, and what makes it finer
//   multi_robot_map_decisions.cc    what an operator says
//   multi_robot_map_activation.cc   what has come complete and takes part from now on
//   multi_robot_map_consistency.cc  which closures between two missions agree
//   multi_robot_map_frames.cc       which missions share a frame
//   multi_robot_map_graph.cc        from missions and measurements to a pose graph
//   multi_robot_map_solution.cc     from a pose graph to a solution and back
//   multi_robot_map_checkpoint.cc   what is kept over a restart
#ifndef OVERTONE_CORE_MAPPING_MULTI_ROBOT_MAP_STATE_H_
#define OVERTONE_CORE_MAPPING_MULTI_ROBOT_MAP_STATE_H_

#include <atomic>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "overtone/core/estimation/pairwise_consistency.h"
#include "overtone/core/estimation/pose_graph_optimizer.h"
#include "overtone/core/mapping/frame_joining.h"
#include "overtone/core/mapping/mission_chain.h"
#include "overtone/core/mapping/multi_robot_map.h"

namespace overtone {

// A sighting on its way into the optimiser.
struct SightingRecord {
  NodeId observer;
  std::string landmark;  // or, when empty:
  std::string robot;     // whose mission, keyframe and point in its frame follow from the stamp
  NodeId target;
  Eigen::Vector3d point_in_target = Eigen::Vector3d::Zero();
  Eigen::Vector3d point_in_body = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  bool pending = true;  // the other robot's keyframes are not there yet
  double weight = 1;    // of the robust optimisation
};

struct AbsoluteRecord {
  NodeId node;
  Rigid3d map_from_body;
  Matrix6d covariance = Matrix6d::Identity();
  double weight = 1;
};

// The pose graph of the whole map, and where each of its parts came from. Of a mission it has the
// joints and an edge for each stretch between two of them (mission_chain.h).
struct MapProblem {
  PoseGraph graph;                    // pose 0 is the world, which absolute poses refer to
  std::vector<int> first_pose;        // of each mission
  std::vector<int> first_edge;        // of each mission
  std::vector<int> edge_of_closure;   // -1: not in play
  std::vector<int> edge_of_absolute;  // -1: its mission is in a frame of its own as yet
  std::vector<int> row_of_sighting;   // -1: pending, or between two frames
  std::vector<std::pair<int, std::string>> landmark_of;  // frame and id of each landmark
};

// Missions are in the order in which they came. Between two revisions `component` names a frame by
// its oldest mission's position, or is kWorld; poses of different frames have nothing to do with
// each other.
struct MultiRobotMap::State {
  static constexpr int kWorld = -1;

  MultiRobotMapOptions options;
  uint64_t map_epoch = 0;
  uint64_t revision = 0;
  bool dirty = false;
  std::vector<SnapshotMission> missions;
  // Of each mission: the motion into each keyframe, odometry's or finer, the path they make, and
  // what the optimiser sees of it.
  std::vector<ChainMotions> motions;
  std::vector<UncertainTrajectory> odometry;
  std::vector<MissionChain> chains;
  std::map<int, int64_t> refined;  // missions whose path is not made anew yet, and from where
  std::map<MissionId, int> position_of;

  std::vector<ClosureRecord> closures;
  std::vector<ClosureDecision> decisions;  // of each closure
  std::map<std::string, int> closure_of_id;
  std::map<std::pair<int, int>, PairwiseConsistency> consistency;  // of two missions
  std::vector<int> consistency_row;  // of each closure in that of its missions; < 0: none

  std::vector<SightingRecord> sightings;
  std::vector<AbsoluteRecord> absolutes;
  std::map<std::pair<int, std::string>, Eigen::Vector3d> landmarks;  // by frame and id

  PoseGraphResult last_result;  // its figures; the estimate is in `missions`
  RevisionHistory history;

  // What an operator said.
  void Veto(int closure);
  bool IsVetoed(int closure) const;
  // In use, or forced since the last revision.
  bool WouldUse(int closure) const;

  // What comes in.
  void AppendKeyframes(const Submap& submap, int position);
  void AppendMeasurements(const MissionId& mission, const Submap& submap);
  void InsertCandidate(const LoopCandidate& candidate);
  absl::Status RefineMotion(const MotionMeasurement& measurement, int position);
  void FollowRefinedMotions();
  int64_t LastTiedIndex(int position) const;
  Matrix6d MotionCovariance(const Keyframe* previous, const Keyframe& keyframe) const;

  // nullptr: not in the map yet.
  const Rigid3d* PoseOf(const NodeId& node) const;
  int PositionOf(const NodeId& node) const { return position_of.at(node.mission); }
  int FrameOf(const NodeId& node) const { return missions[PositionOf(node)].component; }
  static bool BetweenMissions(const ClosureRecord& record) {
    return record.candidate.from.mission != record.candidate.to.mission;
  }
  // Measured, both ends known, and neither figures nor operator against it.
  bool InPlay(int closure) const;
  // May join frames and keep them joined. One corridor is like another, and what only looks alike
  // even more so: these hold together what others have joined.
  static bool TiesMissions(const ClosureRecord& record) {
    return record.verdict == ClosureVerdict::kForcedByOperator ||
           (!IsWeak(record.candidate) && record.candidate.proposer != LoopEvidence::kRobotScore);
  }

  // Before the optimisation.
  void ActivateClosures();
  void ActivateSightings();
  void Locate(SightingRecord& sighting) const;
  bool TakesPartInConsistency(int closure) const;
  bool AgreesWithMost(const InterMissionClosure& closure,
                      const std::vector<InterMissionClosure>& rows, const std::vector<int>& members,
                      const UncertainTrajectory& a, const UncertainTrajectory& b) const;
  void JudgeAgainstOdometry();
  void JudgeWeakClosures();
  void JudgeConsistency();
  bool JudgePair(const std::pair<int, int>& pair, const std::vector<int>& closures_of_pair,
                 std::vector<int>& regained);

  // Everything that ties two frames.
  struct Ties {
    std::vector<FrameTie> poses;
    std::vector<int> closures;  // of each pose tie; -1: an absolute pose
    std::vector<PointTie> points;
    bool certain = false;  // an operator or a surveyed pose says so
    bool may_join = false;
    int support = 0;  // size of the largest consistent set among the closures
  };
  using TiesOfFrames = std::map<std::pair<int, int>, Ties>;
  // Whose ties may join frames: those of closures in use, or all that are in play.
  enum class Joining { kInUse, kAll };
  TiesOfFrames CollectTies(Joining joining) const;
  void AddClosureTies(Joining joining, TiesOfFrames& ties) const;
  void AddLandmarkTies(TiesOfFrames& ties) const;
  void AddSightingTies(TiesOfFrames& ties) const;
  void AddAbsoluteTies(TiesOfFrames& ties) const;
  bool Suffice(const Ties& ties, const FrameAlignment& alignment) const;
  // The closures whose measurements aligned the frames (-1: points).
  std::vector<int> JoinFrames(Joining joining);
  bool JoinBestTiedFrames(Joining joining, std::vector<int>& aligning);
  void Quarantine();
  FrameTie TieOf(const LoopCandidate& candidate) const;
  void MoveFrame(int frame, const Rigid3d& new_from_old, int new_frame);

  // The optimisation.
  bool TakesPart(int closure) const;
  void FindJoints();
  int RowOf(const MapProblem& problem, const NodeId& node) const;
  MapProblem BuildProblem();
  void AddMissions(MapProblem& problem) const;
  void AddClosures(MapProblem& problem) const;
  void AddAbsolutes(MapProblem& problem) const;
  void AddSightings(MapProblem& problem);
  const std::atomic<bool>* give_up = nullptr;  // of the optimisation under way
  size_t poses_at_full_solve = 0;
  PoseGraphOptimizerOptions SolverOptions() const;
  void UseWeights(const MapProblem& problem, PoseGraphOptimizerOptions& solver) const;
  absl::StatusOr<PoseGraphResult> SolveOnce(const PoseGraph& graph,
                                            const PoseGraphOptimizerOptions& solver, bool warm);
  absl::StatusOr<PoseGraphResult> Solve(MapProblem& problem, bool warm);
  double MoveMissions(const PoseGraphResult& result, MapProblem& problem);
  bool Demotes(bool between_missions, const PoseGraphResult& result,
               const MapProblem& problem) const;
  enum class Shapes { kPresent, kOfOdometry };
  absl::Status Reconsider(Shapes shapes, MapProblem problem, PoseGraphResult& result);
  absl::StatusOr<PoseGraphResult> SolveAndReconsider(MapProblem& problem);
  void Unbend();
  double TruncatedCost(const MapProblem& problem, const PoseGraphResult& result) const;
  void TakeResult(const PoseGraphResult& result, const MapProblem& problem);
  void SetVerdict(ClosureRecord& record, ClosureVerdict verdict) const;

  // What an optimisation that is given up leaves behind: everything where it was.
  struct Estimate {
    std::vector<int> components;
    std::vector<std::vector<Rigid3d>> poses;  // of each mission
    std::map<std::pair<int, std::string>, Eigen::Vector3d> landmarks;
  };
  Estimate Save() const;
  void GoBack(Estimate estimate);

  // After it.
  void SplitFrames();
  std::shared_ptr<const MapSnapshot> Freeze() const;
  std::shared_ptr<const MapSnapshot> Publish(const PoseGraphResult& result);

  absl::Status CheckFits(const MapCheckpoint& checkpoint) const;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_MAPPING_MULTI_ROBOT_MAP_STATE_H_
