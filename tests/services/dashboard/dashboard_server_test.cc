// SPDX-License-Identifier: Apache-2.0
// The service over HTTP, before a server that can say everything.
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/tests/services/dashboard/dashboard_fixture.h"
#include "overtone/tests/services/dashboard/synthetic_server.h"
#include "overtone/tests/support/temporary_directory.h"

namespace overtone {
namespace {

using nlohmann::json;
using testing::Dashboard;
using testing::DecodedFrame;
using ::testing::HasSubstr;
using testing::SyntheticMapOptions;
using testing::SyntheticServer;

class DashboardTest : public ::testing::Test {
 protected:
  DashboardTest() : server_(Small()), dashboard_(Dashboard::Options(server_.address())) {}
  static SyntheticMapOptions Small() {
    SyntheticMapOptions options;
    options.robots = 5;
    options.nodes = 60;
    options.cloud_points = 500;
    return options;
  }
  std::string FirstClosure() { return dashboard_.Json("/api/closures")["closures"][0]["id"]; }

  SyntheticServer server_;
  Dashboard dashboard_;
};

TEST_F(DashboardTest, TheStateHoldsMissionsAndRobotsWithWhatTheyReported) {
  const json state = dashboard_.WaitForRevision(1);
  EXPECT_EQ(state["link"]["server_version"], "9.8.7");
  EXPECT_EQ(state["summary"]["keyframes"], 300);
  ASSERT_EQ(state["missions"].size(), 5u);
  EXPECT_EQ(state["missions"][0]["robot"], "robot01");
  EXPECT_TRUE(state["missions"][0]["anchored"]);
  EXPECT_FALSE(state["missions"][4]["anchored"]);
  EXPECT_EQ(state["missions"][0]["comparison"]["largest"].size(), 8u);
  const json& robot = state["robots"][3];
  EXPECT_EQ(robot["link"]["bytes_waiting"], 6'300'000);
  EXPECT_NEAR(robot["link"]["clock_offset_s"].get<double>(), 3.2e-3, 1e-9);
  EXPECT_EQ(robot["comparison"]["constraints"]["chord"], 8);
  EXPECT_NEAR(robot["comparison"]["predicted_rmse_m"].get<double>(), 0.061, 1e-9);
}

TEST_F(DashboardTest, TracksComeAsFramesAndAgainOnlyWhenTheyChanged) {
  dashboard_.WaitForRevision(1);
  const DecodedFrame positions = dashboard_.Frame("/api/positions");
  const DecodedFrame odometry = dashboard_.Frame("/api/odometry?since=0");
  const DecodedFrame discrepancy = dashboard_.Frame("/api/discrepancy");
  ASSERT_EQ(positions.tracks.size(), 5u);
  EXPECT_EQ(positions.tracks.at(0).size(), 60u);
  EXPECT_EQ(odometry.tracks.at(0).size(), 60u);
  EXPECT_EQ(odometry.tracks.at(0).values[0], 0);  // a mission begins at its own origin
  EXPECT_EQ(discrepancy.tracks.at(0).size(), 60u);

  server_.Advance();
  dashboard_.WaitForRevision(2);
  const std::string since = std::to_string(static_cast<uint64_t>(positions.version));
  const DecodedFrame next = dashboard_.Frame("/api/positions?since=" + since);
  EXPECT_GT(next.version, positions.version);
  EXPECT_EQ(next.tracks.count(0), 1u);
  EXPECT_EQ(next.tracks.count(4), 0u);  // not in the map: the optimiser left it where it was
  EXPECT_EQ(
      dashboard_
          .Frame("/api/odometry?since=" + std::to_string(static_cast<uint64_t>(odometry.version)))
          .tracks.size(),
      0u);
}

TEST_F(DashboardTest, WhileTheMapStandsStillNoTrajectoryIsAskedForAgain) {
  const json first = dashboard_.WaitForRevision(1);
  EXPECT_EQ(server_.trajectories_asked(), 5);
  dashboard_.WaitFor(
      [&](const json& state) { return state["version"] > first["version"].get<int>() + 5; });
  EXPECT_EQ(server_.trajectories_asked(), 5);
}

TEST_F(DashboardTest, ClosuresHaveReasonsFiguresAndVerdicts) {
  dashboard_.WaitForRevision(1);
  const json closures = dashboard_.Json("/api/closures");
  EXPECT_EQ(closures["closures"].size(), closures["total"]);
  const json& closure = closures["closures"][0];
  EXPECT_EQ(closure["verdict"], "accepted");
  EXPECT_THAT(closure["reason"].get<std::string>(), HasSubstr("fits the map"));
  EXPECT_NEAR(closure["registration"]["residual_m"].get<double>(), 0.043, 1e-9);
  EXPECT_EQ(closure["from"]["robot"], "robot01");
}

TEST_F(DashboardTest, RevisionsAreListedAndThoseThatWereSeenCanBeShown) {
  dashboard_.WaitForRevision(1);
  server_.Advance();
  dashboard_.WaitForRevision(2);
  const json list = dashboard_.Json("/api/revisions");
  ASSERT_EQ(list["revisions"].size(), 2u);
  EXPECT_EQ(list["revisions"][0]["revision"], 2);
  EXPECT_EQ(list["revisions"][0]["stages"][1]["stage"], "optimise");
  ASSERT_EQ(list["seen"].size(), 2u);
  const DecodedFrame first = dashboard_.Frame("/api/revisions/7/1");
  const DecodedFrame second = dashboard_.Frame("/api/revisions/7/2");
  EXPECT_EQ(first.tracks.at(0).size(), 60u);
  EXPECT_NE(first.tracks.at(0).values, second.tracks.at(0).values);
  EXPECT_EQ(dashboard_.http().Get("/api/revisions/7/3")->status, 404);
  EXPECT_EQ(dashboard_.http().Get("/api/revisions/7/99999999999999999999")->status, 404);
}

TEST_F(DashboardTest, ManyWhoLookAtACloudCostTheServerOneExport) {
  dashboard_.WaitForRevision(1);
  const std::string file = dashboard_.Get("/api/cloud?voxel_m=0.5");
  EXPECT_EQ(file.substr(0, 4), "ply\n");
  EXPECT_THAT(file.substr(0, 200), HasSubstr("voxel 0.5 m"));
  EXPECT_EQ(dashboard_.Get("/api/cloud?voxel_m=0.5"), file);
  EXPECT_EQ(server_.clouds_asked(), 1);
  EXPECT_THAT(dashboard_.Get("/api/cloud").substr(0, 200), HasSubstr("voxel 0.2 m"));
  for (const char* bad : {"nan", "0", "1e9", "-1", "x"}) {
    EXPECT_EQ(dashboard_.http().Get(std::string("/api/cloud?voxel_m=") + bad)->status, 400) << bad;
  }
}

TEST_F(DashboardTest, EventsSayThatThereIsANewerView) {
  dashboard_.WaitForRevision(1);
  std::vector<std::string> events;
  httplib::Client listener(dashboard_.server().url());
  const auto result = listener.Get("/api/events", [&](const char* data, size_t size) {
    events.emplace_back(data, size);
    return events.size() < 3;
  });
  ASSERT_EQ(events.size(), 3u);
  for (const std::string& event : events) EXPECT_EQ(event.substr(0, 6), "data: ") << event;
  EXPECT_LT(std::stoi(events[0].substr(6)), std::stoi(events[2].substr(6)));
}

TEST_F(DashboardTest, AVetoGoesToTheServerAndTheMapIsReadAtOnce) {
  dashboard_.WaitForRevision(1);
  const std::string id = FirstClosure();
  const auto result = dashboard_.Veto(id);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->status, 204) << result->body;
  dashboard_.WaitForRevision(2);
  EXPECT_EQ(dashboard_.Json("/api/closures")["closures"][0]["verdict"], "vetoed_by_operator");
  EXPECT_EQ(dashboard_.Veto("nobody>nowhere")->status, 404);
}

TEST_F(DashboardTest, AVetoFromAnotherSiteIsRefused) {
  dashboard_.WaitForRevision(1);
  const std::string id = FirstClosure();
  const std::string evil = "http://evil.example.org";
  EXPECT_EQ(dashboard_.Veto(id, {})->status, 403);
  EXPECT_EQ(dashboard_.Veto(id, {{"X-Overtone-Dashboard", "1"}, {"Origin", evil}})->status, 403);
  EXPECT_EQ(dashboard_.Veto(id, {{"X-Overtone-Dashboard", "1"}, {"Sec-Fetch-Site", "cross-site"}})
                ->status,
            403);
  // A name of theirs that points here: nothing is answered at all.
  EXPECT_EQ(
      dashboard_.Veto(id, {{"X-Overtone-Dashboard", "1"}, {"Host", "evil.example.org"}})->status,
      421);
  EXPECT_EQ(dashboard_.http().Get("/api/state", {{"Host", "evil.example.org"}})->status, 421);
  EXPECT_EQ(dashboard_.Json("/api/closures")["closures"][0]["verdict"], "accepted");
}

TEST_F(DashboardTest, BadRequestsAreAnsweredAndNothingElseHappens) {
  dashboard_.WaitForRevision(1);
  for (const char* body : {"", "{", "[]", "7", "{\"id\":7}", "{\"id\":\"\"}", "\xff\xfe"}) {
    const auto result = dashboard_.http().Post("/api/closures/veto", Dashboard::OurPage(), body,
                                               "application/json");
    ASSERT_TRUE(result);
    EXPECT_EQ(result->status, 400) << body;
  }
  EXPECT_EQ(dashboard_.Veto(std::string(100'000, 'x'))->status, 413);
  EXPECT_EQ(dashboard_.http().Get("/api/positions?since=x")->status, 400);
  EXPECT_EQ(dashboard_.http().Get("/api/nothing")->status, 404);
  EXPECT_EQ(dashboard_.http().Get("/../../etc/passwd")->status, 404);
  EXPECT_EQ(dashboard_.WaitForRevision(1)["summary"]["revision"], 1);
}

TEST_F(DashboardTest, WhenTheServerIsAwayTheLastViewStaysAndItsReturnIsNoticed) {
  dashboard_.WaitForRevision(1);
  server_.Refuse(grpc::StatusCode::UNAVAILABLE);
  const json away = dashboard_.WaitFor([](const json& state) { return !state["link"]["ok"]; });
  EXPECT_EQ(away["link"]["code"], "UNAVAILABLE");
  EXPECT_EQ(away["link"]["error"], "not today");
  EXPECT_EQ(away["missions"].size(), 5u);
  server_.Refuse(grpc::StatusCode::OK);
  server_.Advance();
  EXPECT_EQ(dashboard_.WaitForRevision(2)["missions"].size(), 5u);
}

TEST_F(DashboardTest, EveryAnswerForbidsWhatIsNotOurs) {
  for (const char* path : {"/", "/api/config", "/api/nothing"}) {
    const auto result = dashboard_.http().Get(path);
    ASSERT_TRUE(result);
    EXPECT_THAT(result->get_header_value("Content-Security-Policy"),
                HasSubstr("default-src 'none'"));
    EXPECT_EQ(result->get_header_value("X-Content-Type-Options"), "nosniff");
  }
  // No page was given: it says so, and the rest works.
  EXPECT_EQ(dashboard_.http().Get("/")->status, 503);
  EXPECT_EQ(dashboard_.Get("/healthz"), "ok\n");
}

TEST(Dashboard, AnOlderServerIsShownWithoutWhatItCannotSay) {
  SyntheticServer server(SyntheticMapOptions{3, 40, 6, 100});
  server.ActOld();
  Dashboard dashboard(Dashboard::Options(server.address()));
  const json state = dashboard.WaitForRevision(1);
  EXPECT_EQ(state["missions"].size(), 3u);
  EXPECT_FALSE(state["missions"][0].contains("comparison"));
  EXPECT_FALSE(state["robots"][0].contains("link"));
  EXPECT_EQ(dashboard.Frame("/api/positions").tracks.size(), 3u);
  EXPECT_EQ(dashboard.Frame("/api/odometry").tracks.size(), 0u);
  EXPECT_EQ(dashboard.Frame("/api/discrepancy").tracks.size(), 0u);
  EXPECT_EQ(dashboard.http().Get("/api/cloud")->status, 400);
}

TEST(Dashboard, ReadOnlyItVetoesNothing) {
  SyntheticServer server(SyntheticMapOptions{2, 40, 6, 100});
  DashboardOptions options = Dashboard::Options(server.address());
  options.read_only = true;
  Dashboard dashboard(options);
  dashboard.WaitForRevision(1);
  EXPECT_TRUE(dashboard.Json("/api/config")["read_only"]);
  const std::string id = dashboard.Json("/api/closures")["closures"][0]["id"];
  EXPECT_EQ(dashboard.Veto(id)->status, 403);
  EXPECT_EQ(dashboard.Json("/api/closures")["closures"][0]["verdict"], "accepted");
}

TEST(Dashboard, AMapBeyondTheLimitIsThinnedEvenly) {
  SyntheticServer server(SyntheticMapOptions{4, 100, 0, 100});
  DashboardOptions options = Dashboard::Options(server.address());
  options.mirror.max_nodes = 200;
  Dashboard dashboard(options);
  dashboard.WaitForRevision(1);
  for (const auto& [mission, track] : dashboard.Frame("/api/positions").tracks) {
    EXPECT_EQ(track.size(), 51u) << mission;  // every second and the last
  }
}

TEST(Dashboard, StartsBeforeTheServerAndShowsThatItIsAway) {
  Dashboard dashboard(Dashboard::Options("localhost:1"));
  const json state = dashboard.WaitFor(
      [](const json& s) { return s["version"] > 0 && s["link"]["code"] == "UNAVAILABLE"; });
  EXPECT_EQ(state["missions"].size(), 0u);
  EXPECT_EQ(state["link"]["refreshed_ms"], nullptr);
}

TEST(Dashboard, ServesThePageAndNothingBesideIt) {
  const TemporaryDirectory directory;
  std::filesystem::create_directories(directory.File("page/assets"));
  std::ofstream(directory.File("page/index.html")) << "<p>page</p>";
  std::ofstream(directory.File("page/assets/a-1.js")) << "1";
  std::ofstream(directory.File("secret.txt")) << "secret";
  DashboardOptions options = Dashboard::Options("localhost:1");
  options.web_root = directory.File("page");
  Dashboard dashboard(options);
  EXPECT_EQ(dashboard.Get("/"), "<p>page</p>");
  EXPECT_THAT(dashboard.http().Get("/assets/a-1.js")->get_header_value("Cache-Control"),
              HasSubstr("immutable"));
  EXPECT_EQ(dashboard.http().Get("/")->get_header_value("Cache-Control"), "no-cache");
  EXPECT_EQ(dashboard.http().Get("/../secret.txt")->status, 404);
  EXPECT_EQ(dashboard.http().Get("/%2e%2e/secret.txt")->status, 404);
  EXPECT_EQ(dashboard.http().Get("/assets/../../secret.txt")->status, 404);
}

TEST(Dashboard, AnAddressThatIsTakenIsRefused) {
  Dashboard first(Dashboard::Options("localhost:1"));
  DashboardOptions options = Dashboard::Options("localhost:1");
  options.listen = first.server().url().substr(7);
  const auto second = DashboardServer::Start(options);
  EXPECT_TRUE(absl::IsUnavailable(second.status())) << second.status();
}

}  // namespace
}  // namespace overtone
