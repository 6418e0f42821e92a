// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/report_heat_map.h"

#include <limits>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/client/cli/report_decimation.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

ComparisonRecord Record(double time_s, std::vector<int64_t> nodes, Eigen::MatrixXd discrepancy) {
  ComparisonRecord record;
  record.time_s = time_s;
  record.keyframe_index = std::move(nodes);
  record.discrepancy = std::move(discrepancy);
  return record;
}

// Five keyframes 1 m apart, four columns of 1 m. Nodes 0 and 2 meet half-way, at 1 m, in column 1;
// beyond node 2, at 2 m in column 2, nothing was compared.
TEST(HeatMap, ANodeStandsForThePathHalfWayToItsNeighbours) {
  Eigen::MatrixXd discrepancy(2, 3);
  discrepancy << 1, 0, 0,  //
      4, 0, 0;
  const HeatMap map =
      MakeHeatMap({Record(7, {0, 2}, discrepancy)}, {0, 1, 2, 3, 4}, /*max_rows=*/10, 4);
  EXPECT_EQ(map.columns, 4);
  EXPECT_EQ(map.max, 4);
  EXPECT_THAT(map.row_time, ElementsAre(7));
  // sqrt(1 / 4) * 63 rounds to 32, which is 'g'; the largest is '/', zero is 'A'.
  EXPECT_THAT(map.cells, ElementsAre("g// ", "AAA ", "AAA "));
}

TEST(HeatMap, RowsAreThinnedOutButTheLastStays) {
  std::vector<ComparisonRecord> records;
  for (int i = 0; i < 9; ++i) records.push_back(Record(i, {0, 1}, Eigen::MatrixXd::Ones(2, 3)));
  const HeatMap map = MakeHeatMap(records, {0, 1}, /*max_rows=*/3, /*columns=*/2);
  EXPECT_THAT(map.row_time, ElementsAre(0, 4, 8));
  EXPECT_EQ(map.cells[0], "//////");
}

TEST(HeatMap, ComparisonsThatDoNotFitTheRunAreSkipped) {
  const double inf = std::numeric_limits<double>::infinity();
  const HeatMap map = MakeHeatMap({Record(1, {0, 9}, Eigen::MatrixXd::Ones(2, 3)),
                                   Record(2, {0, 1}, Eigen::MatrixXd::Ones(2, 2)),
                                   Record(3, {1, 0}, Eigen::MatrixXd::Ones(2, 3)),
                                   Record(4, {-1, 0}, Eigen::MatrixXd::Ones(2, 3)),
                                   Record(5, {0, 1}, Eigen::MatrixXd::Constant(2, 3, inf)),
                                   Record(6, {}, Eigen::MatrixXd(0, 3))},
                                  {0, 1}, 10, 10);
  EXPECT_EQ(map.columns, 0);
  EXPECT_THAT(map.row_time, IsEmpty());
}

TEST(HeatMap, AgreementEverywhereIsDrawnAsZero) {
  const HeatMap map = MakeHeatMap({Record(1, {0, 1}, Eigen::MatrixXd::Zero(2, 3))}, {0, 1}, 10, 3);
  EXPECT_THAT(map.cells, ElementsAre("AAA", "AAA", "AAA"));
}

TEST(HeatMap, ARobotThatNeverMovedHasNone) {
  EXPECT_EQ(MakeHeatMap({Record(1, {0, 1}, Eigen::MatrixXd::Ones(2, 3))}, {0, 0}, 10, 3).columns,
            0);
}

TEST(EvenlySpread, KeepsFirstAndLast) {
  EXPECT_THAT(EvenlySpread(5, 10), ElementsAre(0, 1, 2, 3, 4));
  EXPECT_THAT(EvenlySpread(10, 4), ElementsAre(0, 3, 6, 9));
  EXPECT_THAT(EvenlySpread(1, 4), ElementsAre(0));
  EXPECT_THAT(EvenlySpread(0, 4), IsEmpty());
}

}  // namespace
}  // namespace overtone
