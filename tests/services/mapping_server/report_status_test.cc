// SPDX-License-Identifier: Apache-2.0
// What robots report, and what operators are told of it.
#include <string>
#include <vector>

#include "absl/time/clock.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/proto/conversion/report_conversion.h"
#include "overtone/services/mapping_server/robot_traffic.h"
#include "overtone/tests/services/mapping_server/server_fixture.h"
#include "overtone/tests/support/temporary_directory.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;
using testing::MakeSubmap;
using testing::ServerTest;
using ::testing::StartsWith;
using testing::Uploader;
using testing::Watcher;

const MissionId kRun1 = {"anna", "run1"};
const MissionId kRun2 = {"anna", "run2"};

class ReportStatusTest : public ServerTest {
 protected:
  v1::ReportStatusRequest Request(const MissionId& mission, int64_t bytes_waiting) {
    v1::ReportStatusRequest request;
    request.set_map("mine");
    *request.mutable_mission() = ToProto(mission);
    request.mutable_link()->set_bytes_waiting(bytes_waiting);
    return request;
  }
  static void AddComparison(v1::ReportStatusRequest& request, uint64_t revision) {
    v1::ComparisonReport& comparison = *request.mutable_comparison();
    comparison.set_revision(revision);
    comparison.set_duration_s(0.5);
    comparison.add_index(3);
    comparison.add_small(1);
    comparison.add_mid(2);
    comparison.add_large(3);
    comparison.add_largest()->set_to(3);
    comparison.add_constraints()->set_added(4);
  }

  grpc::Status Report(const v1::ReportStatusRequest& request) {
    grpc::ClientContext context;
    context.set_deadline(testing::Deadline());
    v1::ReportStatusResponse response;
    return mapping_->ReportStatus(&context, request, &response);
  }

  grpc::Status Get(const MissionId& mission, v1::StatusReport& report) {
    v1::GetStatusReportRequest request;
    request.set_map("mine");
    *request.mutable_mission() = ToProto(mission);
    v1::GetStatusReportResponse response;
    const grpc::Status status = Try(&v1::MapAdminService::Stub::GetStatusReport, request, response);
    report = response.report();
    return status;
  }

  v1::Robot Anna() {
    v1::ListRobotsRequest request;
    request.set_map("mine");
    const auto response =
        Call<v1::ListRobotsResponse>(&v1::MapAdminService::Stub::ListRobots, request);
    EXPECT_EQ(response.robots_size(), 1);
    return response.robots_size() == 1 ? response.robots(0) : v1::Robot();
  }
  // Until it holds: counters move a little after the peer has seen the effect.
  template <typename Condition>
  v1::Robot AnnaWhen(const Condition& holds) {
    const auto deadline = testing::Deadline();
    v1::Robot robot = Anna();
    while (!holds(robot) && std::chrono::system_clock::now() < deadline) robot = Anna();
    EXPECT_TRUE(holds(robot)) << robot.ShortDebugString();
    return robot;
  }
};

TEST_F(ReportStatusTest, TheNewestOfEachMissionIsKept) {
  Upload("mine", kRun1, 1, 5);
  Upload("mine", kRun2, 1, 5);
  const absl::Time before = absl::Now();
  v1::ReportStatusRequest full = Request(kRun1, 10);
  AddComparison(full, 4);
  ASSERT_TRUE(Report(full).ok());
  ASSERT_TRUE(Report(Request(kRun1, 11)).ok());  // says nothing of a comparison
  ASSERT_TRUE(Report(Request(kRun2, 20)).ok());
  v1::StatusReport report;
  ASSERT_TRUE(Get(kRun1, report).ok());
  EXPECT_EQ(report.mission().mission(), "run1");
  EXPECT_EQ(report.link().bytes_waiting(), 11);
  EXPECT_EQ(report.comparison().revision(), 4u);
  EXPECT_THAT(report.comparison().large(), ElementsAre(3));
  EXPECT_GE(report.received().seconds(), absl::ToUnixSeconds(before));
  ASSERT_TRUE(Get(kRun2, report).ok());
  EXPECT_EQ(report.link().bytes_waiting(), 20);
  EXPECT_FALSE(report.has_comparison());
}

