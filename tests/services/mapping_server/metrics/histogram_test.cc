// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/metrics/histogram.h"

#include <limits>
#include <thread>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;

TEST(Histogram, ABoundBelongsToTheBucketBelowIt) {
  Histogram<3> histogram({1, 2, 5});
  for (const double value :
       {-1.0, 1.0, 1.0001, 2.0, 5.0, 5.0001, std::numeric_limits<double>::max()}) {
    histogram.Observe(value);
  }
  EXPECT_THAT(histogram.Counts(), ElementsAre(2, 2, 1, 2));
}

TEST(Histogram, TheSumIsThatOfWhatWasObserved) {
  Histogram<1> histogram({0.5});
  for (const double value : {0.25, 0.5, 4.0}) histogram.Observe(value);
  EXPECT_DOUBLE_EQ(histogram.Sum(), 4.75);
}

TEST(Histogram, NothingIsLostAmongThreads) {
  Histogram<2> histogram({1, 2});
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&histogram, t] {
      for (int i = 0; i < 10'000; ++i) histogram.Observe(t < 2 ? 0.5 : 3);
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_THAT(histogram.Counts(), ElementsAre(20'000, 0, 20'000));
  EXPECT_DOUBLE_EQ(histogram.Sum(), 20'000 * 3.5);
}

}  // namespace
}  // namespace overtone
