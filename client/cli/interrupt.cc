// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/interrupt.h"

#include <signal.h>

namespace overtone {
namespace {

volatile sig_atomic_t interrupted = 0;

void Note(int /*signal*/) { interrupted = 1; }

}  // namespace

void CatchInterrupts() {
  struct sigaction action = {};
  action.sa_handler = Note;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

absl::Status CheckInterrupted() {
  return interrupted ? absl::CancelledError("interrupted") : absl::OkStatus();
}

}  // namespace overtone
