// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/health_probe/health_check.h"

#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "grpcpp/generic/async_generic_service.h"
#include "grpcpp/health_check_service_interface.h"
#include "grpcpp/security/server_credentials.h"
#include "grpcpp/server.h"
#include "grpcpp/server_builder.h"
#include "gtest/gtest.h"
#include "overtone/tests/support/test_certificates.h"

namespace overtone {
namespace {

using testing::TemporaryFolder;
using testing::TestAuthority;

// A server with gRPC's own health service, and one that makes it poll.
class HealthServer {
 public:
  explicit HealthServer(const std::shared_ptr<grpc::ServerCredentials>& credentials) {
    grpc::EnableDefaultHealthCheckService(true);
    grpc::ServerBuilder builder;
    builder.AddListeningPort("localhost:0", credentials, &port_);
    builder.RegisterCallbackGenericService(&nothing_);
    server_ = builder.BuildAndStart();
  }

  grpc::HealthCheckServiceInterface* health() { return server_->GetHealthCheckService(); }
  std::string address() const { return absl::StrCat("localhost:", port_); }
  void Stop() { server_->Shutdown(); }

 private:
  int port_ = 0;
  grpc::CallbackGenericService nothing_;
  std::unique_ptr<grpc::Server> server_;
};

HealthCheckOptions Ask(const HealthServer& server, const std::string& service = "") {
  HealthCheckOptions options;
  options.server = server.address();
  options.service = service;
  options.timeout = absl::Seconds(20);
  return options;
}

TEST(HealthCheck, SaysWhatTheServerSaysOfEachService) {
  HealthServer server(grpc::InsecureServerCredentials());
  server.health()->SetServingStatus("up", true);
  server.health()->SetServingStatus("down", false);
  EXPECT_TRUE(CheckHealth(Ask(server)).ok());
  EXPECT_TRUE(CheckHealth(Ask(server, "up")).ok());
  EXPECT_TRUE(absl::IsUnavailable(CheckHealth(Ask(server, "down"))));
  EXPECT_TRUE(absl::IsNotFound(CheckHealth(Ask(server, "unheard of"))));
  server.health()->Shutdown();
  EXPECT_TRUE(absl::IsUnavailable(CheckHealth(Ask(server, "up"))));
}

TEST(HealthCheck, IsUnavailableWhereNobodyListens) {
  HealthServer server(grpc::InsecureServerCredentials());
  const HealthCheckOptions options = Ask(server);
  server.Stop();
  EXPECT_TRUE(absl::IsUnavailable(CheckHealth(options)));
}

class HealthCheckOverTls : public ::testing::Test {
 protected:
  HealthCheckOverTls() : server_(Credentials()) {
    const CertificateAndKey peer = authority_.Peer({"spiffe://test/operator/probe"});
    options_ = Ask(server_);
    options_.tls = {folder_.Write("ca.crt", authority_.ca_pem()),
                    folder_.Write("probe.crt", peer.certificate_pem),
                    folder_.Write("probe.key", peer.key_pem)};
  }

  std::shared_ptr<grpc::ServerCredentials> Credentials() const {
    const CertificateAndKey own = authority_.Server();
    grpc::SslServerCredentialsOptions options(
        GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY);
    options.pem_root_certs = authority_.ca_pem();
    options.pem_key_cert_pairs.push_back({own.key_pem, own.certificate_pem});
    return grpc::SslServerCredentials(options);
  }

  TemporaryFolder folder_;
  TestAuthority authority_;
  HealthServer server_;
  HealthCheckOptions options_;
};

TEST_F(HealthCheckOverTls, AsksWithACertificateOfTheServersCa) {
  EXPECT_TRUE(CheckHealth(options_).ok()) << CheckHealth(options_);
}

TEST_F(HealthCheckOverTls, IsRefusedWithoutACertificate) {
  options_.tls = {};
  EXPECT_TRUE(absl::IsUnavailable(CheckHealth(options_)));
}

TEST_F(HealthCheckOverTls, TrustsNoServerOfAnotherCa) {
  options_.tls.ca_file = folder_.Write("other.crt", TestAuthority().ca_pem());
  EXPECT_TRUE(absl::IsUnavailable(CheckHealth(options_)));
}

TEST_F(HealthCheckOverTls, ReachesTheServerUnderAnotherName) {
  options_.server = absl::StrReplaceAll(options_.server, {{"localhost", "127.0.0.1"}});
  EXPECT_TRUE(absl::IsUnavailable(CheckHealth(options_)));
  options_.server_name = "localhost";
  EXPECT_TRUE(CheckHealth(options_).ok());
}

TEST_F(HealthCheckOverTls, NamesTheFileThatCannotBeRead) {
  options_.tls.key_file = folder_.path() + "/missing.key";
  const absl::Status status = CheckHealth(options_);
  EXPECT_TRUE(absl::IsNotFound(status));
  EXPECT_NE(status.message().find("key_file"), std::string::npos) << status;
}

}  // namespace
}  // namespace overtone
