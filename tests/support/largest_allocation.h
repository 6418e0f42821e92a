// SPDX-License-Identifier: Apache-2.0
// Sees every allocation of the test that links it; for what must be refused before memory is taken.
#ifndef OVERTONE_TESTS_SUPPORT_LARGEST_ALLOCATION_H_
#define OVERTONE_TESTS_SUPPORT_LARGEST_ALLOCATION_H_

#include <cstddef>

namespace overtone::testing {

// Bytes of the largest single one since the last call, by operator new on any thread.
size_t TakeLargestAllocation();

}  // namespace overtone::testing

#endif  // OVERTONE_TESTS_SUPPORT_LARGEST_ALLOCATION_H_
