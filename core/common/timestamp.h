// SPDX-License-Identifier: Apache-2.0
// Time on a robot's clock, in integer nanoseconds. Never a double: today's epoch leaves 256 ns
// steps there.
#ifndef OVERTONE_CORE_COMMON_TIMESTAMP_H_
#define OVERTONE_CORE_COMMON_TIMESTAMP_H_

#include <cstdint>

namespace overtone {

struct Timestamp {
  int64_t ns = 0;

  friend bool operator==(Timestamp a, Timestamp b) { return a.ns == b.ns; }
  friend bool operator!=(Timestamp a, Timestamp b) { return a.ns != b.ns; }
  friend bool operator<(Timestamp a, Timestamp b) { return a.ns < b.ns; }
  friend bool operator<=(Timestamp a, Timestamp b) { return a.ns <= b.ns; }
  friend bool operator>(Timestamp a, Timestamp b) { return a.ns > b.ns; }
  friend bool operator>=(Timestamp a, Timestamp b) { return a.ns >= b.ns; }
};

// end - begin in seconds. The difference is taken in integers, so only it is rounded.
inline double SecondsBetween(Timestamp begin, Timestamp end) {
  return 1e-9 * static_cast<double>(end.ns - begin.ns);
}

}  // namespace overtone

#endif  // OVERTONE_CORE_COMMON_TIMESTAMP_H_
