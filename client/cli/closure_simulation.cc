// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/closure_simulation.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <tuple>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "overtone/client/cli/key_values.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

// Wrong poses: a translation up to this many radii (at least 5 m) per axis, any rotation.
constexpr double kOutlierRadii = 5;
constexpr double kOutlierMinimum_m = 5;

struct Partner {
  int robot;
  int keyframe;
  double distance_m;
  int rank;  // 0: the nearest one of its mission
};

bool Comparable(const RobotPlan& a, const RobotPlan& b) {
  return &a == &b || (a.common_from_world.has_value() && b.common_from_world.has_value());
}

Rigid3d TrueRelativePose(const RobotPlan& a, int i, const RobotPlan& b, int j) {
  if (&a == &b) return a.ground_truth[i]->Inverse() * *b.ground_truth[j];
  return (*a.common_from_world * *a.ground_truth[i]).Inverse() * *b.common_from_world *
         *b.ground_truth[j];
}

// Positions in the common frame, or in the robot's own when it has no common one.
std::vector<Eigen::Vector3d> Positions(const RobotPlan& plan) {
  const Rigid3d common_from_world = plan.common_from_world.value_or(Rigid3d::Identity());
  std::vector<Eigen::Vector3d> positions;
  for (const std::optional<Rigid3d>& pose : plan.ground_truth) {
    positions.push_back(pose.has_value() ? common_from_world * pose->translation
                                         : Eigen::Vector3d::Constant(NAN));
  }
  return positions;
}

// Keyframes of mission `other` within the radius that (robot, keyframe) may be closed with, nearest
// first.
std::vector<Partner> FindPartners(const std::vector<RobotPlan>& plans,
                                  const std::vector<std::vector<Eigen::Vector3d>>& positions,
                                  int robot, int keyframe, int other,
                                  const ClosureSimulationOptions& options) {
  std::vector<Partner> partners;
  for (int i = 0; i < static_cast<int>(positions[other].size()); ++i) {
    if (other == robot &&
        plans[robot].TimeOf(keyframe) - plans[robot].TimeOf(i) < options.min_gap_s) {
      break;
    }
    const double distance = (positions[other][i] - positions[robot][keyframe]).norm();
    if (distance <= options.radius_m) partners.push_back({other, i, distance, 0});  // not for NaN
  }
  std::sort(partners.begin(), partners.end(),
            [](const Partner& a, const Partner& b) { return a.distance_m < b.distance_m; });
  for (size_t i = 0; i < partners.size(); ++i) partners[i].rank = static_cast<int>(i);
  return partners;
}

// Those that (robot, keyframe) keeps: the nearest of every mission, then the second nearest, ...
std::vector<Partner> ChoosePartners(const std::vector<RobotPlan>& plans,
                                    const std::vector<std::vector<Eigen::Vector3d>>& positions,
                                    int robot, int keyframe,
                                    const ClosureSimulationOptions& options) {
  std::vector<Partner> chosen;
  for (int other = 0; other <= robot; ++other) {
    if (!Comparable(plans[other], plans[robot])) continue;
    const std::vector<Partner> partners =
        FindPartners(plans, positions, robot, keyframe, other, options);
    chosen.insert(chosen.end(), partners.begin(), partners.end());
  }
  std::sort(chosen.begin(), chosen.end(), [](const Partner& a, const Partner& b) {
    return std::tie(a.rank, a.distance_m) < std::tie(b.rank, b.distance_m);
  });
  if (chosen.size() > options.max_per_keyframe) {
    chosen.resize(static_cast<size_t>(options.max_per_keyframe));
  }
  return chosen;
}

Rigid3d RandomPose(double radius_m, std::mt19937_64& random) {
  const double reach_m = std::max(kOutlierRadii * radius_m, kOutlierMinimum_m);
  std::uniform_real_distribution<double> uniform(-reach_m, reach_m);
  std::normal_distribution<double> normal;
  const Eigen::Vector3d translation(uniform(random), uniform(random), uniform(random));
  Eigen::Vector4d q(normal(random), normal(random), normal(random), normal(random));
  return Rigid3d(Eigen::Quaterniond(q.normalized()), translation);
}

void ReplaceByOutliers(const ClosureSimulationOptions& options, std::mt19937_64& random,
                       std::vector<SimulatedClosure>* closures) {
  std::vector<int> order(closures->size());
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), random);
  order.resize(std::lround(options.outliers * static_cast<double>(order.size())));
  for (const int i : order) {
    (*closures)[i].closure.from_tform_to = RandomPose(options.radius_m, random);
    (*closures)[i].outlier = true;
  }
}

}  // namespace

