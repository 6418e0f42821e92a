// SPDX-License-Identifier: Apache-2.0
// What the commands say and how they end when the server cannot be talked to, or will not have it.
#include "overtone/client/cli/server_error.h"

#include <cstdlib>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "nlohmann/json.hpp"
#include "overtone/client/cli/admin_commands.h"
#include "overtone/client/cli/exit_code.h"
#include "overtone/client/cli/health_command.h"
#include "overtone/tests/client/cli/command_outcome.h"
#include "overtone/tests/services/mapping_server/tls_fixture.h"

namespace overtone {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::Outcome;
using ::testing::StartsWith;
using testing::TlsFolder;

TEST(ExitCode, EveryStatusHasOne) {
  const TlsFiles none;
  const auto from_server = [&](grpc::StatusCode code) {
    return ExitCodeOf(ServerError("x:1", none, grpc::Status(code, "why")));
  };
  EXPECT_EQ(ExitCodeOf(absl::OkStatus()), 0);
  EXPECT_EQ(ExitCodeOf(absl::InternalError("")), 1);
  EXPECT_EQ(ExitCodeOf(absl::UnavailableError("cannot write file")), 1);  // not the server
  EXPECT_EQ(ExitCodeOf(absl::InvalidArgumentError("")), 2);
  EXPECT_EQ(from_server(grpc::StatusCode::NOT_FOUND), 2);
  EXPECT_EQ(from_server(grpc::StatusCode::UNAVAILABLE), 3);
  EXPECT_EQ(from_server(grpc::StatusCode::DEADLINE_EXCEEDED), 3);
  EXPECT_EQ(from_server(grpc::StatusCode::PERMISSION_DENIED), 4);
  EXPECT_EQ(from_server(grpc::StatusCode::UNAUTHENTICATED), 4);
  EXPECT_EQ(ExitCodeOf(absl::CancelledError("interrupted")), 130);
}

TEST(ServerError, WordsAddedBehindKeepWhereItCameFrom) {
  const absl::Status status =
      ServerError("x:1", TlsFiles(), {grpc::StatusCode::UNAVAILABLE, "map: being changed"});
  EXPECT_EQ(status.message(), "server x:1: map: being changed; try again");
  const absl::Status longer = WithHint(status, " later");
  EXPECT_EQ(longer.message(), "server x:1: map: being changed; try again later");
  EXPECT_TRUE(MayComeBack(longer));
  EXPECT_FALSE(MayComeBack(absl::UnavailableError("the disk")));
  EXPECT_TRUE(ServerError("x:1", TlsFiles(), grpc::Status::OK).ok());
}

Outcome RunTyped(std::vector<std::string> arguments) {
  return testing::RunCommand({AddAdminCommands, AddHealthCommand}, std::move(arguments));
}

TEST(PlaintextServer, SaysWhatIsWrongWithTheConnection) {
  auto server = MappingServer::Start(testing::TestOptions());
  ASSERT_TRUE(server.ok()) << server.status();
  const std::string address = (*server)->address();
  EXPECT_THAT(RunTyped({"health", "--server", address}).out, "SERVING\n");
  const Outcome empty = RunTyped({"robots", "--server", address, "--map", "town"});
  EXPECT_EQ(empty.exit_code, 2);
  EXPECT_THAT(empty.err,
              ContainsRegex("there is no 'town' \\(request [0-9a-f]+\\); it has no map yet"));

  const TlsFolder folder("maps: {}\n");
  folder.folder.Write("olga.crt", folder.ca.Operator("olga").certificate_pem);
  const std::string path = folder.folder.path();
  const Outcome tls =
      RunTyped({"status", "--server", address, "--tls-ca", path + "/ca.crt", "--tls-cert",
                path + "/server.crt", "--tls-key", path + "/server.key"});
  EXPECT_EQ(tls.exit_code, 3);
  EXPECT_THAT(tls.err, AllOf(StartsWith("overtone status: server localhost:"),
                             HasSubstr("it speaks no TLS there. Leave out --tls-ca")));

  server->reset();
  const Outcome gone = RunTyped({"status", "--server", address});
  EXPECT_EQ(gone.exit_code, 3);
  EXPECT_THAT(gone.err, HasSubstr("nobody listens there. Is overtone-mapping-server running?"));
  const Outcome health = RunTyped({"health", "--server", address});
  EXPECT_EQ(health.exit_code, 1);  // health checks know no other
  EXPECT_THAT(health.err, HasSubstr("nobody listens there"));
  const Outcome nowhere = RunTyped({"status", "--server", "no-such-host.invalid:1", "--insecure"});
  EXPECT_EQ(nowhere.exit_code, 3);
  EXPECT_THAT(nowhere.err, HasSubstr("there is no host of that name"));
}

// A flag says more than the environment, whichever command the environment was read for.
TEST(Environment, NamesTheServerWhereNoFlagDoes) {
  auto server = MappingServer::Start(testing::TestOptions());
  ASSERT_TRUE(server.ok()) << server.status();
  setenv("OVERTONE_SERVER", (*server)->address().c_str(), 1);
  const Outcome by_environment = RunTyped({"status"});
  const Outcome by_flag = RunTyped({"status", "--server", "localhost:1"});
  unsetenv("OVERTONE_SERVER");
  EXPECT_EQ(by_environment.exit_code, 0) << by_environment.err;
  EXPECT_EQ(by_flag.exit_code, 3);
  EXPECT_THAT(by_flag.err, HasSubstr("server localhost:1: "));
}

class TlsServerTest : public ::testing::Test {
 protected:
  TlsServerTest() : folder_("maps:\n  town: {robots: [anna], operators: [olga]}\n") {
    auto server = MappingServer::Start(folder_.Options());
    EXPECT_TRUE(server.ok()) << server.status();
    server_ = *std::move(server);
    Keep("olga", folder_.ca.Operator("olga"));
    Keep("anna", folder_.ca.Robot("anna"));
    Keep("nobody", folder_.ca.Peer({}));
  }
  void Keep(const std::string& name, const CertificateAndKey& pair) {
    folder_.folder.Write(name + ".crt", pair.certificate_pem);
    folder_.folder.Write(name + ".key", pair.key_pem);
  }
  Outcome As(const std::string& name, std::vector<std::string> arguments) {
    const std::string path = folder_.folder.path() + "/";
    arguments.insert(arguments.end(),
                     {"--server", server_->address(), "--tls-ca", path + "ca.crt", "--tls-cert",
                      path + name + ".crt", "--tls-key", path + name + ".key"});
    return RunTyped(std::move(arguments));
  }

