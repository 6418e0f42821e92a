// SPDX-License-Identifier: Apache-2.0
// `overtone robots`, `missions`, `export`, `report` and `watch`, as typed, against a server in this
// process.
#include <signal.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "nlohmann/json.hpp"
#include "overtone/client/cli/admin_commands.h"
#include "overtone/client/cli/export_command.h"
#include "overtone/client/cli/report_command.h"
#include "overtone/client/cli/watch.h"
#include "overtone/client/cli/watch_command.h"
#include "overtone/core/geometry/trajectory_io.h"
#include "overtone/core/graph/g2o_io.h"
#include "overtone/core/graph/point_cloud_io.h"
#include "overtone/tests/client/cli/command_outcome.h"
#include "overtone/tests/services/mapping_server/cloud_fixture.h"
#include "overtone/tests/services/mapping_server/server_fixture.h"
#include "overtone/tests/support/temporary_directory.h"

namespace overtone {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::Outcome;
using ::testing::StartsWith;
using testing::Uploader;

const MissionId kAnna = {"anna", "run1"};
const MissionId kBert = {"bert", "run1"};

class LiveMapCommandsTest : public testing::ServerTest {
 protected:
  void SetUp() override {
    StartServer();
    Submap submap = testing::MakeSubmapWithClouds(0, 0, 20, {testing::EncodedCloud(1)});
    LoopClosure closure = testing::MakeClosure({kAnna, 15}, {kAnna, 3});
    closure.from_tform_to =
        submap.keyframes[15].mission_from_body.Inverse() * submap.keyframes[3].mission_from_body;
    submap.loop_closures = {closure};
    Uploader uploader(*mapping_, "mine", kAnna);
    ASSERT_TRUE(uploader.Read().has_ready());
    ASSERT_TRUE(uploader.Send(submap).has_ack());
    ASSERT_TRUE(uploader.Read().has_want());
    v1::BlobChunk chunk;
    chunk.set_data(testing::EncodedCloud(1));
    chunk.set_sha256(Sha256(chunk.data()));
    uploader.Write(chunk);
    ASSERT_EQ(uploader.Read().blob_result().code(), 0);
    EXPECT_TRUE(uploader.Close().ok());
    Upload("mine", kBert, 1, 7);
    Settle("mine");
  }

  Outcome Run(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--server", server_->address()});
    return testing::RunCommand(
        {AddAdminCommands, AddExportCommand, AddReportCommand, AddWatchCommand},
        std::move(arguments));
  }
  std::string OutputOf(const std::vector<std::string>& arguments) {
    const Outcome outcome = Run(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, IsEmpty());
    return outcome.out;
  }
  static std::string Read(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  }

