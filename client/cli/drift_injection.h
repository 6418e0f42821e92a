// SPDX-License-Identifier: Apache-2.0
// A worse odometry than the recorded one, for data whose odometry is as good as the truth.
#ifndef OVERTONE_CLIENT_CLI_DRIFT_INJECTION_H_
#define OVERTONE_CLIENT_CLI_DRIFT_INJECTION_H_

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "overtone/client/cli/dataset.h"

namespace overtone {

// A random walk on top of the odometry: standard deviations per axis after 1 m of way.
struct DriftInjection {
  double translation_per_sqrt_m = 0;  // m
  double rotation_per_sqrt_m = 0;     // rad
  double seed = 1;
};

// "translation=0.02,rotation=0.005[,seed=1]". InvalidArgument: a number that is negative or too
// large, both zero.
absl::StatusOr<DriftInjection> ParseDriftInjection(absl::string_view text);

// One sentence for people: the rule, and that it was used.
std::string Describe(const DriftInjection& drift);

// Disturbs every step of the odometry on the right. `stream` tells the robots of one seed apart;
// the same arguments give the same drift on every platform. Covariances that came with the motions
// grow by it.
void InjectDrift(const DriftInjection& drift, uint64_t stream, Recording* recording);

// Trust in an odometry of this noise once it is disturbed.
MotionNoise WithDrift(MotionNoise noise, const DriftInjection& drift);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_DRIFT_INJECTION_H_
