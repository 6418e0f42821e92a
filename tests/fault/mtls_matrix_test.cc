// SPDX-License-Identifier: Apache-2.0
// Who knocks with what, and what comes of it, as a table. A handshake that fails is UNAVAILABLE to
// whoever knocks: TLS tells no more.
#include <algorithm>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gtest/gtest.h"
#include "overtone/client/mapping_client.h"
#include "overtone/core/security/certificate_io.h"
#include "overtone/proto/conversion/status_conversion.h"
#include "overtone/tests/services/mapping_server/tls_fixture.h"
#include "overtone/tests/support/fake_host.h"
#include "overtone/tests/support/fault_table.h"

namespace overtone {
namespace {

using absl::StatusCode;
using testing::Connect;
using testing::TestAuthority;
using testing::TlsFolder;
using testing::Watcher;
using testing::WatchRequest;

const char kAccess[] = "maps:\n  town: {robots: [anna, bert], operators: [olga]}\n";

class MtlsMatrixTest : public ::testing::Test {
 protected:
  MtlsMatrixTest() : folder_(kAccess) { Start(folder_.Options()); }
  static void TearDownTestSuite() {
    std::cout << absl::StrFormat("\n%-62s %-19s %s\n", "peer", "code", "in its words");
    for (const std::string& row : Table()) std::cout << row << "\n";
  }

  void Start(const ServerOptions& options) {
    auto server = MappingServer::Start(options);
    ASSERT_TRUE(server.ok()) << server.status();
    server_ = *std::move(server);
  }

  static std::vector<std::string>& Table() {
    static auto* const rows = new std::vector<std::string>;
    return *rows;
  }
  // A row of the table, and whether it is as it should be.
  static void Expect(const std::string& peer, StatusCode expected, const absl::Status& status) {
    Table().push_back(absl::StrFormat("%-62s %-19s %.90s", peer, StatusCodeToString(status.code()),
                                      status.message()));
    FaultRow("mtls", peer, StatusCodeToString(status.code()));
    EXPECT_EQ(status.code(), expected) << peer << ": " << status;
  }

  // Asks how anna's upload to the map stands.
  absl::Status Ask(const std::shared_ptr<grpc::Channel>& channel,
                   const std::string& map = "town") const {
    v1::GetUploadStateRequest request;
    request.set_map(map);
    request.mutable_mission()->set_robot("anna");
    request.mutable_mission()->set_mission("run1");
    v1::GetUploadStateResponse response;
    grpc::ClientContext context;
    context.set_deadline(testing::Deadline());
    return FromGrpcStatus(
        v1::MappingService::NewStub(channel)->GetUploadState(&context, request, &response));
  }
  // On a new connection.
  absl::Status Knock(const CertificateAndKey& certificate) const {
    return Ask(Connect(server_->address(), folder_.ca.ca_pem(), certificate));
  }

