// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/request_id.h"

#include <atomic>
#include <cstdint>
#include <random>

#include "absl/strings/str_cat.h"

namespace overtone {
namespace {

// Steele, Lea, Flood: "Fast splittable pseudorandom number generators", 2014: a bijection, so that
// a counter gives no value twice.
uint64_t SplitMix64(uint64_t x) {
  x += 0x9e3779b97f4a7c15;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

uint64_t RandomSeed() {
  std::random_device device;
  return (uint64_t{device()} << 32) | device();
}

}  // namespace

std::string NewRequestId() {
  static std::atomic<uint64_t> next{RandomSeed()};
  return absl::StrCat(absl::Hex(SplitMix64(next.fetch_add(1)), absl::kZeroPad16));
}

std::string RequestIdOf(const grpc::CallbackServerContext& context) {
  const auto it = context.client_metadata().find(kRequestIdKey);
  if (it == context.client_metadata().end()) return "";
  return std::string(it->second.data(), it->second.size());
}

LogFields AboutCall(const grpc::CallbackServerContext& context, const std::string& map) {
  LogFields about = LogFieldsOf(map);
  about.request_id = RequestIdOf(context);
  return about;
}

}  // namespace overtone
