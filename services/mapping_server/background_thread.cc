// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/background_thread.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace overtone {
namespace {

constexpr int kLower = 5, kLowest = 19;

}  // namespace

void RunInBackground() {
  // On Linux a thread has a nice value of its own.
  errno = 0;
  const int now = getpriority(PRIO_PROCESS, static_cast<id_t>(gettid()));
  if (now == -1 && errno != 0) return;
  // Lowering is always allowed; where it is not, nothing is lost but the courtesy.
  (void)setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), std::min(now + kLower, kLowest));
}

}  // namespace overtone
