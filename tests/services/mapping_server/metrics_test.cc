// SPDX-License-Identifier: Apache-2.0
// What a Prometheus server would read.
#include <chrono>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/tests/services/mapping_server/server_fixture.h"
#include "overtone/tests/support/http_get.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::MakeClosure;
using testing::MakeSubmap;
using ::testing::Not;
using ::testing::StartsWith;
using testing::TestOptions;
using testing::Uploader;

const MissionId kAnna = {"anna", "run1"};

class MetricsTest : public testing::ServerTest {
 protected:
  void SetUp() override {
    ServerOptions options = TestOptions();
    options.metrics_listen = "127.0.0.1:0";
    StartServer(options);
  }
  std::string Scrape() { return HttpGet(server_->metrics_port(), "/metrics"); }
  // Until it says so: counters move a little after the peer has seen the effect.
  std::string ScrapeWhen(const std::string& line) {
    const auto deadline = testing::Deadline();
    std::string answer = Scrape();
    while (answer.find(line) == std::string::npos && std::chrono::system_clock::now() < deadline) {
      answer = Scrape();
    }
    EXPECT_THAT(answer, HasSubstr(line));
    return answer;
  }

  grpc::Status Report(const std::string& map, const v1::ConstraintKind kind) {
    v1::ReportStatusRequest request;
    request.set_map(map);
    *request.mutable_mission() = ToProto(kAnna);
    request.mutable_link()->set_bytes_waiting(4096);
    request.mutable_link()->set_submaps_waiting(2);
    request.mutable_link()->mutable_clock_offset()->set_nanos(-250'000'000);
    request.mutable_comparison()->set_duration_s(0.02);
    v1::ConstraintCount& count = *request.mutable_comparison()->add_constraints();
    count.set_kind(kind);
    count.set_added(7);
    v1::ReportStatusResponse response;
    grpc::ClientContext context;
    return mapping_->ReportStatus(&context, request, &response);
  }
};

TEST_F(MetricsTest, EveryMapTellsOfItsNewestRevision) {
  {
    Uploader uploader(*mapping_, "mine", kAnna);
    ASSERT_TRUE(uploader.Read().has_ready());
    Submap submap = MakeSubmap(0, 0, 20);
    LoopClosure closure = MakeClosure({kAnna, 15}, {kAnna, 3});
    closure.from_tform_to =
        submap.keyframes[15].mission_from_body.Inverse() * submap.keyframes[3].mission_from_body;
    submap.loop_closures.push_back(closure);
    submap.loop_closures.push_back(MakeClosure({kAnna, 12}, {{"carl", "run1"}, 3}));
    ASSERT_TRUE(uploader.Send(submap).has_ack());
    EXPECT_TRUE(uploader.Close().ok());
  }
  Upload("yours", kAnna, 1, 7);
  Settle("mine");
  Settle("yours");
  const std::string answer = Scrape();
  EXPECT_THAT(answer, HasSubstr("200 OK"));
  for (const char* line : {
           "# TYPE overtone_loop_closures gauge",
           "overtone_loop_closures{map=\"mine\",verdict=\"accepted\"} 1\n",
           "overtone_loop_closures{map=\"mine\",verdict=\"pending\"} 1\n",
           "overtone_loop_closures{map=\"mine\",verdict=\"vetoed_by_operator\"} 0\n",
           "overtone_loop_closures{map=\"yours\",verdict=\"accepted\"} 0\n",
           "overtone_keyframes{map=\"mine\"} 20\n",
           "overtone_keyframes{map=\"yours\"} 7\n",
           "overtone_missions{map=\"mine\",anchored=\"true\"} 1\n",
           "overtone_missions{map=\"mine\",anchored=\"false\"} 0\n",
           "overtone_revision{map=\"yours\"} 1\n",
           "overtone_front_end_backlog{map=\"mine\"} 0\n",
           "overtone_revision_age_seconds{map=\"mine\"}",
           "overtone_optimisation_seconds{map=\"mine\"}",
       }) {
    EXPECT_THAT(answer, HasSubstr(line));
  }
}

