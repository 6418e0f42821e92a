// SPDX-License-Identifier: Apache-2.0
// Is anything wrong at all? Server and robot never agree to the millimetre; how far apart they are
// while nothing is wrong is learned, for each wavelet band by itself.
#ifndef OVERTONE_CORE_SYNCHRONIZATION_NOISE_FLOOR_H_
#define OVERTONE_CORE_SYNCHRONIZATION_NOISE_FLOOR_H_

#include <array>
#include <cstdint>
#include <deque>

#include "Eigen/Core"
#include "overtone/core/synchronization/synchronization_options.h"
#include "overtone/core/synchronization/trajectory_comparison.h"

namespace overtone {

// One band of one comparison.
struct BandLevel {
  // Standard deviation of the band's coefficients while nothing is wrong, units of the signal.
  double noise = 0;
  double largest = 0;  // coefficient of a node, in units of `noise`
  bool exceeds = true;
};

using BandLevels = std::array<BandLevel, 3>;  // by Band

// For one mission. Not thread-safe.
//
// Of one comparison the noise of a band is 1.4826 times the median of its coefficients' magnitudes
// over the nodes (the MAD: their own median is 0), which nodes that have drifted do not move while
// they are the fewer. Of many it is the median of the last 16 that ended without a correction; it
// may be twice the lowest that it has been, no more, so that what drifts slowly cannot teach it.
// Until there are eight, white noise stands for all bands, as the comparison itself has it along
// the mission: by the second differences of its signals, which no smooth drift has. (Not by the
// small band: where a robot comes back, drift has high graph frequencies.) A floor is never less
// than what the server's publication tolerance does to the signal. A new map_epoch begins anew.
//
// A band exceeds its noise where a node has more than sqrt(2 ln(3 n / p)) of it: of n nodes and
// three bands of Gaussian noise none does, but for a probability below p (Chernoff and union
// bounds; a band that sums over scales or channels has lighter tails).
class NoiseFloor {
 public:
  explicit NoiseFloor(const SynchronizationOptions& options);

  BandLevels Judge(const TrajectoryComparison& comparison) const;

  // The comparison ended without a correction.
  void Learn(const TrajectoryComparison& comparison);

 private:
  Eigen::Array3d Noise(const TrajectoryComparison& comparison) const;
  Eigen::Array3d Typical() const;  // median of what was learned

  const SynchronizationOptions options_;
  const double least_;                  // units of the signal
  std::deque<Eigen::Array3d> learned_;  // of single comparisons, the newest last
  Eigen::Array3d lowest_;               // that Typical() has been
  uint64_t map_epoch_ = 0;
};

bool AnyExceeds(const BandLevels& levels);

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_NOISE_FLOOR_H_