TEST_F(ReportStatusTest, RobotsAreListedWithTheirLastReportWithoutItsColumns) {
  Upload("mine", kRun1, 1, 5);
  Upload("mine", kRun2, 1, 5);
  EXPECT_FALSE(Anna().has_report());
  ASSERT_TRUE(Report(Request(kRun2, 20)).ok());
  v1::ReportStatusRequest full = Request(kRun1, 10);
  AddComparison(full, 4);
  ASSERT_TRUE(Report(full).ok());
  const v1::StatusReport report = Anna().report();
  EXPECT_EQ(report.mission().mission(), "run1");
  EXPECT_EQ(report.link().bytes_waiting(), 10);
  EXPECT_EQ(report.comparison().revision(), 4u);
  EXPECT_EQ(report.comparison().constraints(0).added(), 4);
  EXPECT_EQ(report.comparison().index_size() + report.comparison().small_size() +
                report.comparison().mid_size() + report.comparison().large_size() +
                report.comparison().largest_size(),
            0);
}

TEST_F(ReportStatusTest, WhatIsNotInTheMapIsNotFound) {
  EXPECT_EQ(Report(Request(kRun1, 1)).error_code(), grpc::StatusCode::NOT_FOUND);
  v1::StatusReport report;
  EXPECT_EQ(Get(kRun1, report).error_code(), grpc::StatusCode::NOT_FOUND);
  Upload("mine", kRun1, 1, 5);
  const grpc::Status status = Report(Request(kRun2, 1));
  EXPECT_EQ(status.error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_THAT(status.error_message(), StartsWith("mission: "));
  EXPECT_EQ(Get(kRun1, report).error_code(), grpc::StatusCode::NOT_FOUND);  // has not reported
  EXPECT_EQ(Get(kRun2, report).error_code(), grpc::StatusCode::NOT_FOUND);
}

TEST_F(ReportStatusTest, ABadReportIsRefusedByItsFieldAndChangesNothing) {
  Upload("mine", kRun1, 1, 5);
  ASSERT_TRUE(Report(Request(kRun1, 1)).ok());
  v1::ReportStatusRequest bad_link = Request(kRun1, -2);
  v1::ReportStatusRequest bad_column = Request(kRun1, 2);
  AddComparison(bad_column, 4);
  bad_column.mutable_comparison()->add_mid(0);
  v1::ReportStatusRequest bad_mission = Request({"Anna", "run1"}, 2);
  const std::pair<v1::ReportStatusRequest, std::string> cases[] = {
      {bad_link, "link.bytes_waiting: "},
      {bad_column, "comparison.mid: "},
      {bad_mission, "mission.robot: "},
      {v1::ReportStatusRequest(), "map: "},
  };
  for (const auto& [request, field] : cases) {
    const grpc::Status status = Report(request);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
    EXPECT_THAT(status.error_message(), StartsWith(field));
  }
  v1::StatusReport report;
  ASSERT_TRUE(Get(kRun1, report).ok());
  EXPECT_EQ(report.link().bytes_waiting(), 1);
}

TEST_F(ReportStatusTest, UnknownFieldsAreNotKept) {
  Upload("mine", kRun1, 1, 5);
  v1::ReportStatusRequest request = Request(kRun1, 1);
  auto* link = request.mutable_link();
  link->GetReflection()->MutableUnknownFields(link)->AddLengthDelimited(900,
                                                                        std::string(1 << 16, 'x'));
  ASSERT_TRUE(Report(request).ok());
  v1::StatusReport report;
  ASSERT_TRUE(Get(kRun1, report).ok());
  EXPECT_LT(report.ByteSizeLong(), 200u);
}

TEST_F(ReportStatusTest, AReportTakesOfTheRobotsCalls) {
  ServerOptions options = testing::TestOptions();
  options.quotas.max_calls_per_s = 0.001;
  options.quotas.calls_burst = 3;  // the upload's stream and two reports
  server_.reset();
  StartServer(options);
  Upload("mine", kRun1, 1, 5);
  EXPECT_TRUE(Report(Request(kRun1, 1)).ok());
  EXPECT_TRUE(Report(Request(kRun1, 1)).ok());
  EXPECT_EQ(Report(Request(kRun1, 1)).error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
}

TEST_F(ReportStatusTest, ADeletedMissionTakesItsReportAlong) {
  const TemporaryDirectory folder;
  ServerOptions options = testing::TestOptions();
  options.data_dir = folder.File("data");
  server_.reset();
  StartServer(options);
  Upload("mine", kRun1, 1, 5);
  Upload("mine", kRun2, 1, 5);
  ASSERT_TRUE(Report(Request(kRun1, 1)).ok());
  v1::DeleteMissionRequest request;
  request.set_map("mine");
  *request.mutable_mission() = ToProto(kRun1);
  Call<v1::DeleteMissionResponse>(&v1::MapAdminService::Stub::DeleteMission, request);
  v1::StatusReport report;
  EXPECT_EQ(Get(kRun1, report).error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_FALSE(Anna().has_report());
  server_.reset();  // before its folder goes
}

TEST_F(ReportStatusTest, TrafficOfUploadsAndWatchesIsCounted) {
  int64_t sent = 0;
  {
    Uploader uploader(*mapping_, "mine", kRun1);
    ASSERT_TRUE(uploader.Read().has_ready());
    const v1::Submap submap = ToProto(MakeSubmap(0, 0, 5));
    ASSERT_TRUE(uploader.Send(submap).has_ack());
    sent = static_cast<int64_t>(submap.ByteSizeLong());
  }
  const v1::Robot uploaded = AnnaWhen([](const v1::Robot& r) { return r.bytes_sent() > 0; });
  EXPECT_GT(uploaded.bytes_received(), sent);  // with the header, before the map was there
  EXPECT_LT(uploaded.bytes_received(), sent + 100);
  EXPECT_FALSE(uploaded.watching());
  const uint64_t revision = Settle("mine").revision();
  {
    v1::WatchGraphRequest request = testing::WatchRequest("mine");
    request.mutable_options()->set_robot("anna");
    Watcher watcher(*mapping_, request);
    const auto bytes = static_cast<int64_t>(watcher.ReadGraph().ByteSizeLong());
    const v1::Robot watching =
        AnnaWhen([&](const v1::Robot& r) { return r.revision_sent() == revision; });
    EXPECT_TRUE(watching.watching());
    EXPECT_GE(watching.bytes_sent(), uploaded.bytes_sent() + bytes);
  }
  AnnaWhen([](const v1::Robot& r) { return !r.watching(); });
}

TEST_F(ReportStatusTest, AWatchOfNoRobotCountsForNone) {
  Upload("mine", kRun1, 1, 5);
  Watcher watcher(*mapping_, testing::WatchRequest("mine"));
  watcher.ReadGraph();
  EXPECT_FALSE(Anna().watching());
}

TEST(RobotTraffic, InventedNamesTakeNoMemoryForLong) {
  RobotTraffic traffic(/*max_robots=*/2);
  const auto anna = traffic.Of("anna");
  traffic.Of("bert")->bytes_sent = 5;
  EXPECT_EQ(traffic.Of("bert")->bytes_sent, 5);
  const auto carl = traffic.Of("carl");  // in bert's place, who has no stream
  EXPECT_EQ(traffic.Find("bert"), nullptr);
  EXPECT_EQ(traffic.Find("anna"), anna);
  const auto dora = traffic.Of("dora");  // no room
  ASSERT_NE(dora, nullptr);
  EXPECT_EQ(traffic.Find("dora"), nullptr);
}

}  // namespace
}  // namespace overtone
