// SPDX-License-Identifier: Apache-2.0
// Latency of a loop: from handing in a submap that closes one, clouds and all, to the published
// revision that uses the closure. Detector (2 threads) and mapping thread run as in the server;
// store, network and graph publication are left out. Argument: keyframes in the map.
//
// Synthetic: one robot drives up and down a way of 100 places. Its first pass has clouds, all later
// ones none, but a closure each fifth keyframe to where it was a round trip before: so the map is
// as large as it says, and few clouds need be simulated. Then another robot drives the way, four
// keyframes with clouds to a submap. Its first three submaps tie it to the map; the others are
// timed.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <random>
#include <vector>

#include "absl/synchronization/mutex.h"
#include "absl/time/clock.h"
#include "benchmark/benchmark.h"
#include "overtone/benchmark/simulated_places.h"
#include "overtone/services/mapping_server/loop_detector.h"
#include "overtone/services/mapping_server/mapping_pipeline.h"
#include "overtone/tests/core/mapping/map_test_support.h"
#include "overtone/tests/services/mapping_server/blob_shelf.h"
#include "spdlog/spdlog.h"

namespace overtone {
namespace {

constexpr int kPlaces = 100;
constexpr int kRoundTrip = 2 * (kPlaces - 1);
constexpr int kBackgroundSubmap = 20, kClosingSubmap = 4;
constexpr int kTyingSubmaps = 3;
constexpr int kSubmapsPerRevision = 50;  // while the map is built

// The place of a keyframe that goes up and down the way.
int PlaceOf(int64_t index) {
  const int phase = static_cast<int>(index % kRoundTrip);
  return phase < kPlaces ? phase : kRoundTrip - phase;
}

class Rig {
 public:
  // The map of one robot with so many keyframes.
  explicit Rig(int num_keyframes) {
    pipeline_.Start(absl::nullopt);
    for (int i = 0; i < num_keyframes; i += kBackgroundSubmap) {
      AddSubmap(first_, std::min(kBackgroundSubmap, num_keyframes - i));
      if (i / kBackgroundSubmap % kSubmapsPerRevision == 0) WaitUntilIdle();
    }
    WaitUntilIdle();
  }

  struct Closing {
    double latency_s = 0;
    double detection_s = 0;  // to the first candidate that was measured
    double solves_s = 0;     // of the optimiser, in all revisions since the submap
    int revisions = 0;
  };

  int submaps_left() const { return (kPlaces - again_.size()) / kClosingSubmap; }

  // Of the other robot's next submap. False: no closure came of it.
  bool Close(Closing& closing) {
    WaitUntilIdle();
    const int64_t first_index = again_.size();
    const uint64_t revision = Newest()->revision;
    {
      absl::MutexLock lock(&mutex_);
      measured_at_ = absl::InfiniteFuture();
      solves_s_ = 0;
    }
    const absl::Time begin = absl::Now();
    AddSubmap(again_, kClosingSubmap);
    const auto in_use = [this, first_index]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
      return last_closed_ >= first_index;
    };
    while (true) {
      const bool idle = backlog() == 0;
      absl::MutexLock lock(&mutex_);
      if (mutex_.AwaitWithTimeout(absl::Condition(&in_use), absl::Milliseconds(20))) break;
      if (idle) return false;
    }
    absl::MutexLock lock(&mutex_);
    closing.latency_s = absl::ToDoubleSeconds(published_at_ - begin);
    closing.detection_s = absl::ToDoubleSeconds(measured_at_ - begin);
    closing.solves_s = closing_solves_s_;
    closing.revisions = static_cast<int>(closing_revision_ - revision);
    return true;
  }

  size_t num_closures() const { return Newest()->closures.size(); }

 private:
  struct Drive {
    MissionId mission;
    std::vector<SimulatedPlace> places;
    std::mt19937 random;
    int64_t sequence = 0;
    std::vector<Rigid3d> odometry;
    int64_t size() const { return static_cast<int64_t>(odometry.size()); }
  };

  void AddSubmap(Drive& drive, int num_keyframes) {
    const int64_t begin = drive.size(), end = begin + num_keyframes;
    std::vector<LoopClosure> closures;
    std::vector<KeyframeCloud> clouds;
    for (int64_t i = begin; i < end; ++i) {
      Rigid3d motion;
      if (i > 0) {
        motion = drive.places[PlaceOf(i - 1)].world_from_body.Inverse() *
                 drive.places[PlaceOf(i)].world_from_body * Exp(Noise(kOdometryNoise, random_));
      }
      drive.odometry.push_back(i == 0 ? motion : drive.odometry.back() * motion);
      if (i < kPlaces) clouds.push_back({i, nullptr, std::string(32, 'c'), 1});
      if (i % 5 == 0 && i >= kRoundTrip) {
        closures.push_back(MakeClosure({drive.mission, i}, {drive.mission, i - kRoundTrip},
                                       Exp(Noise(kClosureNoise, random_)), kClosureNoise));
      }
    }
    auto submap = std::make_shared<Submap>(
        MakeSubmap(drive.sequence++, begin, {drive.odometry.begin() + begin, drive.odometry.end()},
                   kOdometryNoise));
    submap->loop_closures = std::move(closures);
    submap->clouds = clouds;
    pipeline_.AddSubmap(drive.mission, submap);
    detector_.AddSubmap(drive.mission, *submap);
    for (const KeyframeCloud& cloud : clouds) {
      detector_.AddCloud({drive.mission, cloud.index}, blobs_.Put(drive.places[cloud.index].blob));
    }
  }

