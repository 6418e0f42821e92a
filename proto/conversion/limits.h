// SPDX-License-Identifier: Apache-2.0
// Every limit that the schema's comments state, in one place. Both ends enforce them.
#ifndef OVERTONE_PROTO_CONVERSION_LIMITS_H_
#define OVERTONE_PROTO_CONVERSION_LIMITS_H_

#include <cstdint>

namespace overtone::limits {

// Metres; more than twice the way around the Earth's mean radius, and still exact to nanometres in
// a double.
constexpr double kMaxPositionM = 1e7;
// | |v| - 1 | of a direction.
constexpr double kDirectionTolerance = 1e-3;
// | |q| - 1 |: what float32 and printed decimals need; beyond it the quaternion is a mistake.
constexpr double kQuaternionTolerance = 1e-3;
// m^2 and rad^2: below, the information overflows; above, the measurement says nothing.
constexpr double kMinVariance = 1e-18;
constexpr double kMaxVariance = 1e12;
// Smallest eigenvalue of the correlation matrix of a covariance that still counts as positive
// definite.
constexpr double kMinCorrelationEigenvalue = 1e-10;

// Nanoseconds, year 2096: differences of two stamps cannot overflow.
constexpr int64_t kMaxStampNs = 4'000'000'000'000'000'000;
constexpr int64_t kMaxKeyframeIndex = 1'000'000'000;
constexpr int64_t kMaxSequence = 1'000'000'000;

constexpr int kMaxKeyframesPerSubmap = 2000;
constexpr int kMaxLoopClosuresPerSubmap = 2000;
constexpr int kMaxCandidatesPerSubmap = 2000;
constexpr int kMaxCloudsPerSubmap = 2000;
constexpr int kMaxSightingsPerSubmap = 10'000;  // of landmarks, and as many of robots
constexpr int kMaxAbsolutePosesPerSubmap = 2000;
constexpr int kMaxLoopClosuresPerRequest = 2000;
constexpr int64_t kMaxSubmapBytes = 1 << 20;

// The largest request of all, a submap, with what is around it. Not more: decoded, a message of
// many empty fields takes a hundred times its size.
constexpr int64_t kMaxRequestBytes = kMaxSubmapBytes + (64 << 10);

constexpr int kSha256Bytes = 32;
constexpr int64_t kMaxBlobBytes = 16 << 20;
constexpr int64_t kMaxBlobChunkBytes = 512 << 10;
constexpr int kMaxWantsPerFrame = 256;

constexpr int kMaxGraphNodes = 1'000'000;
constexpr double kMaxPositionResolutionM = 1.0;
constexpr double kMaxRotationResolutionRad = 0.1;
constexpr int64_t kMaxStampResolutionNs = 1'000'000'000;

// A status message travels in a header.
constexpr int kMaxStatusMessageBytes = 1024;

}  // namespace overtone::limits

#endif  // OVERTONE_PROTO_CONVERSION_LIMITS_H_
