// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/failpoint.h"

#include <atomic>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "absl/strings/numbers.h"

namespace overtone::failpoint_internal {
namespace {

struct Setting {
  std::string name;
  int64_t count = 0;
};

// Never destroyed: threads may pass a point while the process ends.
const Setting& TheSetting() {
  static const Setting* const setting = [] {
    auto* parsed = new Setting;
    const char* text = std::getenv("OVERTONE_FAILPOINT");
    const std::string value = text == nullptr ? "" : text;
    const size_t colon = value.rfind(':');
    if (colon == std::string::npos) return parsed;
    parsed->name = value.substr(0, colon);
    if (!absl::SimpleAtoi(value.substr(colon + 1), &parsed->count)) parsed->count = 0;
    return parsed;
  }();
  return *setting;
}

}  // namespace

const bool armed = TheSetting().count > 0;

void Pass(absl::string_view name) {
  static std::atomic<int64_t> passes{0};
  if (name == TheSetting().name && ++passes == TheSetting().count) std::raise(SIGKILL);
}

}  // namespace overtone::failpoint_internal
