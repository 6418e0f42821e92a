// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/dashboard/track_frame.h"

#include <cstring>

#include "absl/base/config.h"

namespace overtone {
namespace {

#ifndef ABSL_IS_LITTLE_ENDIAN
#error "frames are written as this host keeps numbers"
#endif

constexpr size_t kCountOffset = 4;

template <typename Number>
void Append(const Number* numbers, size_t count, std::string& bytes) {
  if (count > 0) bytes.append(reinterpret_cast<const char*>(numbers), count * sizeof(Number));
}

}  // namespace

TrackFrame::TrackFrame(uint64_t version, const Eigen::Vector3d& origin) {
  bytes_.append("OVT1");
  const uint32_t count = 0;
  Append(&count, 1, bytes_);
  const double exact_version = static_cast<double>(version);  // counts from 0: below 2^53
  Append(&exact_version, 1, bytes_);
  Append(origin.data(), 3, bytes_);
}

void TrackFrame::Add(uint32_t mission, const Track& track) {
  const uint32_t header[2] = {mission, static_cast<uint32_t>(track.size())};
  Append(header, 2, bytes_);
  Append(track.index.data(), track.index.size(), bytes_);
  Append(track.values.data(), track.values.size(), bytes_);
  uint32_t count = 0;
  std::memcpy(&count, &bytes_[kCountOffset], sizeof(count));
  ++count;
  std::memcpy(&bytes_[kCountOffset], &count, sizeof(count));
}

}  // namespace overtone