  void OnSearch(SearchResult search) {
    if (!search.candidates.empty()) {
      absl::MutexLock lock(&mutex_);
      measured_at_ = std::min(measured_at_, absl::Now());
    }
    pipeline_.AddFinding(std::move(search));
  }

  void OnSnapshot(std::shared_ptr<const MapSnapshot> snapshot) {
    int64_t last_closed = -1;
    for (const ClosureRecord& record : snapshot->closures) {
      if (!InUse(record.verdict)) continue;
      for (const NodeId& end : {record.candidate.from, record.candidate.to}) {
        if (end.mission == again_.mission) last_closed = std::max(last_closed, end.index);
      }
    }
    absl::MutexLock lock(&mutex_);
    solves_s_ += snapshot->optimisation_s;
    newest_ = std::move(snapshot);
    if (last_closed <= last_closed_) return;
    last_closed_ = last_closed;
    published_at_ = absl::Now();
    closing_solves_s_ = solves_s_;
    closing_revision_ = newest_->revision;
  }

  std::shared_ptr<const MapSnapshot> Newest() const {
    absl::MutexLock lock(&mutex_);
    return newest_;
  }
  // Detector first: what leaves it is in the pipeline by then.
  int64_t backlog() const { return detector_.backlog() + pipeline_.backlog(); }
  // Polls, since neither says when it is done; yielding would take one of few cores.
  void WaitUntilIdle() const {
    while (backlog() > 0) absl::SleepFor(absl::Milliseconds(2));
  }

  const Matrix6d kOdometryNoise = Covariance(0.02, 0.003);
  const Matrix6d kClosureNoise = Covariance(0.03, 0.009);
  std::mt19937 random_{1};
  Drive first_ = {Mission("first"), SimulatePlaces(kPlaces, 0, 1)};
  Drive again_ = {Mission("again"), SimulatePlaces(kPlaces, 0.2, 2)};
  mutable absl::Mutex mutex_;
  std::shared_ptr<const MapSnapshot> newest_ ABSL_GUARDED_BY(mutex_) =
      std::make_shared<const MapSnapshot>();
  absl::Time measured_at_ ABSL_GUARDED_BY(mutex_);
  double solves_s_ ABSL_GUARDED_BY(mutex_) = 0;  // since the last submap to close a loop
  // The newest revision that closed one, and up to which of the other robot's keyframes.
  int64_t last_closed_ ABSL_GUARDED_BY(mutex_) = -1;
  absl::Time published_at_ ABSL_GUARDED_BY(mutex_);
  double closing_solves_s_ ABSL_GUARDED_BY(mutex_) = 0;
  uint64_t closing_revision_ ABSL_GUARDED_BY(mutex_) = 0;
  BlobShelf blobs_;
  MappingPipeline pipeline_{{},
                            {[this](std::shared_ptr<const MapSnapshot> snapshot,
                                    const RevisionHistory&) { OnSnapshot(snapshot); },
                             [](const std::string&, const std::function<void(absl::Status)>& done) {
                               done(absl::OkStatus());
                             }}};
  LoopDetector detector_{
      {},
      [this](const std::string& sha256) { return blobs_.Get(sha256); },
      {[this](SearchResult search) { OnSearch(std::move(search)); }, [](const RefinedMotion&) {},
       [](const LoopCandidate&) {}, [](const ScoredCandidate&) {}}};
};

// The smallest value that a share of them does not exceed, milliseconds.
double QuantileMs(const std::vector<Rig::Closing>& closings, double Rig::Closing::*part, double p) {
  std::vector<double> values;
  for (const Rig::Closing& closing : closings) values.push_back(1e3 * closing.*part);
  if (values.empty()) return NAN;
  std::sort(values.begin(), values.end());
  return values[std::max(0, static_cast<int>(std::ceil(p * values.size())) - 1)];
}

// The counters are of single closings, in ms; with some 20 of them p99 is the slowest. `growth` is
// the exponent of p50 against the smallest map.
void BM_CloseLoop(benchmark::State& state) {
  spdlog::set_level(spdlog::level::warn);
  static double smallest_map = 0, smallest_p50 = 0;
  Rig rig(static_cast<int>(state.range(0)));
  Rig::Closing closing;
  for (int i = 0; i < kTyingSubmaps; ++i) rig.Close(closing);
  std::vector<Rig::Closing> closings;
  int without = 0;
  for (auto _ : state) {
    while (rig.submaps_left() > 0) {
      if (rig.Close(closing)) {
        closings.push_back(closing);
      } else {
        ++without;
      }
    }
  }
  const double p50 = QuantileMs(closings, &Rig::Closing::latency_s, 0.5);
  double revisions = 0;
  for (const Rig::Closing& each : closings) revisions += each.revisions;
  state.counters["p50"] = p50;
  state.counters["p99"] = QuantileMs(closings, &Rig::Closing::latency_s, 0.99);
  state.counters["detection_p50"] = QuantileMs(closings, &Rig::Closing::detection_s, 0.5);
  state.counters["solves_p50"] = QuantileMs(closings, &Rig::Closing::solves_s, 0.5);
  state.counters["revisions"] = revisions / closings.size();
  state.counters["closings"] = closings.size();
  state.counters["without"] = without;
  state.counters["map_closures"] = rig.num_closures();
  if (smallest_map == 0) {
    smallest_map = state.range(0);
    smallest_p50 = p50;
  } else {
    state.counters["growth"] =
        std::log(p50 / smallest_p50) / std::log(state.range(0) / smallest_map);
  }
}

BENCHMARK(BM_CloseLoop)
    ->Arg(1'000)
    ->Arg(5'000)
    ->Arg(20'000)
    ->Iterations(1)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace overtone

BENCHMARK_MAIN();
