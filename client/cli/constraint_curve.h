// SPDX-License-Identifier: Apache-2.0
// What each selection strategy makes of one case at each budget of constraint edges.
#ifndef OVERTONE_CLIENT_CLI_CONSTRAINT_CURVE_H_
#define OVERTONE_CLIENT_CLI_CONSTRAINT_CURVE_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "overtone/client/cli/correction_case.h"

namespace overtone {

struct CurveRow {
  std::string sequence, robot, strategy;
  std::string mode;  // "once": at the end of the run; "continuous": every 20 s of it
  int budget = 0;    // 0: the strategy knows none
  int64_t edges = 0;
  double onboard_rmse_m = 0, server_rmse_m = 0, corrected_rmse_m = 0;  // against the ground truth
  std::optional<double> to_server_m;       // corrected against the server's estimate
  std::optional<double> predicted_m;       // knots: what that was predicted to be
  int64_t bytes = 0;                       // of graphs, server to robot, in the whole run
  std::optional<int64_t> factor_nonzeros;  // in the host's factor
  double ms = 0;                           // selection alone (once), whole comparison (continuous)
};

// 1, 2, 3, 5, 8, 10, 15, 30, 50.
const std::vector<int>& CurveBudgets();

// Every strategy at every budget. Of the paper's top_n, whose labels become a few edges each, as
// many labels as fit; and besides ("top_n_labels") 15, 30, 50 and 100 labels whatever they cost.
// `threshold` and `all` have no budget. knots does not stop before the budget (tolerance 0).
absl::StatusOr<std::vector<CurveRow>> ConstraintCurve(const CorrectionCase& correction_case,
                                                      const SynchronizationOptions& options);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_CONSTRAINT_CURVE_H_
