// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/estimation/serial_openmp.h"

#include "gtest/gtest.h"

namespace overtone {
namespace {

TEST(SerialOpenMp, AllowsNoParallelRegionWhileItLivesAndThenAsManyAsBefore) {
  omp_set_max_active_levels(3);
  {
    const SerialOpenMp serial;
    EXPECT_EQ(omp_get_max_active_levels(), 0);
  }
  EXPECT_EQ(omp_get_max_active_levels(), 3);
}

}  // namespace
}  // namespace overtone
