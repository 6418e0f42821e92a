// SPDX-License-Identifier: Apache-2.0
// One name for a call: in the answer, in the error and in the log.
#include "overtone/services/mapping_server/request_id.h"

#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "gmock/gmock.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "gtest/gtest.h"
#include "nlohmann/json.hpp"
#include "overtone/proto/conversion/status_conversion.h"
#include "overtone/services/mapping_server/log_format.h"
#include "overtone/tests/services/mapping_server/server_fixture.h"
#include "spdlog/sinks/ostream_sink.h"
#include "spdlog/spdlog.h"

namespace overtone {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;

const MissionId kAnna = {"anna", "run1"};

std::string InDetails(const grpc::Status& status) {
  google::rpc::Status details;
  details.ParseFromString(status.error_details());
  google::rpc::RequestInfo info;
  for (const auto& detail : details.details()) {
    if (detail.Is<google::rpc::RequestInfo>()) detail.UnpackTo(&info);
  }
  return info.request_id();
}

template <typename Metadata>
std::string InMetadata(const Metadata& metadata) {
  if (metadata.count(kRequestIdKey) != 1)
    return absl::StrCat(metadata.count(kRequestIdKey), " ids");
  const grpc::string_ref id = metadata.find(kRequestIdKey)->second;
  return {id.data(), id.size()};
}

// A server whose log is read as JSON.
class RequestIdTest : public testing::ServerTest {
 protected:
  void SetUp() override {
    before_ = spdlog::default_logger();
    auto sink = std::make_shared<spdlog::sinks::ostream_sink_mt>(log_);
    auto logger = std::make_shared<spdlog::logger>("captured", std::move(sink));
    logger->set_formatter(JsonLines());
    spdlog::set_default_logger(std::move(logger));
    StartServer();
  }
  void TearDown() override {
    server_.reset();
    spdlog::set_default_logger(before_);
  }

  struct Answer {
    grpc::Status status;
    std::string initial, trailing;
  };
  // A call that is refused for want of a map, or one that succeeds.
  Answer Call(const std::vector<std::string>& ids, bool refused) {
    grpc::ClientContext context;
    context.set_deadline(testing::Deadline());
    for (const std::string& id : ids) context.AddMetadata(kRequestIdKey, id);
    Answer answer;
    if (refused) {
      v1::GetGraphRequest request;
      request.set_map("nowhere");
      v1::GetGraphResponse response;
      answer.status = mapping_->GetGraph(&context, request, &response);
    } else {
      v1::GetServerInfoResponse response;
      answer.status = mapping_->GetServerInfo(&context, {}, &response);
    }
    answer.initial = InMetadata(context.GetServerInitialMetadata());
    answer.trailing = InMetadata(context.GetServerTrailingMetadata());
    return answer;
  }

  // The log's lines about that request. The server has ended.
  std::vector<nlohmann::json> LinesAbout(const std::string& id) {
    server_.reset();
    std::vector<nlohmann::json> lines;
    const std::string log = log_.str();
    for (absl::string_view line : absl::StrSplit(log, '\n', absl::SkipEmpty())) {
      nlohmann::json object = nlohmann::json::parse(line);
      if (object.value("request_id", "") == id) lines.push_back(std::move(object));
    }
    return lines;
  }