  TlsFolder folder_;
  std::unique_ptr<MappingServer> server_;
};

TEST_F(MtlsMatrixTest, CertificatesThatTheServerCannotVerify) {
  CertificateRequest request = TestAuthority::ValidNow();
  request.uris = {"spiffe://test/robot/anna"};
  Expect("robot anna", StatusCode::kOk, Knock(folder_.ca.Issue(request)));
  Expect("no certificate", StatusCode::kUnavailable, Knock({}));
  Expect("anna's name, by another CA", StatusCode::kUnavailable,
         Knock(TestAuthority().Issue(request)));
  request.not_before = absl::Now() - absl::Hours(2);
  request.not_after = absl::Now() - absl::Hours(1);
  Expect("expired an hour ago", StatusCode::kUnavailable, Knock(folder_.ca.Issue(request)));
  request.not_before = absl::Now() + absl::Hours(1);
  request.not_after = absl::Now() + absl::Hours(2);
  Expect("not valid for an hour yet", StatusCode::kUnavailable, Knock(folder_.ca.Issue(request)));
  request = TestAuthority::ValidNow();
  request.uris = {"spiffe://test/robot/anna"};
  request.use = CertificateUse::kServer;
  Expect("a certificate for servers", StatusCode::kUnavailable, Knock(folder_.ca.Issue(request)));
}

TEST_F(MtlsMatrixTest, ServersThatThePeerCannotVerify) {
  const CertificateAndKey anna = folder_.ca.Robot("anna");
  const std::string& address = server_->address();
  Expect("peer that trusts another CA", StatusCode::kUnavailable,
         Ask(Connect(address, TestAuthority().ca_pem(), anna)));
  Expect("peer that expects another server name", StatusCode::kUnavailable,
         Ask(Connect(address, folder_.ca.ca_pem(), anna, "map.example.org")));
}

TEST_F(MtlsMatrixTest, VerifiedNamesThatAreNotWhatTheyShouldBe) {
  const TestAuthority& ca = folder_.ca;
  Expect("no identity among its names", StatusCode::kUnauthenticated, Knock(ca.Peer({}, {"anna"})));
  Expect("two identities", StatusCode::kUnauthenticated,
         Knock(ca.Peer({"spiffe://test/robot/anna", "spiffe://test/robot/bert"})));
  Expect("DNS identity, not accepted by option", StatusCode::kUnauthenticated,
         Knock(ca.Peer({}, {"anna.robot.test"})));
  Expect("another robot's name", StatusCode::kPermissionDenied, Knock(ca.Robot("bert")));
  Expect("a robot that is granted no map", StatusCode::kPermissionDenied, Knock(ca.Robot("carl")));
  Expect("anna, but for a map of others", StatusCode::kPermissionDenied,
         Ask(Connect(server_->address(), ca.ca_pem(), ca.Robot("anna")), "park"));
  ServerOptions options = folder_.Options();
  options.security.accept_dns_names = true;
  Start(options);
  Expect("DNS identity, accepted by option", StatusCode::kOk,
         Knock(ca.Peer({}, {"anna.robot.test"})));
}

TEST_F(MtlsMatrixTest, PlaintextAndTlsDoNotMeet) {
  const auto plain = grpc::InsecureChannelCredentials();
  Expect("plaintext to a TLS port", StatusCode::kUnavailable,
         Ask(grpc::CreateChannel(server_->address(), plain)));
  Start(testing::TestOptions());
  Expect("TLS to a plaintext port", StatusCode::kUnavailable, Knock(folder_.ca.Robot("anna")));
}

TEST_F(MtlsMatrixTest, ARevocationEndsWhatIsOpenAndRefusesWhatComes) {
  const CertificateAndKey anna = folder_.ca.Robot("anna");
  const auto channel = Connect(server_->address(), folder_.ca.ca_pem(), anna);
  const auto stub = v1::MappingService::NewStub(channel);
  testing::Uploader upload(*stub, "town", {"anna", "run1"});
  ASSERT_TRUE(upload.Read().has_ready());
  Watcher watch(*stub, WatchRequest("town"));
  v1::WatchGraphResponse frame;
  ASSERT_TRUE(watch.Read(frame));

  folder_.WriteAccess(absl::StrCat(kAccess, "revoked: [robot/anna]\n"));
  server_->ReloadSecurity();
  Expect("robot revoked by reload, its open upload", StatusCode::kUnauthenticated,
         FromGrpcStatus(upload.End()));
  Expect("robot revoked by reload, its open watch", StatusCode::kUnauthenticated,
         FromGrpcStatus(watch.Finish()));
  Expect("robot revoked by reload, next call", StatusCode::kUnauthenticated, Ask(channel));
  Expect("robot revoked by reload, new connection", StatusCode::kUnauthenticated, Knock(anna));

  folder_.WriteAccess(absl::StrCat(
      kAccess, "revoked: [\"sha256:", *CertificateFingerprint(anna.certificate_pem), "\"]\n"));
  server_->ReloadSecurity();
  Expect("certificate revoked by fingerprint", StatusCode::kUnauthenticated, Knock(anna));
  Expect("a new certificate of that robot", StatusCode::kOk, Knock(folder_.ca.Robot("anna")));
}

TEST_F(MtlsMatrixTest, AGrantTakenAwayEndsWhatIsOpen) {
  const auto stub = v1::MappingService::NewStub(
      Connect(server_->address(), folder_.ca.ca_pem(), folder_.ca.Robot("anna")));
  Watcher watch(*stub, WatchRequest("town"));
  v1::WatchGraphResponse frame;
  ASSERT_TRUE(watch.Read(frame));
  folder_.WriteAccess("maps: {town: {robots: [bert]}}\n");
  server_->ReloadSecurity();
  Expect("grant taken away, its open watch", StatusCode::kPermissionDenied,
         FromGrpcStatus(watch.Finish()));
}

TEST_F(MtlsMatrixTest, ServerCertificatesRotateWhileAStreamIsUp) {
  const CertificateAndKey anna = folder_.ca.Robot("anna");
  const auto stub =
      v1::MappingService::NewStub(Connect(server_->address(), folder_.ca.ca_pem(), anna));
  Watcher watch(*stub, WatchRequest("town"));
  v1::WatchGraphResponse frame;
  ASSERT_TRUE(watch.Read(frame));

  const TestAuthority next;
  // Half of it, as if somebody were still copying: the old ones go on.
  folder_.folder.Write("server.crt", next.Server().certificate_pem);
  server_->ReloadSecurity();
  Expect("half-written server files, old certificate", StatusCode::kOk, Knock(anna));

  folder_.WriteCertificates(next.ca_pem(), next.Server());
  server_->ReloadSecurity();
  Expect("server and CA rotated, new certificate", StatusCode::kOk,
         Ask(Connect(server_->address(), next.ca_pem(), next.Robot("anna"))));
  Expect("server and CA rotated, old certificate", StatusCode::kUnavailable, Knock(anna));
  // Heartbeats every 50 ms: frames that were on their way do not count.
  bool alive = true;
  for (int i = 0; i < 20; ++i) alive = watch.Read(frame) && alive;
  Expect("server and CA rotated, stream from before", StatusCode::kOk,
         alive ? absl::OkStatus() : FromGrpcStatus(watch.Finish()));
}

class ClientLibraryTest : public MtlsMatrixTest {
 protected:
  void Write(const CertificateAndKey& robot, const std::string& ca_pem) {
    folder_.folder.Write("robot-ca.crt", ca_pem);
    folder_.folder.Write("robot.crt", robot.certificate_pem);
    folder_.folder.Write("robot.key", robot.key_pem);
  }
  void StartClient(const std::string& robot) {
    Write(folder_.ca.Robot(robot), folder_.ca.ca_pem());
    MappingClientOptions options;
    options.server = server_->address();
    options.map = "town";
    options.mission = {robot, "run1"};
    const std::string& path = folder_.folder.path();
    options.tls.ca_file = path + "/robot-ca.crt";
    options.tls.certificate_file = path + "/robot.crt";
    options.tls.key_file = path + "/robot.key";
    options.tls.reload_every = absl::Seconds(1);
    options.max_backoff = absl::Milliseconds(500);
    auto client = MappingClient::Create(options, &host_);
    ASSERT_TRUE(client.ok()) << client.status();
    client_ = *std::move(client);
  }
  // Ok once the host has been told so, `times` times in all.
  absl::Status Await(LinkState state, int times) {
    const auto told = [&] {
      host_.mutex.AssertHeld();
      return std::count(host_.link_states.begin(), host_.link_states.end(), state) >= times;
    };
    return host_.Await(told) ? absl::OkStatus() : absl::DeadlineExceededError("not told");
  }