  TlsFolder folder_;
  std::unique_ptr<MappingServer> server_;
};

TEST_F(TlsServerTest, HealthIsForAnyCertificateThatTheServerKnows) {
  for (const char* name : {"olga", "anna"}) {
    const Outcome outcome = As(name, {"health", "--json"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(nlohmann::json::parse(outcome.out).at("status"), "SERVING");
  }
  const Outcome service = As("olga", {"health", "--service", "overtone.v1.MappingService"});
  EXPECT_EQ(service.exit_code, 0) << service.err;
  EXPECT_EQ(As("olga", {"health", "--service", "no.Such"}).exit_code, 1);
}

TEST_F(TlsServerTest, WhatTheAccessRulesRefuseIsExitCodeFour) {
  EXPECT_EQ(As("olga", {"status"}).exit_code, 0);
  Outcome outcome = As("anna", {"missions", "--map", "town"});
  EXPECT_EQ(outcome.exit_code, 4);
  EXPECT_THAT(outcome.err, HasSubstr("the server's access file says who may"));
  outcome = As("nobody", {"status"});
  EXPECT_EQ(outcome.exit_code, 4);
  EXPECT_THAT(outcome.err, HasSubstr("--tls-cert must be one that the server knows"));
  EXPECT_EQ(As("nobody", {"health"}).exit_code, 1);
}

TEST_F(TlsServerTest, APlaintextClientIsToldToUseTls) {
  const Outcome outcome = RunTyped({"status", "--server", server_->address()});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("If it wants TLS, give --tls-ca, --tls-cert and"),
                                 HasSubstr("--tls-key")));
  EXPECT_THAT(outcome.out, IsEmpty());
}

TEST_F(TlsServerTest, AServerThatIsNotSignedByOurAuthorityIsNotBelieved) {
  const testing::TestAuthority other;
  folder_.folder.Write("ca.crt", other.ca_pem());
  const Outcome outcome = As("olga", {"status"});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("not signed by --tls-ca"));
}

}  // namespace
}  // namespace overtone
