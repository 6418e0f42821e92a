// SPDX-License-Identifier: Apache-2.0
// The tracks of many missions as bytes that a browser lays over typed arrays without copying.
// Little-endian, every array at a multiple of its element's size:
//
//   offset  0  uint32  magic "OVT1"
//           4  uint32  number of missions
//           8  float64 version that the reader now has
//          16  float64 x 3  origin, metres, map frame: add it to a position of the map
//          40  for each mission:
//                uint32  number of the mission, as in the state
//                uint32  count
//                int32   x count      keyframe indices
//                float32 x 3 count    rows of three
#ifndef OVERTONE_SERVICES_DASHBOARD_TRACK_FRAME_H_
#define OVERTONE_SERVICES_DASHBOARD_TRACK_FRAME_H_

#include <cstdint>
#include <string>

#include "Eigen/Core"
#include "overtone/services/dashboard/track.h"

namespace overtone {

class TrackFrame {
 public:
  TrackFrame(uint64_t version, const Eigen::Vector3d& origin);

  void Add(uint32_t mission, const Track& track);

  const std::string& bytes() const { return bytes_; }
  std::string Release() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_DASHBOARD_TRACK_FRAME_H_
