// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/security/server_security.h"

#include <functional>
#include <string>
#include <utility>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/tests/support/test_certificates.h"

namespace overtone {
namespace {

using ::testing::StartsWith;
using testing::TemporaryFolder;
using testing::TestAuthority;

class ServerSecurityTest : public ::testing::Test {
 protected:
  ServerSecurityTest() {
    Write(ca_.Server());
    options_.files.ca_file = folder_.Write("ca.crt", ca_.ca_pem());
    options_.access_file = folder_.Write("access.yaml", "maps: {town: {robots: [anna]}}\n");
  }
  void Write(const CertificateAndKey& pair) {
    options_.files.certificate_file = folder_.Write("server.crt", pair.certificate_pem);
    options_.files.key_file = folder_.Write("server.key", pair.key_pem);
  }
  PeerCertificate Robot(const std::string& id) {
    const std::string uri = "spiffe://test/robot/" + id;
    return {{{uri}, {}}, ca_.Peer({uri}).certificate_pem};
  }

  const TemporaryFolder folder_;
  const TestAuthority ca_;
  SecurityOptions options_;
};

TEST_F(ServerSecurityTest, FilesThatCannotServeAreRefusedByName) {
  const std::string other_key = ca_.Server().key_pem;
  const std::pair<std::string, std::function<void()>> cases[] = {
      {"tls.ca_file: ", [&] { options_.files.ca_file = "/nowhere/ca.crt"; }},
      {"tls.ca_file: ", [&] { folder_.Write("ca.crt", "not PEM"); }},
      {"tls.certificate_file: ", [&] { folder_.Write("server.crt", ""); }},
      {"tls.certificate_file: ", [&] { folder_.Write("server.crt", other_key); }},
      {"tls.key_file: ", [&] { folder_.Write("server.key", "not PEM"); }},
      {"tls.key_file: ", [&] { folder_.Write("server.key", other_key); }},
      {"access_file: ", [&] { options_.access_file = "/nowhere/access.yaml"; }},
      {"access_file: ", [&] { folder_.Write("access.yaml", "maps: 3\n"); }},
  };
  const SecurityOptions good = options_;
  const CertificateAndKey server = ca_.Server();
  for (const auto& [error, spoil] : cases) {
    options_ = good;
    Write(server);
    folder_.Write("ca.crt", ca_.ca_pem());
    folder_.Write("access.yaml", "");
    ASSERT_TRUE(ServerSecurity::Create(options_).ok());
    spoil();
    const absl::Status status = ServerSecurity::Create(options_).status();
    EXPECT_THAT(std::string(status.message()), StartsWith(error)) << status;
  }
}

TEST_F(ServerSecurityTest, ABadAccessFileLeavesTheOldRulesInForce) {
  auto security = ServerSecurity::Create(options_);
  ASSERT_TRUE(security.ok()) << security.status();
  AccessControl& access = *(*security)->access();
  EXPECT_TRUE(access.MayRead(Robot("anna"), "town").ok());
  folder_.Write("access.yaml", "maps: {town: {robots: [bert]}}\nmap: {}\n");
  (*security)->Reload();
  EXPECT_TRUE(access.MayRead(Robot("anna"), "town").ok());
  EXPECT_FALSE(access.MayRead(Robot("bert"), "town").ok());
  folder_.Write("access.yaml", "maps: {town: {robots: [bert]}}\n");
  (*security)->Reload();
  EXPECT_FALSE(access.MayRead(Robot("anna"), "town").ok());
  EXPECT_TRUE(access.MayRead(Robot("bert"), "town").ok());
}

TEST_F(ServerSecurityTest, FilesAreLookedAtWithoutBeingAsked) {
  options_.reload_s = 0.05;
  auto security = ServerSecurity::Create(options_);
  ASSERT_TRUE(security.ok()) << security.status();
  AccessControl& access = *(*security)->access();
  absl::Mutex mutex;
  bool ended = false;
  AccessControl::Lease lease;
  const absl::Status held = access.Hold([&] { return access.MayRead(Robot("anna"), "town"); },
                                        [&](const absl::Status& status) {
                                          EXPECT_TRUE(absl::IsUnauthenticated(status)) << status;
                                          absl::MutexLock lock(&mutex);
                                          ended = true;
                                        },
                                        lease);
  ASSERT_TRUE(held.ok()) << held;
  folder_.Write("access.yaml", "maps: {town: {robots: [anna]}}\nrevoked: [robot/anna]\n");
  absl::MutexLock lock(&mutex);
  EXPECT_TRUE(mutex.AwaitWithTimeout(absl::Condition(&ended), absl::Seconds(30)));
}

TEST_F(ServerSecurityTest, ARevokedFingerprintIsOneCertificateNotItsName) {
  const PeerCertificate stolen = Robot("anna");
  const PeerCertificate replacement = Robot("anna");
  folder_.Write("access.yaml", absl::StrCat("maps: {town: {robots: [anna]}}\nrevoked: [\"sha256:",
                                            *CertificateFingerprint(stolen.pem), "\"]\n"));
  auto security = ServerSecurity::Create(options_);
  ASSERT_TRUE(security.ok()) << security.status();
  EXPECT_TRUE(absl::IsUnauthenticated((*security)->access()->MayRead(stolen, "town")));
  EXPECT_TRUE((*security)->access()->MayRead(replacement, "town").ok());
}

}  // namespace
}  // namespace overtone
