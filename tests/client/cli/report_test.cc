// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/report.h"

#include <fstream>
#include <limits>
#include <sstream>
#include <string>

#include "absl/strings/match.h"
#include "absl/strings/str_replace.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/core/simulation/example_team.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

int Count(const std::string& text, const std::string& part) {
  int count = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

// The drift of the odometry fades at half the run's constraints: enough like a replay to look at.
std::vector<Rigid3d> Blend(const RobotResult& robot, double share_of_drift) {
  std::vector<Rigid3d> poses;
  const Rigid3d map_from_odometry = robot.ground_truth[0].value();
  for (size_t i = 0; i < robot.onboard.size(); ++i) {
    const Rigid3d onboard = map_from_odometry * robot.onboard[i];
    const Vector6d drift = Log(robot.ground_truth[i]->Inverse() * onboard);
    poses.push_back(*robot.ground_truth[i] * Exp(share_of_drift * drift));
  }
  return poses;
}

TrajectoryError ErrorOf(const std::vector<Rigid3d>& estimate, const RobotResult& robot) {
  std::vector<Rigid3d> truth;
  for (const auto& pose : robot.ground_truth) truth.push_back(*pose);
  return AbsoluteTrajectoryError(estimate, truth).value();
}

void AddComparisons(RobotResult& robot, int num_comparisons) {
  const int count = static_cast<int>(robot.stamps.size());
  for (int k = 1; k <= num_comparisons; ++k) {
    ComparisonRecord record;
    record.time_s = robot.duration_s * k / num_comparisons;
    record.revision = k;
    record.compare_ms = 5 + k % 7;
    record.onboard_rmse_m = 0.1 * k;
    record.corrected_rmse_m = 0.02 * k;
    for (int i = 0; i < count * k / num_comparisons; i += 2) record.keyframe_index.push_back(i);
    record.discrepancy.resize(record.keyframe_index.size(), 3);
    for (int i = 0; i < record.discrepancy.rows(); ++i) {
      const double age = record.discrepancy.rows() - i;
      for (int band = 0; band < 3; ++band) {
        record.discrepancy(i, band) = 2 / (1 + 0.1 * age) / (1 + 2 * band);
      }
    }
    robot.comparisons.push_back(std::move(record));
  }
}

void AddConstraints(RobotResult& robot) {
  const int64_t count = static_cast<int64_t>(robot.stamps.size());
  const ConstraintKind kinds[] = {ConstraintKind::kSmall, ConstraintKind::kMid,
                                  ConstraintKind::kLarge};
  const int64_t reach[] = {2, 10, 60};
  for (int64_t i = 0; i + 61 < count; i += 7) {
    Constraint constraint;
    constraint.kind = kinds[i % 3];
    constraint.from = i;
    constraint.to = i + reach[i % 3];
    constraint.score = 0.01 * static_cast<double>(i);
    robot.active_constraints.push_back(constraint);
  }
}

RobotResult MakeRobot(const SimulatedRobot& simulated, int stride) {
  RobotResult robot;
  robot.name = simulated.name;
  for (size_t i = 0; i < simulated.odometry.size(); i += stride) {
    robot.stamps.push_back(simulated.odometry[i].stamp);
    robot.onboard.push_back(simulated.odometry[i].pose);
    robot.ground_truth.push_back(simulated.ground_truth[i].pose);
  }
  robot.server = Blend(robot, 0.05);
  robot.corrected = Blend(robot, 0.12);
  robot.path_m = PathLength(robot.onboard);
  robot.duration_s = SecondsBetween(robot.stamps.front(), robot.stamps.back());
  robot.graph_nodes = static_cast<int>(robot.stamps.size()) / 2;
  robot.onboard_error = ErrorOf(robot.onboard, robot);
  robot.server_error = ErrorOf(robot.server, robot);
  robot.corrected_error = ErrorOf(robot.corrected, robot);
  robot.bytes_up = 123'456;
  robot.bytes_down = 654'321;
  AddComparisons(robot, /*num_comparisons=*/30);
  AddConstraints(robot);
  return robot;
}

void AddClosures(RunResult& result) {
  for (int i = 0; i < 60; ++i) {
    ClosureResult closure;
    closure.closure.from = {{result.robots[i % 3].name, "m"}, 5 * i};
    closure.closure.to = {{result.robots[(i + i / 10) % 3].name, "m"}, 3 * i};
    closure.outlier = i % 6 == 0;
    closure.verdict = closure.outlier ? "demoted_by_optimiser" : "accepted";
    closure.simulated = true;
    result.closures.push_back(closure);
  }
}

// Every stride-th pose of the example team is a keyframe.
RunResult MakeResult(int stride, ExampleTeamOptions options = {}) {
  RunResult result;
  result.dataset = "example";
  result.command = "overtone replay --dataset example --out run/";
  result.closures_note =
      "They were simulated from ground truth: radius 1 m, sigma 0.03 m and 0.5 deg, no outliers.";
  result.closures_simulated = true;
  result.settings = {{"strategy", "top_n"}, {"n", "15"}, {"edge metric", "se3"}};
  result.revision = 31;
  result.wall_time_s = 42.5;
  const auto team = SimulateExampleTeam(options);
  for (const SimulatedRobot& robot : team.value()) {
    result.robots.push_back(MakeRobot(robot, stride));
  }
  AddClosures(result);
  return result;
}

// The JSON between its script element's tags.
std::string DataOf(const std::string& page) {
  const std::string open = "id=\"data\">";
  const size_t begin = page.find(open) + open.size();
  return page.substr(begin, page.find("</script>", begin) - begin);
}

TEST(Report, NamesEveryRobotItsErrorsAndWhereTheClosuresComeFrom) {
  const RunResult result = MakeResult(/*stride=*/20);
  const std::string page = RenderReport(result);
  for (const RobotResult& robot : result.robots) {
    EXPECT_THAT(page, HasSubstr("<td>" + robot.name + "</td>"));
    EXPECT_THAT(DataOf(page), HasSubstr("\"name\":\"" + robot.name + "\""));
  }
  EXPECT_THAT(page, HasSubstr("Simulated loop closures."));
  EXPECT_THAT(page, HasSubstr("radius 1 m, sigma 0.03 m and 0.5 deg, no outliers"));
  EXPECT_THAT(page, HasSubstr("<dt>strategy</dt><dd>top_n</dd>"));
  EXPECT_THAT(page, HasSubstr("<td>demoted by optimiser</td><td>10</td>"));
  EXPECT_THAT(page, Not(HasSubstr("{{")));  // every part was filled in
}

TEST(Report, RealClosuresAreNotCalledSimulated) {
  RunResult result;
  result.closures_note = "They are the loop edges of the g2o file.";
  EXPECT_THAT(RenderReport(result), Not(HasSubstr("imulated")));
}

TEST(Report, OpensElementsAndClosesThem) {
  const std::string page = RenderReport(MakeResult(/*stride=*/20));
  for (const std::string tag :
       {"html", "head", "body", "main", "section", "table", "thead", "tbody", "tr", "td", "div",
        "figure", "script", "style", "dl", "template", "p", "pre"}) {
    // The script makes elements by name only, so each tag in the text is markup.
    EXPECT_EQ(Count(page, "<" + tag + ">") + Count(page, "<" + tag + " "),
              Count(page, "</" + tag + ">"))
        << tag;
  }
}

TEST(Report, LoadsNothingFromAnywhere) {
  const std::string page = absl::StrReplaceAll(RenderReport(MakeResult(/*stride=*/20)),
                                               {{"http://www.w3.org/2000/svg", ""}});
  EXPECT_THAT(page, Not(HasSubstr("http://")));
  EXPECT_THAT(page, Not(HasSubstr("https://")));
  EXPECT_THAT(page, Not(HasSubstr("src=")));
  EXPECT_THAT(page, Not(HasSubstr("@import")));
  EXPECT_THAT(page, HasSubstr("default-src 'none'"));
}

TEST(Report, TextFromOutsideStaysText) {
  const std::string hostile = "</script><script>alert('x')</script>\"&\xff{{script}}";
  RunResult result = MakeResult(/*stride=*/200);
  result.dataset = result.command = result.closures_note = hostile;
  result.settings = {{hostile, hostile}};
  result.robots[0].name = hostile;
  result.closures[0].verdict = hostile;
  result.closures[0].closure.from.mission.robot = hostile;
  const std::string page = RenderReport(result);
  EXPECT_THAT(page, Not(HasSubstr("<script>alert")));
  EXPECT_THAT(page, HasSubstr("&lt;/script&gt;&lt;script&gt;alert(&#39;x&#39;)"));
  EXPECT_EQ(Count(page, "</script>"), 2);  // the data's and the program's own
  EXPECT_EQ(Count(page, "'use strict'"), 1);
}

TEST(Report, ARunWithoutRobotsIsAPage) {
  EXPECT_THAT(RenderReport(RunResult()), HasSubstr("This run had no loop closures."));
}

TEST(Report, ARobotWithoutAnythingIsAPage) {
  RunResult result;
  result.robots.resize(2);
  result.robots[0].name = "idle";
  result.robots[1].name = "one";
  result.robots[1].stamps.resize(1);
  result.robots[1].onboard.resize(1);
  const std::string page = RenderReport(result);
  EXPECT_THAT(page, HasSubstr("<td>idle</td>"));
  EXPECT_THAT(page, HasSubstr("No ground truth to measure against."));
}

// What can go wrong in a run must not go wrong in its report: positions that are not finite, node
// indices out of range, discrepancies of another shape.
TEST(Report, BrokenValuesAreLeftOut) {
  RunResult result = MakeResult(/*stride=*/20);
  RobotResult& robot = result.robots[0];
  robot.onboard[3].translation.x() = std::numeric_limits<double>::quiet_NaN();
  robot.server[4].translation.y() = std::numeric_limits<double>::infinity();
  robot.corrected.resize(robot.corrected.size() / 2);
  robot.ground_truth[5].reset();
  robot.active_constraints[0].from = -1;
  robot.active_constraints[1].to = 1'000'000;
  robot.comparisons[0].keyframe_index.push_back(1'000'000);
  robot.comparisons[1].discrepancy.resize(2, 2);
  result.closures[0].closure.from.index = -7;
  result.closures[1].closure.to.mission.robot = "nobody";
  const std::string data = DataOf(RenderReport(result));
  EXPECT_FALSE(absl::StrContains(data, "nan"));
  EXPECT_FALSE(absl::StrContains(data, "inf"));
  EXPECT_FALSE(absl::StrContains(data, "1000000"));
  EXPECT_FALSE(absl::StrContains(data, "nobody"));
}

TEST(Report, WithoutGroundTruthEstimatesAreLaidOnTheServers) {
  RunResult result = MakeResult(/*stride=*/20);
  for (RobotResult& robot : result.robots) {
    robot.onboard_error = robot.server_error = robot.corrected_error = std::nullopt;
    for (auto& pose : robot.ground_truth) pose.reset();
    robot.onboard = robot.server;
    const Rigid3d shift(ExpSO3({0, 0, 1}), {100, 200, 300});
    for (Rigid3d& pose : robot.onboard) pose = shift * pose;
  }
  const std::string data = DataOf(RenderReport(result));
  const auto path = [&](const std::string& name) {
    const size_t begin = data.find("\"" + name + "\":[", data.find("\"paths\""));
    return data.substr(data.find('[', begin), 200);
  };
  EXPECT_EQ(path("onboard"), path("server"));
}

// Ten thousand keyframes for each of three robots.
TEST(Report, StaysSmallHoweverLongTheRunWas) {
  ExampleTeamOptions options;
  options.duration_s = 1000;
  const RunResult result = MakeResult(/*stride=*/1, options);
  ASSERT_GT(result.robots[0].stamps.size(), 10'000u);
  EXPECT_LT(RenderReport(result).size(), 600'000u);
}

TEST(Report, IsWrittenToAFile) {
  const std::string path = std::string(OVERTONE_BINARY_DIR) + "/report_test.html";
  const RunResult result = MakeResult(/*stride=*/20);
  ASSERT_TRUE(WriteReport(result, path).ok());
  std::stringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  EXPECT_EQ(text.str(), RenderReport(result));
}

TEST(Report, AnUnwritablePathIsNamed) {
  const absl::Status status = WriteReport(RunResult(), "/no/such/folder/report.html");
  EXPECT_EQ(status.code(), absl::StatusCode::kUnavailable);
  EXPECT_THAT(std::string(status.message()), HasSubstr("/no/such/folder/report.html"));
}

}  // namespace
}  // namespace overtone
