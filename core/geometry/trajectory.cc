// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/geometry/trajectory.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <string>
#include <tuple>

#include "absl/strings/str_cat.h"

namespace overtone {
namespace {

// A stamp of either list in their merged, sorted order, linked to those not yet associated on
// either side.
struct MergedStamp {
  int64_t ns;
  bool from_a;
  int index;  // in its own list
  int previous;
  int next;
  bool taken = false;
};

std::vector<MergedStamp> Merge(const std::vector<Timestamp>& a, const std::vector<Timestamp>& b) {
  std::vector<MergedStamp> merged;
  merged.reserve(a.size() + b.size());
  for (int i = 0; i < a.size(); ++i) merged.push_back({a[i].ns, true, i, 0, 0});
  for (int i = 0; i < b.size(); ++i) merged.push_back({b[i].ns, false, i, 0, 0});
  std::sort(merged.begin(), merged.end(), [](const MergedStamp& x, const MergedStamp& y) {
    return std::tie(x.ns, x.from_a, x.index) < std::tie(y.ns, y.from_a, y.index);
  });
  for (int i = 0; i < merged.size(); ++i) {
    merged[i].previous = i - 1;
    merged[i].next = i + 1 < merged.size() ? i + 1 : -1;
  }
  return merged;
}

// Nanoseconds, saturating; -1 when no difference can be within the tolerance.
double ToNanoseconds(double tolerance_s) {
  return tolerance_s >= 0 ? std::round(tolerance_s * 1e9) : -1;
}

}  // namespace

std::vector<Timestamp> Stamps(const Trajectory& trajectory) {
  std::vector<Timestamp> stamps;
  stamps.reserve(trajectory.size());
  for (const StampedPose& pose : trajectory) stamps.push_back(pose.stamp);
  return stamps;
}

std::vector<Rigid3d> Poses(const Trajectory& trajectory) {
  std::vector<Rigid3d> poses;
  poses.reserve(trajectory.size());
  for (const StampedPose& pose : trajectory) poses.push_back(pose.pose);
  return poses;
}

absl::StatusOr<Rigid3d> Interpolate(const Trajectory& trajectory, Timestamp stamp) {
  const auto after =
      std::lower_bound(trajectory.begin(), trajectory.end(), stamp,
                       [](const StampedPose& pose, Timestamp time) { return pose.stamp < time; });
  if (after != trajectory.end() && after->stamp == stamp) return after->pose;
  if (after == trajectory.begin() || after == trajectory.end()) {
    return absl::OutOfRangeError(absl::StrCat("stamp ", stamp.ns, " ns is outside the trajectory"));
  }
  const StampedPose& end = *after;
  const StampedPose& begin = *(after - 1);
  const double fraction =
      SecondsBetween(begin.stamp, stamp) / SecondsBetween(begin.stamp, end.stamp);
  const Eigen::Vector3d turn = LogSO3(begin.pose.rotation.conjugate() * end.pose.rotation);
  return Rigid3d(begin.pose.rotation * ExpSO3(fraction * turn),
                 (1 - fraction) * begin.pose.translation + fraction * end.pose.translation);
}

// The closest pair among those left is always next to each other in merged order: whatever lay
// between them would be at least as close to one of the two. So a queue of neighbours suffices.
std::vector<std::pair<int, int>> AssociateByTime(const std::vector<Timestamp>& a,
                                                 const std::vector<Timestamp>& b,
                                                 double tolerance_s) {
  const double tolerance_ns = ToNanoseconds(tolerance_s);
  std::vector<MergedStamp> merged = Merge(a, b);
  using Candidate = std::tuple<uint64_t, int, int>;  // difference [ns], left, right
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<Candidate>> closest_first;
  const auto consider = [&](int left, int right) {
    if (left < 0 || right < 0 || merged[left].from_a == merged[right].from_a) return;
    // Unsigned: right for stamps at the two ends of int64, too.
    const uint64_t difference =
        static_cast<uint64_t>(merged[right].ns) - static_cast<uint64_t>(merged[left].ns);
    if (static_cast<double>(difference) <= tolerance_ns) {
      closest_first.emplace(difference, left, right);
    }
  };
  for (int i = 0; i + 1 < merged.size(); ++i) consider(i, i + 1);

  std::vector<std::pair<int, int>> pairs;
  while (!closest_first.empty()) {
    const auto [difference, left, right] = closest_first.top();
    closest_first.pop();
    if (merged[left].taken || merged[right].taken) continue;
    merged[left].taken = merged[right].taken = true;
    const MergedStamp& in_a = merged[left].from_a ? merged[left] : merged[right];
    const MergedStamp& in_b = merged[left].from_a ? merged[right] : merged[left];
    pairs.emplace_back(in_a.index, in_b.index);
    const int before = merged[left].previous, after = merged[right].next;
    if (before >= 0) merged[before].next = after;
    if (after >= 0) merged[after].previous = before;
    consider(before, after);
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

double PathLength(const Trajectory& trajectory) { return PathLength(Poses(trajectory)); }

double PathLength(const std::vector<Rigid3d>& poses) {
  double length = 0;
  for (size_t i = 1; i < poses.size(); ++i) {
    length += (poses[i].translation - poses[i - 1].translation).norm();
  }
  return length;
}

}  // namespace overtone
