// SPDX-License-Identifier: Apache-2.0
// `overtone import`, as typed, against a server in this process.
#include "overtone/client/cli/import_command.h"

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "nlohmann/json.hpp"
#include "overtone/client/cli/admin_commands.h"
#include "overtone/client/cli/export_command.h"
#include "overtone/client/cli/import.h"
#include "overtone/core/geometry/trajectory_io.h"
#include "overtone/core/graph/g2o_io.h"
#include "overtone/tests/client/cli/command_outcome.h"
#include "overtone/tests/services/mapping_server/server_fixture.h"
#include "overtone/tests/support/temporary_directory.h"

namespace overtone {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::Outcome;

TEST(ParseImportSource, TheFileNamesTheRobotUnlessOneIsGiven) {
  const auto parse = [](const char* text) { return ParseImportSource(text).value(); };
  EXPECT_EQ(parse("run/MH_01 (easy).txt").robot, "mh_01__easy_");
  EXPECT_EQ(parse("run/MH_01 (easy).txt").path, "run/MH_01 (easy).txt");
  EXPECT_EQ(parse("anna:run/1.txt").robot, "anna");
  EXPECT_EQ(parse("anna:run/1.txt").path, "run/1.txt");
  EXPECT_FALSE(parse("anna:run/1.txt").g2o);
  EXPECT_TRUE(parse("sphere2500.G2O").g2o);
  for (const char* text : {"", "Anna:x.txt", "(1).txt", ":x.txt"}) {
    EXPECT_EQ(ParseImportSource(text).status().code(), absl::StatusCode::kInvalidArgument) << text;
  }
}

class ImportCommandTest : public testing::ServerTest {
 protected:
  void SetUp() override {
    ServerOptions options = testing::TestOptions();
    options.quotas.max_calls_per_s = 0;  // import polls
    StartServer(options);
  }

