// SPDX-License-Identifier: Apache-2.0
// The service before a real mapping server, with certificates.
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/tests/services/dashboard/dashboard_fixture.h"
#include "overtone/tests/services/mapping_server/tls_fixture.h"

namespace overtone {
namespace {

using nlohmann::json;
using testing::Dashboard;
using ::testing::HasSubstr;
using testing::MakeClosure;
using testing::MakeSubmap;
using testing::TlsFolder;
using testing::Uploader;

const char kAccess[] =
    "maps:\n"
    "  mine:\n"
    "    robots: [anna]\n"
    "    operators: [olga]\n";
const MissionId kAnna = {"anna", "run1"};
const char kWrong[] = "anna/run1:18>anna/run1:0#0";  // by metres

class DashboardLiveTest : public ::testing::Test {
 protected:
  DashboardLiveTest() : files_(kAccess) {
    auto server = MappingServer::Start(files_.Options());
    EXPECT_TRUE(server.ok()) << server.status();
    server_ = *std::move(server);
  }

  DashboardOptions OptionsFor(const CertificateAndKey& certificate) {
    DashboardOptions options = Dashboard::Options(server_->address(), "mine");
    const std::string& path = files_.folder.path();
    options.connection.files.ca_file = path + "/ca.crt";
    options.connection.files.certificate_file =
        files_.folder.Write("me.crt", certificate.certificate_pem);
    options.connection.files.key_file = files_.folder.Write("me.key", certificate.key_pem);
    return options;
  }

  void Upload() {
    const auto channel =
        testing::Connect(server_->address(), files_.ca.ca_pem(), files_.ca.Robot("anna"));
    const auto stub = v1::MappingService::NewStub(channel);
    Uploader uploader(*stub, "mine", kAnna);
    ASSERT_TRUE(uploader.Read().has_ready());
    Submap submap = MakeSubmap(0, 0, 20);
    submap.loop_closures = {MakeClosure({kAnna, 18}, {kAnna, 0})};
    ASSERT_TRUE(uploader.Send(submap).has_ack());
    EXPECT_TRUE(uploader.Close().ok());
  }

  const TlsFolder files_;
  std::unique_ptr<MappingServer> server_;
};

TEST_F(DashboardLiveTest, AnOperatorSeesAMapComeIntoBeingAndVetoes) {
  Dashboard dashboard(OptionsFor(files_.ca.Operator("olga")));
  const json nothing = dashboard.WaitFor([](const json& s) { return s["link"]["ok"]; });
  EXPECT_FALSE(nothing["summary"]["exists"]);
  Upload();
  const json state = dashboard.WaitFor(
      [](const json& s) { return s["summary"]["exists"] && s["missions"].size() == 1; });
  EXPECT_EQ(state["robots"][0]["robot"], "anna");
  EXPECT_EQ(state["missions"][0]["keyframes"], 20);
  const auto tracks = dashboard.Frame("/api/positions").tracks;
  ASSERT_EQ(tracks.size(), 1u);
  EXPECT_EQ(tracks.begin()->second.size(), 20u);

  const auto verdict = [&dashboard] {
    const json closures = dashboard.Json("/api/closures")["closures"];
    return closures.empty() ? "" : closures[0]["verdict"].get<std::string>();
  };
  EXPECT_NE(verdict(), "vetoed_by_operator");
  const auto result = dashboard.Veto(kWrong);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->status, 204) << result->body;
  dashboard.WaitFor([&](const json&) { return verdict() == "vetoed_by_operator"; });
}

TEST_F(DashboardLiveTest, ARobotsCertificateIsToldThatItMayNot) {
  Dashboard dashboard(OptionsFor(files_.ca.Robot("anna")));
  const json state =
      dashboard.WaitFor([](const json& s) { return s["link"]["code"] == "PERMISSION_DENIED"; });
  EXPECT_THAT(state["link"]["error"].get<std::string>(), HasSubstr("for operators"));
  EXPECT_EQ(dashboard.Veto(kWrong)->status, 403);
}

TEST_F(DashboardLiveTest, CertificatesThatCannotBeUsedAreRefusedByFlag) {
  DashboardOptions options = OptionsFor(files_.ca.Operator("olga"));
  options.connection.files.key_file = files_.folder.path() + "/none.key";
  const auto server = DashboardServer::Start(options);
  ASSERT_FALSE(server.ok());
  EXPECT_THAT(std::string(server.status().message()), HasSubstr("--tls-key"));
}

}  // namespace
}  // namespace overtone
