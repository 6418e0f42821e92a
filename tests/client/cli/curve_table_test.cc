// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/curve_table.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;

CurveRow Row(const std::string& strategy, int budget, int64_t edges, double corrected_m) {
  CurveRow row;
  row.sequence = "run";
  row.robot = "anna";
  row.strategy = strategy;
  row.mode = "once";
  row.budget = budget;
  row.edges = edges;
  row.onboard_rmse_m = 2;
  row.server_rmse_m = 0.5;
  row.corrected_rmse_m = corrected_m;
  return row;
}

std::vector<CurveRow> Rows() {
  return {Row("none", 0, 0, 2),           Row("uniform", 1, 1, 1.5), Row("random", 1, 1, 1.75),
          Row("knots", 1, 1, 1),          Row("uniform", 2, 2, 0.6), Row("knots", 2, 2, 0.4),
          Row("top_n_labels", 0, 40, 0.9)};
}

TEST(Merit, IsTheServersRmseAndNeverBelowOne) {
  EXPECT_DOUBLE_EQ(Merit(Row("knots", 1, 1, 1)), 2);
  EXPECT_DOUBLE_EQ(Merit(Row("knots", 1, 1, 0.4)), 1);
}

TEST(MeritOfBudgets, SetsKnotsBesideTheBestOfTheOthersThatKeepToTheBudget) {
  const std::vector<BudgetMerit> merits = MeritOfBudgets(Rows());
  ASSERT_EQ(merits.size(), 2);
  EXPECT_EQ(merits[0].budget, 1);
  EXPECT_EQ(merits[0].best_other, "uniform");
  EXPECT_DOUBLE_EQ(merits[0].best_other_merit, 3);
  EXPECT_DOUBLE_EQ(merits[0].knots_merit, 2);
  EXPECT_DOUBLE_EQ(merits[1].best_other_merit, 1.2);
  EXPECT_DOUBLE_EQ(merits[1].knots_merit, 1);
}

TEST(KnotsAsGoodAs, IsTheFewestEdgesWithTheSameRmse) {
  EXPECT_EQ(KnotsAsGoodAs(Row("top_n_labels", 0, 40, 0.9), Rows()), 2);
  EXPECT_EQ(KnotsAsGoodAs(Row("top_n_labels", 0, 40, 1.1), Rows()), 1);
  std::vector<CurveRow> without = Rows();
  without.erase(without.begin() + 5);
  EXPECT_EQ(KnotsAsGoodAs(Row("top_n_labels", 0, 40, 0.9), without), 0);
}

TEST(CurveCsv, LeavesAbsentFiguresEmpty) {
  const std::string csv = CurveCsv({Row("knots", 2, 2, 0.4), Row("none", 0, 0, 2)});
  EXPECT_THAT(csv, HasSubstr("\nrun,anna,knots,once,2,2,2.0000,0.5000,0.4000,,,0,,0.00\n"));
  EXPECT_THAT(csv, HasSubstr("\nrun,anna,none,once,,0,2.0000,0.5000,2.0000,,,0,,0.00\n"));
}

TEST(CurveMarkdown, NamesTheBestOtherAndTheEdgesInPlaceOfTopN) {
  const std::string page = CurveMarkdown("Title", "overtone evaluate", Rows());
  EXPECT_THAT(page, HasSubstr("| run anna | 2.000 | 0.500 | 2.00 (uniform 3.00) | 1.00 (uniform "
                              "1.20) |"));
  EXPECT_THAT(page, HasSubstr("| run anna | 2 | 2 | 2 | 40 -> 2 (0.900) |"));
}

TEST(CurveSvg, DrawsAPanelWithALineForEachStrategy) {
  const std::string svg = CurveSvg(Rows());
  EXPECT_THAT(svg, HasSubstr("run anna, onboard 4.0"));
  EXPECT_EQ(svg.substr(svg.size() - 7), "</svg>\n");
}

}  // namespace
}  // namespace overtone
