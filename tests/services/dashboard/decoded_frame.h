// SPDX-License-Identifier: Apache-2.0
// Reads frames as the page does (track_frame.h), written apart from what writes them.
#ifndef OVERTONE_TESTS_SERVICES_DASHBOARD_DECODED_FRAME_H_
#define OVERTONE_TESTS_SERVICES_DASHBOARD_DECODED_FRAME_H_

#include <cstdint>
#include <cstring>
#include <map>
#include <string>

#include "gtest/gtest.h"
#include "overtone/services/dashboard/track.h"

namespace overtone::testing {

struct DecodedFrame {
  explicit DecodedFrame(const std::string& bytes) : bytes_(bytes) {
    if (bytes.size() < 40 || bytes.substr(0, 4) != "OVT1") {
      ADD_FAILURE() << "not a frame: " << bytes.size() << " bytes";
      return;
    }
    at_ = 4;
    const auto count = Take<uint32_t>();
    version = Take<double>();
    for (double& value : origin) value = Take<double>();
    for (uint32_t i = 0; i < count; ++i) {
      Track& track = tracks[Take<uint32_t>()];
      const auto size = Take<uint32_t>();
      for (uint32_t k = 0; k < size; ++k) track.index.push_back(Take<int32_t>());
      for (uint32_t k = 0; k < 3 * size; ++k) track.values.push_back(Take<float>());
    }
    EXPECT_EQ(at_, bytes.size());
  }

  double version = -1;
  double origin[3] = {};
  std::map<uint32_t, Track> tracks;

 private:
  template <typename Number>
  Number Take() {
    Number number{};
    EXPECT_LE(at_ + sizeof(number), bytes_.size());
    EXPECT_EQ(at_ % sizeof(number), 0u) << "typed arrays of a browser must be aligned";
    if (at_ + sizeof(number) <= bytes_.size()) {
      std::memcpy(&number, &bytes_[at_], sizeof(number));
    }
    at_ += sizeof(number);
    return number;
  }

  const std::string bytes_;
  size_t at_ = 0;
};

}  // namespace overtone::testing

#endif  // OVERTONE_TESTS_SERVICES_DASHBOARD_DECODED_FRAME_H_
