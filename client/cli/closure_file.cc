// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/closure_file.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <optional>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "overtone/core/common/format_number.h"
#include "overtone/core/common/line_reader.h"
#include "overtone/core/common/parse_number.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/geometry/parse_pose.h"

namespace overtone {
namespace {

constexpr char kHeader[] =
    "from_robot,from_stamp_s,to_robot,to_stamp_s,x,y,z,qx,qy,qz,qw,sigma_t,sigma_r";
constexpr size_t kColumns = 13;
constexpr double kStampTolerance_s = 0.5;

struct RowOfPlan {
  const RobotPlan* plan;
  int row;
};

absl::StatusOr<RowOfPlan> FindRow(const std::vector<RobotPlan>& plans, absl::string_view robot,
                                  absl::string_view stamp_text) {
  const auto plan = std::find_if(plans.begin(), plans.end(),
                                 [robot](const RobotPlan& p) { return p.name == robot; });
  if (plan == plans.end()) {
    return absl::InvalidArgumentError(absl::StrCat("no robot \"", robot, "\""));
  }
  ASSIGN_OR_RETURN(const Timestamp stamp, ParseSeconds(stamp_text));
  const std::vector<Timestamp>& stamps = plan->stamps;
  auto nearest = std::lower_bound(stamps.begin(), stamps.end(), stamp);
  if (nearest == stamps.end() ||
      (nearest != stamps.begin() &&
       SecondsBetween(*(nearest - 1), stamp) < SecondsBetween(stamp, *nearest))) {
    --nearest;
  }
  if (std::abs(SecondsBetween(stamp, *nearest)) > kStampTolerance_s) {
    return absl::InvalidArgumentError(
        absl::StrCat("robot ", robot, " has no odometry near ", stamp_text, " s"));
  }
  return RowOfPlan{&*plan, static_cast<int>(nearest - stamps.begin())};
}

absl::StatusOr<std::optional<LoopClosure>> ParseRow(absl::string_view line,
                                                    const std::vector<RobotPlan>& plans) {
  const std::vector<absl::string_view> fields = absl::StrSplit(line, ',');
  if (fields.size() < kColumns) {
    return absl::InvalidArgumentError(
        absl::StrCat(fields.size(), " columns where at least ", kColumns, " are expected"));
  }
  ASSIGN_OR_RETURN(const RowOfPlan from, FindRow(plans, fields[0], fields[1]));
  ASSIGN_OR_RETURN(const RowOfPlan to, FindRow(plans, fields[2], fields[3]));
  ASSIGN_OR_RETURN(const Rigid3d pose, ParsePose(absl::MakeConstSpan(fields).subspan(4, 7)));
  ASSIGN_OR_RETURN(const double sigma_t, ParseFiniteDouble(fields[11]));
  ASSIGN_OR_RETURN(const double sigma_r, ParseFiniteDouble(fields[12]));
  if (!(sigma_t > 0 && sigma_r > 0)) {
    return absl::InvalidArgumentError("sigma_t and sigma_r must be > 0");
  }
  Matrix6d covariance = Matrix6d::Zero();
  covariance.diagonal().head<3>().setConstant(sigma_t * sigma_t);
  covariance.diagonal().tail<3>().setConstant(sigma_r * sigma_r);
  return PlaceClosure(*from.plan, from.row, *to.plan, to.row, pose, covariance);
}

// Where the header has a column of this name.
std::optional<size_t> FindColumn(absl::string_view header, absl::string_view name) {
  const std::vector<absl::string_view> names = absl::StrSplit(header, ',');
  const auto column = std::find(names.begin(), names.end(), name);
  if (column == names.end()) return std::nullopt;
  return column - names.begin();
}

bool IsRobots(absl::string_view line, std::optional<size_t> proposer_column) {
  if (!proposer_column.has_value()) return true;
  const std::vector<absl::string_view> fields = absl::StrSplit(line, ',');
  return fields.size() <= *proposer_column || fields[*proposer_column] == "robot";
}

std::string Text(const std::optional<double>& value) {
  return value.has_value() ? absl::StrFormat("%.6g", *value) : "";
}

std::string TruthColumns(const std::optional<ClosureTruth>& truth) {
  if (!truth.has_value()) return ",,,,";
  return absl::StrCat(",", Text(truth->distance_m), ",", Text(truth->error_m), ",",
                      Text(truth->error_rad), ",", truth->right ? "yes" : "no");
}

std::string RegistrationColumns(const std::optional<ClosureRegistration>& registration) {
  if (!registration.has_value()) return ",,,";
  return absl::StrFormat(",%.4g,%.4g,%d", registration->overlap, registration->residual_m,
                         registration->open_directions);
}

// Of each axis, on average.
double SigmaOf(const Matrix6d& covariance, int first) {
  return std::sqrt(covariance.diagonal().segment<3>(first).mean());
}

}  // namespace

absl::StatusOr<std::vector<LoopClosure>> ReadClosures(const std::string& path,
                                                      const std::vector<RobotPlan>& plans) {
  std::ifstream file(path);
  if (!file) return absl::NotFoundError(absl::StrCat(path, ": cannot be opened"));
  LineReader reader(file, path);
  absl::string_view line;
  if (!reader.Next(&line) || !absl::StartsWith(line, kHeader)) {
    RETURN_IF_ERROR(reader.status());
    return absl::InvalidArgumentError(
        absl::StrCat(path, ": the first line must begin with \"", kHeader, "\""));
  }
  const std::optional<size_t> proposer_column = FindColumn(line, "proposer");
  std::vector<LoopClosure> closures;
  while (reader.Next(&line)) {
    if (!IsRobots(line, proposer_column)) continue;
    const absl::StatusOr<std::optional<LoopClosure>> closure = ParseRow(line, plans);
    if (!closure.ok()) return reader.Error(closure.status().message());
    if (closure->has_value()) closures.push_back(**closure);
  }
  RETURN_IF_ERROR(reader.status());
  return closures;
}

absl::Status WriteClosures(const std::string& path, const RunResult& result) {
  std::map<std::string, const RobotResult*> robots;
  for (const RobotResult& robot : result.robots) robots[robot.name] = &robot;
  std::ofstream file(path);
  file
      << kHeader
      << ",from_index,to_index,verdict,weight,chi_square,simulated,outlier,proposer,measured,score,"
         "true_distance_m,error_m,error_rad,right,overlap,residual_m,open_directions\n";
  for (const ClosureResult& row : result.closures) {
    const LoopClosure& closure = row.closure;
    const auto stamp = [&robots](const NodeId& node) {
      return FormatSeconds(robots.at(node.mission.robot)->stamps.at(node.index));
    };
    const Eigen::Vector3d& p = closure.from_tform_to.translation;
    const Eigen::Quaterniond& q = closure.from_tform_to.rotation;
    file << closure.from.mission.robot << ',' << stamp(closure.from) << ','
         << closure.to.mission.robot << ',' << stamp(closure.to)
         << absl::StrFormat(",%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g", p.x(), p.y(), p.z(), q.x(),
                            q.y(), q.z(), q.w())
         << absl::StrFormat(",%.6g,%.6g", SigmaOf(closure.covariance, 0),
                            SigmaOf(closure.covariance, 3))
         << absl::StrFormat(",%d,%d,%s,%.4g,%.6g,%s,%s", closure.from.index, closure.to.index,
                            row.verdict, row.weight, row.chi_square, row.simulated ? "yes" : "no",
                            row.outlier ? "yes" : "no")
         << absl::StrFormat(",%s,%s,%.4g", row.proposer, row.measured ? "yes" : "no", row.score)
         << TruthColumns(row.truth) << RegistrationColumns(row.registration) << "\n";
  }
  file.close();
  if (!file) return absl::UnavailableError(absl::StrCat("cannot write ", path));
  return absl::OkStatus();
}

}  // namespace overtone