absl::Status ClosureSimulationOptions::Validate() const {
  if (!(radius_m > 0)) return absl::InvalidArgumentError("radius: must be > 0");
  if (!(sigma_t_m > 0)) return absl::InvalidArgumentError("sigma_t: must be > 0");
  if (!(sigma_r_rad > 0)) return absl::InvalidArgumentError("sigma_r: must be > 0");
  if (!(outliers >= 0 && outliers < 1)) {
    return absl::InvalidArgumentError("outliers: must be in [0, 1)");
  }
  if (!(density > 0 && density <= 1)) {
    return absl::InvalidArgumentError("density: must be in (0, 1]");
  }
  if (!(max_per_keyframe >= 1 && max_per_keyframe <= 1000)) {
    return absl::InvalidArgumentError("max_per_keyframe: must be in [1, 1000]");
  }
  if (!(min_gap_s > 0)) return absl::InvalidArgumentError("min_gap_s: must be > 0");
  if (!(seed >= 0 && seed < 9e15)) return absl::InvalidArgumentError("seed: must be in [0, 9e15)");
  return absl::OkStatus();
}

absl::StatusOr<ClosureSimulationOptions> ParseClosureSimulation(absl::string_view text) {
  ClosureSimulationOptions options;
  RETURN_IF_ERROR(ParseKeyValues(text, {{"radius", &options.radius_m},
                                        {"sigma_t", &options.sigma_t_m},
                                        {"sigma_r", &options.sigma_r_rad},
                                        {"outliers", &options.outliers},
                                        {"density", &options.density},
                                        {"max_per_keyframe", &options.max_per_keyframe},
                                        {"min_gap_s", &options.min_gap_s},
                                        {"seed", &options.seed}}));
  RETURN_IF_ERROR(options.Validate());
  return options;
}

std::string Describe(const ClosureSimulationOptions& options) {
  std::string text = absl::StrFormat(
      "Loop closures were SIMULATED from ground truth: keyframes within %g m of each other (%g s "
      "apart in the same "
      "mission), at most %g per keyframe, the nearest of each mission first",
      options.radius_m, options.min_gap_s, std::floor(options.max_per_keyframe));
  if (options.density < 1) {
    absl::StrAppendFormat(&text, ", for %g %% of the keyframes", 100 * options.density);
  }
  absl::StrAppendFormat(
      &text, "; noise %g m and %g rad per axis; %g %% replaced by random wrong poses; seed %.0f.",
      options.sigma_t_m, options.sigma_r_rad, 100 * options.outliers, options.seed);
  return text;
}

std::vector<SimulatedClosure> SimulateClosures(const std::vector<RobotPlan>& plans,
                                               const ClosureSimulationOptions& options) {
  std::mt19937_64 random(static_cast<uint64_t>(options.seed));
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal;
  Matrix6d covariance = Matrix6d::Zero();
  covariance.diagonal().head<3>().setConstant(options.sigma_t_m * options.sigma_t_m);
  covariance.diagonal().tail<3>().setConstant(options.sigma_r_rad * options.sigma_r_rad);

  std::vector<std::vector<Eigen::Vector3d>> positions;
  for (const RobotPlan& plan : plans) positions.push_back(Positions(plan));
  std::vector<SimulatedClosure> closures;
  for (int robot = 0; robot < static_cast<int>(plans.size()); ++robot) {
    for (int keyframe = 0; keyframe < static_cast<int>(positions[robot].size()); ++keyframe) {
      if (uniform(random) >= options.density) continue;
      for (const Partner& partner : ChoosePartners(plans, positions, robot, keyframe, options)) {
        Vector6d noise;
        for (int i = 0; i < 6; ++i) {
          noise[i] = (i < 3 ? options.sigma_t_m : options.sigma_r_rad) * normal(random);
        }
        const Rigid3d measured =
            TrueRelativePose(plans[partner.robot], partner.keyframe, plans[robot], keyframe) *
            Exp(noise);
        closures.push_back({{{plans[partner.robot].id, partner.keyframe},
                             {plans[robot].id, keyframe},
                             measured,
                             covariance},
                            false});
      }
    }
  }
  ReplaceByOutliers(options, random, &closures);
  return closures;
}

}  // namespace overtone
