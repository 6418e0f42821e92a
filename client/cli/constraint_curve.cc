// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/constraint_curve.h"

#include <chrono>
#include <utility>

#include "overtone/core/common/status_macros.h"
#include "overtone/core/synchronization/constraint_selection.h"
#include "overtone/core/synchronization/knot_selection.h"

namespace overtone {
namespace {

class Curve {
 public:
  Curve(const CorrectionCase& correction_case, const SynchronizationOptions& options)
      : case_(correction_case), options_(options) {
    options_.selection.tolerance_m = 0;
  }

  std::vector<CurveRow> TakeRows() { return std::move(rows_); }

  absl::Status Add(const std::string& name, SelectionStrategy strategy, int n, int budget) {
    options_.selection.strategy = strategy;
    options_.selection.n = n;
    const auto start = std::chrono::steady_clock::now();
    const std::vector<Constraint> constraints = Select(budget);
    CurveRow row;
    row.ms =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    if (strategy == SelectionStrategy::kKnots) {
      row.predicted_m = PredictionFor(case_.comparison, options_, case_.context)
                            .ExactRmse(KnotRows(case_.comparison, constraints));
    }
    ASSIGN_OR_RETURN(const CorrectionOutcome outcome, Correct(case_, constraints));
    row.sequence = case_.sequence;
    row.robot = case_.robot;
    row.strategy = name;
    row.mode = "once";
    row.budget = budget;
    row.edges = static_cast<int64_t>(constraints.size());
    row.onboard_rmse_m = case_.onboard_rmse_m;
    row.server_rmse_m = case_.server_rmse_m;
    row.corrected_rmse_m = outcome.rmse_m;
    row.to_server_m = outcome.to_server_m;
    row.bytes = case_.bytes_down;
    row.factor_nonzeros = outcome.factor_nonzeros;
    rows_.push_back(std::move(row));
    return absl::OkStatus();
  }

 private:
  // As many labels as fit into the budget; where not even one does, its first edges.
  std::vector<Constraint> Select(int budget) {
    std::vector<Constraint> constraints =
        SelectConstraints(case_.comparison, options_, case_.context);
    while (budget > 0 && constraints.size() > budget && options_.selection.n > 1) {
      --options_.selection.n;
      constraints = SelectConstraints(case_.comparison, options_, case_.context);
    }
    if (budget > 0 && constraints.size() > budget) constraints.resize(budget);
    return constraints;
  }

  const CorrectionCase& case_;
  SynchronizationOptions options_;
  std::vector<CurveRow> rows_;
};

}  // namespace

const std::vector<int>& CurveBudgets() {
  static const auto* const budgets = new std::vector<int>{1, 2, 3, 5, 8, 10, 15, 30, 50};
  return *budgets;
}

absl::StatusOr<std::vector<CurveRow>> ConstraintCurve(const CorrectionCase& correction_case,
                                                      const SynchronizationOptions& options) {
  Curve curve(correction_case, options);
  RETURN_IF_ERROR(curve.Add("none", SelectionStrategy::kNone, 1, 0));
  RETURN_IF_ERROR(curve.Add("all", SelectionStrategy::kAll, 1, 0));
  RETURN_IF_ERROR(curve.Add("threshold", SelectionStrategy::kThreshold, 1, 0));
  for (const int labels : {15, 30, 50, 100}) {
    RETURN_IF_ERROR(curve.Add("top_n_labels", SelectionStrategy::kTopN, labels, 0));
  }
  for (const auto& [name, strategy] :
       {std::pair("random", SelectionStrategy::kRandom),
        std::pair("uniform", SelectionStrategy::kUniform),
        std::pair("largest_edge_error", SelectionStrategy::kLargestEdgeError),
        std::pair("top_n", SelectionStrategy::kTopN),
        std::pair("knots", SelectionStrategy::kKnots)}) {
    for (const int budget : CurveBudgets()) {
      RETURN_IF_ERROR(curve.Add(name, strategy, budget, budget));
    }
  }
  return curve.TakeRows();
}

}  // namespace overtone