  Outcome Run(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--server", server_->address(), "--map", "town"});
    return testing::RunCommand({AddImportCommand, AddExportCommand, AddAdminCommands},
                               std::move(arguments));
  }
  std::string OutputOf(const std::vector<std::string>& arguments) {
    const Outcome outcome = Run(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.out;
  }

  // `count` poses on a circle of radius `radius_m`, half a metre apart.
  std::string WriteTum(const std::string& name, int count, double radius_m = 10) {
    Trajectory trajectory;
    for (int i = 0; i < count; ++i) {
      const double angle = 0.5 * i / radius_m;
      trajectory.push_back(
          {Timestamp{1'000'000'000 + 100'000'000ll * i},
           Rigid3d(ExpSO3(Eigen::Vector3d(0, 0, angle)),
                   radius_m * Eigen::Vector3d(std::sin(angle), 1 - std::cos(angle), 0))});
    }
    const std::string path = folder_.File(name);
    EXPECT_TRUE(WriteTrajectory(path, TrajectoryFormat::kTum, trajectory).ok());
    return path;
  }

  TemporaryDirectory folder_;
};

TEST_F(ImportCommandTest, TumTrajectoriesBecomeMissionsAndComeOutAgain) {
  const std::string anna = WriteTum("Anna.tum", 30), other = WriteTum("other.txt", 20, 5);
  EXPECT_EQ(OutputOf({"import", anna, "bert:" + other}),
            "anna/import: 30 keyframes and 0 loop closures into map town\n"
            "bert/import: 20 keyframes and 0 loop closures into map town\n");
  std::istringstream text(OutputOf({"export", "--mission", "anna/import"}));
  const auto exported = ReadTrajectory(text, "export", TrajectoryFormat::kTum);
  const auto original = ReadTrajectory(anna, TrajectoryFormat::kTum);
  ASSERT_TRUE(exported.ok()) << exported.status();
  ASSERT_EQ(exported->size(), original->size());
  for (size_t i = 0; i < exported->size(); ++i) {
    EXPECT_EQ((*exported)[i].stamp, (*original)[i].stamp);
    EXPECT_LT(((*exported)[i].pose.translation - (*original)[i].pose.translation).norm(), 1e-6);
  }
}

TEST_F(ImportCommandTest, ImportingAgainChangesNothing) {
  const std::string anna = WriteTum("anna.tum", 30);
  OutputOf({"import", anna});
  const uint64_t revision = Settle("town").revision();
  EXPECT_EQ(OutputOf({"import", anna}),
            "anna/import: 30 keyframes and 0 loop closures are in map town already\n");
  EXPECT_EQ(nlohmann::json::parse(OutputOf({"import", anna, "--json"})),
            nlohmann::json({{"map", "town"},
                            {"mission", "anna/import"},
                            {"keyframes", 30},
                            {"loop_closures", 0},
                            {"already_there", 30}}));
  const v1::MapSummary map = Settle("town");
  EXPECT_EQ(map.keyframes(), 30);
  EXPECT_EQ(map.revision(), revision);
}

TEST_F(ImportCommandTest, AnotherMissionOfThatNameIsNotTouched) {
  OutputOf({"import", WriteTum("anna.tum", 30)});
  const std::pair<std::string, const char*> others[] = {
      {"anna:" + WriteTum("shorter.tum", 20), "of 30 keyframes"},
      {"anna:" + WriteTum("elsewhere.tum", 30, 12), "whose keyframe 1 is another"}};
  for (const auto& [other, how] : others) {
    const Outcome outcome = Run({"import", other});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("map town has a mission anna/import already"),
                                   HasSubstr(how), HasSubstr("--mission NAME"),
                                   HasSubstr("overtone delete --map town --mission anna/import")));
    EXPECT_THAT(outcome.out, IsEmpty());
  }
  EXPECT_EQ(Settle("town").keyframes(), 30);
  OutputOf({"import", others[1].first, "--mission", "second"});
  EXPECT_EQ(Settle("town").keyframes(), 60);
}

TEST_F(ImportCommandTest, AG2oFileBringsItsLoopClosures) {
  PoseGraph graph;
  for (int i = 0; i < 40; ++i) {
    const double angle = 2 * M_PI * i / 20;  // twice around
    graph.poses.emplace_back(ExpSO3(Eigen::Vector3d(0, 0, angle)),
                             3 * Eigen::Vector3d(std::sin(angle), 1 - std::cos(angle), 0));
  }
  const auto tie = [&graph](int from, int to, EdgeKind kind) {
    PoseGraphEdge edge;
    edge.from = from;
    edge.to = to;
    edge.from_tform_to = graph.poses[from].Inverse() * graph.poses[to];
    edge.information = 1e4 * Matrix6d::Identity();
    edge.kind = kind;
    graph.edges.push_back(edge);
  };
  for (int i = 1; i < 40; ++i) tie(i - 1, i, EdgeKind::kOdometry);
  for (int i = 20; i < 40; i += 5) tie(i, i - 20, EdgeKind::kLoopClosure);
  std::ofstream file(folder_.File("loop.g2o"));
  WriteG2o(file, graph);
  file.close();
  for (int time = 0; time < 2; ++time) OutputOf({"import", folder_.File("loop.g2o")});
  const v1::MapSummary map = Settle("town");
  EXPECT_EQ(map.keyframes(), 40);
  EXPECT_EQ(map.loop_closures(), 4);
  ASSERT_EQ(map.verdicts_size(), 1);
  EXPECT_EQ(map.verdicts(0).verdict(), v1::LOOP_CLOSURE_VERDICT_ACCEPTED);
}

TEST_F(ImportCommandTest, NothingIsSentWhenAFileIsBad) {
  const std::string good = WriteTum("anna.tum", 10);
  std::ofstream(folder_.File("bad.tum")) << "1 2 3\n";
  Outcome outcome = Run({"import", good, folder_.File("bad.tum")});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("bad.tum:1: 3 fields where 8 are expected"));
  outcome = Run({"import", good, "anna:" + good});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("robot anna is given twice"));
  EXPECT_EQ(Run({"import", folder_.File("nowhere.tum")}).exit_code, 2);
  EXPECT_THAT(Run({"missions"}).err, HasSubstr("it has no map yet"));
}

}  // namespace
}  // namespace overtone