  FakeHost host_;
  std::unique_ptr<MappingClient> client_;
};

TEST_F(ClientLibraryTest, CertificatesRotateWhileItRuns) {
  ServerOptions options = folder_.Options();
  options.data_dir = folder_.folder.path() + "/data";  // the mission goes on after the restart
  Start(options);
  StartClient("anna");
  ASSERT_TRUE(client_->AddSubmap(testing::MakeSubmap(0, 0, 3)).ok());
  Expect("client library: submap acknowledged", StatusCode::kOk,
         client_->WaitUntilAcknowledged(absl::Seconds(30)));

  const TestAuthority next;
  Write(next.Robot("anna"), next.ca_pem());
  folder_.WriteCertificates(next.ca_pem(), next.Server());
  server_->ReloadSecurity();
  ASSERT_TRUE(client_->AddSubmap(testing::MakeSubmap(1, 3, 3)).ok());
  Expect("client library: both ends rotated, stream from before", StatusCode::kOk,
         client_->WaitUntilAcknowledged(absl::Seconds(30)));

  // The server that comes back knows the new CA only: what the client shows then must be new. It
  // may be back so soon that the host is not told.
  options.listen = server_->address();
  server_.reset();
  Start(options);
  ASSERT_TRUE(client_->AddSubmap(testing::MakeSubmap(2, 6, 3)).ok());
  Expect("client library: both ends rotated, reconnected", StatusCode::kOk,
         client_->WaitUntilAcknowledged(absl::Seconds(30)));
}

TEST_F(ClientLibraryTest, ARefusalReachesTheHostAndEndsWhenAccessIsGranted) {
  StartClient("carl");
  ASSERT_TRUE(client_->AddSubmap(testing::MakeSubmap(0, 0, 3)).ok());
  Expect("client library: not granted, host told kRefused", StatusCode::kOk,
         Await(LinkState::kRefused, 1));
  EXPECT_FALSE(client_->WaitUntilAcknowledged(absl::ZeroDuration()).ok());
  folder_.WriteAccess("maps: {town: {robots: [carl]}}\n");
  server_->ReloadSecurity();
  Expect("client library: granted by reload, nothing was lost", StatusCode::kOk,
         client_->WaitUntilAcknowledged(absl::Seconds(30)));
  EXPECT_TRUE(Await(LinkState::kLive, 1).ok());
}

TEST_F(ClientLibraryTest, FilesThatCannotServeAreRefusedByName) {
  StartClient("anna");
  MappingClientOptions options;
  options.server = server_->address();
  options.mission = {"anna", "run2"};
  options.tls.ca_file = folder_.folder.path() + "/robot-ca.crt";
  options.tls.certificate_file = folder_.folder.path() + "/robot.crt";
  options.tls.key_file = folder_.folder.Write("bert.key", folder_.ca.Robot("bert").key_pem);
  const absl::Status status = MappingClient::Create(options, &host_).status();
  EXPECT_EQ(status.message().substr(0, 14), "tls.key_file: ") << status;
}

}  // namespace
}  // namespace overtone