  TemporaryDirectory folder_;
};

TEST_F(LiveMapCommandsTest, RobotsAndMissionsAreTables) {
  const std::string robots = OutputOf({"robots", "--map", "mine"});
  EXPECT_THAT(robots, AllOf(ContainsRegex("^robot +link +missions"), ContainsRegex("\nanna .* 20 "),
                            ContainsRegex("\nbert .* 7 ")));
  const std::string json = OutputOf({"robots", "--map", "mine", "--json"});
  EXPECT_EQ(nlohmann::json::parse(json.substr(0, json.find('\n'))).at("keyframes"), "20");
  EXPECT_THAT(
      OutputOf({"missions", "--map", "mine"}),
      AllOf(ContainsRegex("anna/run1 +yes +0 +1 +20 "), ContainsRegex("bert/run1 +no +1 +1 +7 ")));
}

TEST_F(LiveMapCommandsTest, PosesAreExportedToStandardOutputAndToFiles) {
  const std::string all = OutputOf({"export", "--map", "mine"});
  EXPECT_THAT(all, AllOf(StartsWith("# anna/run1, component 0, anchored\n"),
                         HasSubstr("\n# bert/run1, component 1, unanchored\n")));
  const std::pair<const char*, TrajectoryFormat> formats[] = {{"tum", TrajectoryFormat::kTum},
                                                              {"kitti", TrajectoryFormat::kKitti},
                                                              {"euroc", TrajectoryFormat::kEuroc}};
  for (const auto& [name, format] : formats) {
    const std::string path = folder_.File(name);
    EXPECT_THAT(OutputOf({"export", "--map", "mine", "--format", name, "--mission", "bert/run1",
                          "--out", path}),
                IsEmpty());
    const auto trajectory = ReadTrajectory(path, format);
    ASSERT_TRUE(trajectory.ok()) << trajectory.status();
    EXPECT_EQ(trajectory->size(), 7u) << name;
  }
  std::istringstream g2o(OutputOf({"export", "--map", "mine", "--format", "g2o"}));
  const auto graph = ReadG2o(g2o, "export");
  ASSERT_TRUE(graph.ok()) << graph.status();
  EXPECT_EQ(graph->graph.edges.size(), 19u + 1u + 6u);
}

TEST_F(LiveMapCommandsTest, TheMergedCloudIsExportedAsPly) {
  const std::string path = folder_.File("town.ply");
  OutputOf({"export", "--map", "mine", "--format", "ply", "--voxel", "0.01", "--out", path});
  const auto cloud = ReadPointCloud(path);
  ASSERT_TRUE(cloud.ok()) << cloud.status();
  EXPECT_EQ(cloud->size(), 50u);
  OutputOf({"export", "--map", "mine", "--format", "ply", "--max-points", "10", "--out", path});
  EXPECT_LE(ReadPointCloud(path)->size(), 10u);
}

TEST_F(LiveMapCommandsTest, AnExportThatFailsLeavesWhatWasThere) {
  const std::string path = folder_.File("kept.tum");
  std::ofstream(path) << "kept";
  Outcome outcome = Run({"export", "--map", "mine", "--mission", "carl/run1", "--out", path});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("no carl/run1"));
  EXPECT_THAT(outcome.err, HasSubstr("`overtone missions --map mine` lists them"));
  EXPECT_EQ(Read(path), "kept");
  outcome = Run({"export", "--map", "mine", "--out", "/nowhere/at/all"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("cannot write /nowhere/at/all"));
  outcome = Run({"export", "--map", "theirs"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err,
              ContainsRegex("there is no 'theirs' \\(request [0-9a-f]+\\); there is mine\n"));
  EXPECT_THAT(outcome.out, IsEmpty());
}

// The data is what the page's script draws from.
TEST_F(LiveMapCommandsTest, TheReportShowsWhatTheServerHolds) {
  const std::string path = folder_.File("report.html");
  EXPECT_THAT(OutputOf({"report", "--map", "mine", "--out", path}),
              AllOf(HasSubstr("2 missions and 1 loop closures in "), HasSubstr(path)));
  const std::string page = Read(path);
  EXPECT_THAT(page,
              AllOf(HasSubstr("Overtone: map mine"), HasSubstr("Before: odometry as uploaded"),
                    HasSubstr("2 missions in 2 components"), HasSubstr("overtone report"),
                    Not(HasSubstr("{{")), Not(HasSubstr("replayed"))));
  const std::string begin = "id=\"data\">";
  const size_t at = page.find(begin) + begin.size();
  const auto data = nlohmann::json::parse(page.substr(at, page.find("</script>", at) - at));
  EXPECT_TRUE(data.at("live"));
  const auto& robots = data.at("robots");
  ASSERT_EQ(robots.size(), 2u);
  EXPECT_EQ(robots[0].at("name"), "anna/run1");
  EXPECT_TRUE(robots[0].at("drawnWithTeam"));
  EXPECT_FALSE(robots[1].at("drawnWithTeam"));  // unanchored: never drawn as if it were merged
  EXPECT_EQ(robots[0].at("paths").at("server").size(), 40u);
  EXPECT_EQ(robots[0].at("paths").at("onboard").size(), 40u);
  ASSERT_EQ(data.at("closures").size(), 1u);
  EXPECT_EQ(data.at("closures")[0][0], "accepted");
  EXPECT_TRUE(data.at("closures")[0][4].is_number());
  EXPECT_EQ(OutputOf({"report", "--map", "mine", "--out", "-"}), page);
}

TEST_F(LiveMapCommandsTest, WatchPrintsALineForEachMapAndRobot) {
  const std::string lines = OutputOf({"watch", "--looks", "3", "--interval", "0.1"});
  EXPECT_EQ(std::count(lines.begin(), lines.end(), '\n'), 3) << lines;
  EXPECT_THAT(lines, AllOf(HasSubstr(" mine: revision "), HasSubstr("closures: 1 accepted"),
                           HasSubstr(" mine/anna: "), HasSubstr(" mine/bert: ")));
  EXPECT_THAT(OutputOf({"watch", "--looks", "1", "--map", "another"}), IsEmpty());
  EXPECT_THAT(OutputOf({"watch", "--looks", "1", "--json"}),
              HasSubstr("\"robot\":{\"robot\":\"anna\""));
}

TEST_F(LiveMapCommandsTest, WatchEndsInGoodOrderWithAnInterrupt) {
  std::thread interrupt([] {
    // Once `watch` catches it: before, the signal would end the test.
    struct sigaction action = {};
    do {
      sigaction(SIGINT, nullptr, &action);
      std::this_thread::yield();
    } while (action.sa_handler == SIG_DFL);
    raise(SIGINT);
  });
  const Outcome outcome = Run({"watch", "--interval", "3600"});
  interrupt.join();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
}

// The client's channel finds a server that comes back.
TEST_F(LiveMapCommandsTest, AServerThatComesBackIsSeenAgain) {
  const std::string address = server_->address();
  AdminClient client(address, absl::Seconds(5));
  ASSERT_TRUE(LookAt(client, "").ok());
  server_.reset();
  const auto lost = LookAt(client, "");
  EXPECT_EQ(lost.status().code(), absl::StatusCode::kUnavailable);
  EXPECT_THAT(std::string(lost.status().message()), HasSubstr("nobody listens there"));
  ServerOptions options = testing::TestOptions();
  options.listen = address;
  StartServer(options);
  absl::Status status = absl::UnavailableError("");
  const absl::Time deadline = absl::Now() + absl::Seconds(20);
  while (!status.ok() && absl::Now() < deadline) status = LookAt(client, "").status();
  EXPECT_TRUE(status.ok()) << status;
}

}  // namespace
}  // namespace overtone
