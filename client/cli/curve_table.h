// SPDX-License-Identifier: Apache-2.0
// Curves of strategies as csv, as a page, and as a plot.
#ifndef OVERTONE_CLIENT_CLI_CURVE_TABLE_H_
#define OVERTONE_CLIENT_CLI_CURVE_TABLE_H_

#include <string>
#include <vector>

#include "overtone/client/cli/constraint_curve.h"

namespace overtone {

// sequence,robot,strategy,mode,budget,edges,onboard_rmse,server_rmse,corrected_rmse,to_server_rmse,
// predicted_rmse,bytes,factor_nonzeros,ms; absent figures are empty.
std::string CurveCsv(const std::vector<CurveRow>& rows);

// The figure of merit: RMSE against the ground truth over the server's, and 1 where it is below by
// chance: no strategy knows more than the server.
double Merit(const CurveRow& row);

// At one budget of one robot: the best other strategy that keeps to it, and knots.
struct BudgetMerit {
  std::string sequence, robot;
  int budget = 0;
  std::string best_other;
  double best_other_merit = 0;
  double knots_merit = 0;
};
std::vector<BudgetMerit> MeritOfBudgets(const std::vector<CurveRow>& rows);

// The fewest edges of knots at which it is as good as another row of the same robot, of those
// tried; 0: at none.
int64_t KnotsAsGoodAs(const CurveRow& row, const std::vector<CurveRow>& rows);

// A page: what was run, the merit at each budget, edges for 1.5, 1.25 and 1.1 of the server's RMSE,
// edges in place of top_n's, prediction against what came of it, continuous runs.
std::string CurveMarkdown(const std::string& title, const std::string& command,
                          const std::vector<CurveRow>& rows);

// Merit against edges, each robot in a panel of its own, both axes logarithmic.
std::string CurveSvg(const std::vector<CurveRow>& rows);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_CURVE_TABLE_H_