  std::shared_ptr<spdlog::logger> before_;
  std::ostringstream log_;
};

TEST_F(RequestIdTest, TheCallersIdComesBack) {
  const Answer good = Call({"anna_42-x"}, /*refused=*/false);
  EXPECT_TRUE(good.status.ok());
  EXPECT_EQ(good.initial, "anna_42-x");
  const Answer refused = Call({"anna_43-x"}, /*refused=*/true);
  EXPECT_EQ(refused.initial, "anna_43-x");
  EXPECT_EQ(refused.trailing, "anna_43-x");
  EXPECT_EQ(InDetails(refused.status), "anna_43-x");
  const absl::Status status = FromGrpcStatus(refused.status);
  EXPECT_THAT(std::string(status.message()), EndsWith(" (request anna_43-x)"));
  const std::vector<nlohmann::json> lines = LinesAbout("anna_43-x");
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_THAT(lines[0]["message"].get<std::string>(),
              MatchesRegex("MappingService/GetGraph from ipv[46].* refused: NOT_FOUND: map: .*"));
  EXPECT_EQ(lines[0]["map"], "nowhere");
}

TEST_F(RequestIdTest, WithoutOneTheServerMakesOne) {
  std::set<std::string> ids;
  for (int i = 0; i < 3; ++i) {
    const Answer refused = Call({}, /*refused=*/true);
    EXPECT_THAT(refused.initial, MatchesRegex("[0-9a-f]{16}"));
    EXPECT_EQ(InDetails(refused.status), refused.initial);
    EXPECT_EQ(refused.trailing, refused.initial);
    ids.insert(refused.initial);
  }
  EXPECT_EQ(ids.size(), 3u);
  EXPECT_EQ(LinesAbout(*ids.begin()).size(), 1u);
}

TEST_F(RequestIdTest, AnIdThatIsNoneIsReplaced) {
  for (const std::string& bad :
       {std::string(65, 'a'), std::string("a b"), std::string("a\"b"), std::string("")}) {
    EXPECT_THAT(Call({bad}, /*refused=*/false).initial, MatchesRegex("[0-9a-f]{16}")) << bad;
  }
  EXPECT_EQ(Call({std::string(64, 'a')}, /*refused=*/false).initial, std::string(64, 'a'));
  EXPECT_EQ(Call({"first", "second"}, /*refused=*/false).initial, "first");
}

TEST_F(RequestIdTest, AnOperatorsCallIsAboutItsMap) {
  Upload("mine", kAnna, 1, 3);
  v1::VetoLoopClosureRequest request;
  request.set_map("mine");
  request.set_id("anna/run1:0>bert/run1:2#0");
  for (const std::string& id : {"veto-1", "veto-2"}) {
    grpc::ClientContext context;
    context.set_deadline(testing::Deadline());
    context.AddMetadata(kRequestIdKey, id);
    v1::VetoLoopClosureResponse response;
    admin_->VetoLoopClosure(&context, request, &response);
    request.set_map("\x1b[2J");  // no id: not in the fields
  }
  const std::vector<nlohmann::json> first = LinesAbout("veto-1"), second = LinesAbout("veto-2");
  ASSERT_EQ(first.size(), 1u);
  EXPECT_EQ(first[0]["map"], "mine");
  ASSERT_EQ(second.size(), 1u);
  EXPECT_FALSE(second[0].contains("map"));
}

TEST_F(RequestIdTest, ARefusedStreamHasOneToo) {
  grpc::ClientContext context;
  context.set_deadline(testing::Deadline());
  context.AddMetadata(kRequestIdKey, "watch-1");
  v1::WatchGraphRequest request;
  request.set_map("No Such Name");
  const auto stream = mapping_->WatchGraph(&context, request);
  v1::WatchGraphResponse response;
  EXPECT_FALSE(stream->Read(&response));
  const grpc::Status status = stream->Finish();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(InDetails(status), "watch-1");
  EXPECT_EQ(InMetadata(context.GetServerInitialMetadata()), "watch-1");
  EXPECT_EQ(LinesAbout("watch-1").size(), 1u);
}

TEST_F(RequestIdTest, WhatAnUploadLogsIsAboutItsMissionAndItsRequest) {
  std::string id;
  {
    grpc::ClientContext context;
    context.set_deadline(testing::Deadline());
    context.AddMetadata(kRequestIdKey, "upload-1");
    const auto stream = mapping_->UploadSubmaps(&context);
    v1::UploadSubmapsRequest request;
    request.mutable_header()->set_map("mine");
    *request.mutable_header()->mutable_mission() = ToProto(kAnna);
    stream->Write(request);
    v1::UploadSubmapsResponse response;
    ASSERT_TRUE(stream->Read(&response) && response.has_ready());
    *request.mutable_submap() = ToProto(testing::MakeSubmap(5, 0, 3));  // a gap
    stream->Write(request);
    ASSERT_TRUE(stream->Read(&response) && response.has_reject());
    stream->WritesDone();
    EXPECT_TRUE(stream->Finish().ok());
    id = InMetadata(context.GetServerInitialMetadata());
  }
  EXPECT_EQ(id, "upload-1");
  const std::vector<nlohmann::json> lines = LinesAbout("upload-1");
  ASSERT_EQ(lines.size(), 2u);  // opened, rejected
  for (const nlohmann::json& line : lines) {
    EXPECT_EQ(line["map"], "mine");
    EXPECT_EQ(line["robot"], "anna");
    EXPECT_EQ(line["mission"], "run1");
  }
  EXPECT_THAT(lines[1]["message"].get<std::string>(), HasSubstr("submap 5 rejected"));
}

TEST(NewRequestId, NeverComesTwice) {
  std::set<std::string> ids;
  for (int i = 0; i < 10'000; ++i) ids.insert(NewRequestId());
  EXPECT_EQ(ids.size(), 10'000u);
  for (const std::string& id : ids) ASSERT_TRUE(IsRequestId(id)) << id;
}

}  // namespace
}  // namespace overtone
