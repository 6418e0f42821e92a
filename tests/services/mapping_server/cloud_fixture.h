// SPDX-License-Identifier: Apache-2.0
// Encoded clouds, and submaps that refer to them.
#ifndef OVERTONE_TESTS_SERVICES_MAPPING_SERVER_CLOUD_FIXTURE_H_
#define OVERTONE_TESTS_SERVICES_MAPPING_SERVER_CLOUD_FIXTURE_H_

#include <memory>
#include <random>
#include <string>
#include <vector>

#include "overtone/core/graph/point_cloud_codec.h"
#include "overtone/proto/conversion/sha256.h"
#include "overtone/tests/proto/conversion_fixture.h"

namespace overtone::testing {

// Points at random in a cube of 100 m: about 4 bytes each. Another seed, other bytes.
inline std::string EncodedCloud(int seed, int num_points = 50) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(-50, 50);
  PointCloud cloud;
  for (int i = 0; i < num_points; ++i) {
    cloud.points.emplace_back(uniform(random), uniform(random), uniform(random));
  }
  return *EncodePointCloud(cloud, {});
}

// As MakeSubmap, a cloud for each keyframe from its first on, as far as there are blobs.
inline Submap MakeSubmapWithClouds(int64_t sequence, int64_t first_index, int num_keyframes,
                                   const std::vector<std::string>& blobs) {
  Submap submap = MakeSubmap(sequence, first_index, num_keyframes);
  for (size_t i = 0; i < blobs.size(); ++i) {
    submap.clouds.push_back({first_index + static_cast<int64_t>(i), nullptr, Sha256(blobs[i]),
                             static_cast<int64_t>(blobs[i].size())});
  }
  return submap;
}

}  // namespace overtone::testing

#endif  // OVERTONE_TESTS_SERVICES_MAPPING_SERVER_CLOUD_FIXTURE_H_