TEST_F(MetricsTest, WithoutMapsThereIsNothingToTell) {
  const std::string answer = Scrape();
  EXPECT_THAT(answer, HasSubstr("200 OK"));
  EXPECT_THAT(answer, Not(HasSubstr("{map=")));
}

TEST_F(MetricsTest, CallsAreCountedByMethodAndCode) {
  Upload("mine", kAnna, 2, 5);
  v1::GetGraphRequest request;
  request.set_map("nowhere");
  for (int i = 0; i < 3; ++i) {
    grpc::ClientContext context;
    v1::GetGraphResponse response;
    EXPECT_EQ(mapping_->GetGraph(&context, request, &response).error_code(),
              grpc::StatusCode::NOT_FOUND);
  }
  const std::string answer =
      ScrapeWhen("overtone_rpc_in_progress{method=\"MappingService/UploadSubmaps\"} 0\n");
  for (const char* line : {
           "overtone_rpc_started_total{method=\"MappingService/GetGraph\"} 3\n",
           "overtone_rpc_handled_total{method=\"MappingService/GetGraph\",code=\"NOT_FOUND\"} 3\n",
           "overtone_rpc_duration_seconds_count{method=\"MappingService/GetGraph\","
           "code=\"NOT_FOUND\"} 3\n",
           "overtone_rpc_duration_seconds_bucket{method=\"MappingService/GetGraph\","
           "code=\"NOT_FOUND\",le=\"+Inf\"} 3\n",
           "overtone_rpc_handled_total{method=\"MappingService/UploadSubmaps\",code=\"OK\"} 1\n",
           "overtone_rpc_started_total{method=\"MapAdminService/DeleteMap\"} 0\n",
       }) {
    EXPECT_THAT(answer, HasSubstr(line));
  }
  EXPECT_THAT(answer,
              Not(HasSubstr("overtone_rpc_handled_total{method=\"MapAdminService/DeleteMap")));
}

TEST_F(MetricsTest, AStreamIsInProgressUntilItEnds) {
  {
    Uploader uploader(*mapping_, "mine", kAnna);
    ASSERT_TRUE(uploader.Read().has_ready());
    EXPECT_THAT(Scrape(),
                HasSubstr("overtone_rpc_in_progress{method=\"MappingService/UploadSubmaps\"} 1\n"));
  }  // cancelled
  ScrapeWhen("overtone_rpc_in_progress{method=\"MappingService/UploadSubmaps\"} 0\n");
  // Half-closed or cancelled, as the server comes to see it.
  ScrapeWhen("overtone_rpc_handled_total{method=\"MappingService/UploadSubmaps\",code=\"");
}

TEST_F(MetricsTest, EachRevisionHasItsStagesAndTheStoreItsCommits) {
  Upload("mine", kAnna, 2, 5);
  Settle("mine");
  v1::ListRevisionsRequest request;
  request.set_map("mine");
  const auto revisions =
      Call<v1::ListRevisionsResponse>(&v1::MapAdminService::Stub::ListRevisions, request);
  ASSERT_GT(revisions.revisions_size(), 0);
  const v1::Revision& newest = revisions.revisions(0);
  std::vector<std::string> stages;
  for (const v1::StageTime& stage : newest.stages()) {
    stages.push_back(stage.stage());
    EXPECT_GE(stage.seconds(), 0) << stage.stage();
    EXPECT_LT(stage.seconds(), 60) << stage.stage();
  }
  EXPECT_THAT(stages, ElementsAre("intake", "optimise", "snapshot", "store", "publish"));
  EXPECT_DOUBLE_EQ(newest.stages(1).seconds(), newest.optimisation_s());
  const std::string answer = Scrape();
  for (const std::string& stage : stages) {
    EXPECT_THAT(answer,
                HasSubstr(absl::StrCat("overtone_cycle_stage_seconds_count{map=\"mine\",stage=\"",
                                       stage, "\"} ", revisions.revisions_size(), "\n")));
  }
  EXPECT_THAT(answer, HasSubstr("overtone_store_errors_total{map=\"mine\"} 0\n"));
  EXPECT_THAT(answer, HasSubstr("overtone_components{map=\"mine\"} 1\n"));
  EXPECT_THAT(answer, HasSubstr("overtone_queue_depth{map=\"mine\",queue=\"store\"} 0\n"));
  EXPECT_THAT(answer, Not(HasSubstr("overtone_store_commit_seconds_count{map=\"mine\"} 0\n")));
}

