// SPDX-License-Identifier: Apache-2.0
// seeded_race one: two threads hand a number back and forth under one absl::Mutex, by Await and
// LockWhen. No race.
// seeded_race two: each under a mutex of its own. A race, although both lock.
#include <cstdio>
#include <cstring>
#include <thread>

#include "absl/synchronization/mutex.h"

namespace {

constexpr int kRounds = 100;
int number = 0;  // even: the first thread's turn

void HandOver(absl::Mutex* mutex, int parity) {
  const auto my_turn = [parity] { return number % 2 == parity; };
  for (int round = 0; round < kRounds; ++round) {
    if (round % 2 == 0) {
      mutex->LockWhen(absl::Condition(&my_turn));
    } else {
      mutex->Lock();
      mutex->Await(absl::Condition(&my_turn));
    }
    ++number;
    mutex->Unlock();
  }
}

void Count(absl::Mutex* mutex) {
  for (int round = 0; round < kRounds; ++round) {
    absl::MutexLock lock(mutex);
    ++number;
  }
}

}  // namespace

int main(int argc, char** argv) {
  const bool two = argc == 2 && std::strcmp(argv[1], "two") == 0;
  absl::Mutex first, second;
  std::thread other([&] { two ? Count(&second) : HandOver(&first, 1); });
  two ? Count(&first) : HandOver(&first, 0);
  other.join();
  std::printf("%d\n", number);
  return 0;
}
