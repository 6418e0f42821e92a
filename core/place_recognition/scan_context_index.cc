// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/place_recognition/scan_context_index.h"

#include <algorithm>
#include <utility>

#include "nanoflann.hpp"

namespace overtone {
namespace {

// The dataset nanoflann asks for.
struct Keys {
  const std::vector<ScanContext>& places;

  size_t kdtree_get_point_count() const { return places.size(); }
  float kdtree_get_pt(size_t place, size_t ring) const { return places[place].ring_key[ring]; }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

// The nearest few that may match; the others do not take up room.
class AdmittedNeighbours {
 public:
  using DistanceType = float;
  using IndexType = uint32_t;

  AdmittedNeighbours(int capacity, const std::function<bool(int)>& may_match)
      : nearest_(capacity), may_match_(may_match), places_(capacity), distances_(capacity) {
    nearest_.init(places_.data(), distances_.data());
  }

  bool addPoint(float distance, uint32_t place) {
    return !may_match_(static_cast<int>(place)) || nearest_.addPoint(distance, place);
  }
  float worstDist() const { return nearest_.worstDist(); }
  bool full() const { return nearest_.full(); }

  std::vector<uint32_t> Take() && {
    places_.resize(nearest_.size());
    return std::move(places_);
  }

 private:
  nanoflann::KNNResultSet<float, uint32_t> nearest_;
  const std::function<bool(int)>& may_match_;
  std::vector<uint32_t> places_;
  std::vector<float> distances_;
};

}  // namespace

// A forest of kd-trees whose sizes are powers of two: each place is sorted in O(log N) times.
class ScanContextIndex::RingKeys {
 public:
  RingKeys(int dimension, const std::vector<ScanContext>& places)
      : keys_{places}, forest_(dimension, keys_) {}

  void Add(uint32_t place) { forest_.addPoints(place, place); }

  std::vector<uint32_t> Nearest(const Eigen::VectorXf& ring_key, int count,
                                const std::function<bool(int)>& may_match) const {
    AdmittedNeighbours neighbours(count, may_match);
    forest_.findNeighbors(neighbours, ring_key.data(), nanoflann::SearchParams());
    return std::move(neighbours).Take();
  }

 private:
  const Keys keys_;
  nanoflann::KDTreeSingleIndexDynamicAdaptor<nanoflann::L2_Simple_Adaptor<float, Keys>, Keys>
      forest_;
};

ScanContextIndex::ScanContextIndex(const ScanContextOptions& options, int candidates)
    : options_(options),
      candidates_(candidates),
      ring_keys_(std::make_unique<RingKeys>(options.rings / 2, places_)) {}

ScanContextIndex::~ScanContextIndex() = default;

int ScanContextIndex::Add(ScanContext context) {
  const int place = size();
  places_.push_back(std::move(context));
  ring_keys_->Add(place);
  return place;
}

std::vector<PlaceMatch> ScanContextIndex::Search(const ScanContext& query, int k,
                                                 const std::function<bool(int)>& may_match) const {
  std::vector<PlaceMatch> matches;
  if (places_.empty() || query.seen.sum() == 0) return matches;
  for (const uint32_t place : ring_keys_->Nearest(query.ring_key, candidates_, may_match)) {
    const ScanContextMatch match = CompareScanContexts(query, places_[place], options_);
    matches.push_back({static_cast<int>(place), match.similarity, match.yaw_rad});
  }
  const auto best = matches.begin() + std::min<int64_t>(k, matches.size());
  std::partial_sort(matches.begin(), best, matches.end(), [](const auto& a, const auto& b) {
    return a.similarity != b.similarity ? a.similarity > b.similarity : a.place < b.place;
  });
  matches.erase(best, matches.end());
  return matches;
}

}  // namespace overtone