TEST_F(MetricsTest, RobotsAreToldOfAsTheyReport) {
  Upload("mine", kAnna, 1, 5);
  ASSERT_TRUE(Report("mine", v1::CONSTRAINT_KIND_MID).ok());
  ASSERT_TRUE(Report("mine", v1::CONSTRAINT_KIND_MID).ok());
  // A kind that this server does not know.
  ASSERT_TRUE(Report("mine", static_cast<v1::ConstraintKind>(77)).ok());
  const std::string answer =
      ScrapeWhen("overtone_robot_uploading{map=\"mine\",robot=\"anna\"} 0\n");
  for (const char* line : {
           "overtone_robot_outbox_bytes{map=\"mine\",robot=\"anna\"} 4096\n",
           "overtone_robot_outbox_submaps{map=\"mine\",robot=\"anna\"} 2\n",
           "overtone_robot_clock_offset_seconds{map=\"mine\",robot=\"anna\"} -0.25\n",
           "overtone_robot_constraints_total{map=\"mine\",robot=\"anna\",kind=\"mid\"} 14\n",
           "overtone_robot_constraints_total{map=\"mine\",robot=\"anna\",kind=\"unspecified\"} 7\n",
           "overtone_robot_constraints_total{map=\"mine\",robot=\"anna\",kind=\"small\"} 0\n",
           "overtone_comparison_seconds_count{map=\"mine\"} 3\n",
           "overtone_robot_watching{map=\"mine\",robot=\"anna\"} 0\n",
       }) {
    EXPECT_THAT(answer, HasSubstr(line));
  }
}

TEST_F(MetricsTest, ADeletedMapIsNotToldOfAnyMore) {
  Upload("mine", kAnna, 1, 5);
  Upload("yours", kAnna, 1, 5);
  ASSERT_TRUE(Report("mine", v1::CONSTRAINT_KIND_MID).ok());
  EXPECT_THAT(Scrape(), HasSubstr("{map=\"mine\""));
  v1::DeleteMapRequest request;
  request.set_map("mine");
  Call<v1::DeleteMapResponse>(&v1::MapAdminService::Stub::DeleteMap, request);
  const std::string answer = Scrape();
  EXPECT_THAT(answer, Not(HasSubstr("{map=\"mine\"")));
  EXPECT_THAT(answer, HasSubstr("overtone_revision{map=\"yours\"}"));
  EXPECT_THAT(answer, HasSubstr("overtone_maps 1\n"));
}

TEST_F(MetricsTest, AnAddressThatCannotBeListenedOnIsNamed) {
  const struct {
    std::string listen;
    absl::StatusCode code;
  } cases[] = {
      {"nonsense", absl::StatusCode::kInvalidArgument},
      {"127.0.0.1:99999", absl::StatusCode::kInvalidArgument},
      {"192.0.2.1:80", absl::StatusCode::kUnavailable},  // of no host, RFC 5737
      {absl::StrCat("127.0.0.1:", server_->metrics_port()), absl::StatusCode::kUnavailable},
  };
  for (const auto& bad : cases) {
    ServerOptions options = TestOptions();
    options.metrics_listen = bad.listen;
    const auto server = MappingServer::Start(options);
    EXPECT_EQ(server.status().code(), bad.code) << bad.listen;
    EXPECT_THAT(std::string(server.status().message()), StartsWith("metrics_listen: "));
  }
}

TEST(WithoutMetrics, NoPortIsTaken) {
  const auto server = MappingServer::Start(TestOptions());
  ASSERT_TRUE(server.ok()) << server.status();
  EXPECT_EQ((*server)->metrics_port(), 0);
}

}  // namespace
}  // namespace overtone
