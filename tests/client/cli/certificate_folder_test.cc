// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/certificate_folder.h"

#include <sys/stat.h>

#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/core/security/certificate_io.h"
#include "overtone/tests/support/test_certificates.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;
using ::testing::StartsWith;
using testing::TemporaryFolder;

class CertificateFolderTest : public ::testing::Test {
 protected:
  CertificateFolderTest() {
    options_.folder = folder_.path() + "/certs";
    options_.robots = {"anna"};
    options_.operators = {"olga"};
  }
  absl::StatusOr<CertificateFolderChanges> Fill() {
    return FillCertificateFolder(options_, absl::Now());
  }
  std::string Fingerprint(const std::string& name) {
    const std::string base = options_.folder + "/" + name;
    const auto read = ReadCertificates({options_.folder + "/ca.crt", base + ".crt", base + ".key"});
    EXPECT_TRUE(read.ok()) << read.status();
    return read.ok() ? *CertificateFingerprint(read->certificate_pem) : "";
  }

  const TemporaryFolder folder_;
  CertificateFolderOptions options_;
};

TEST_F(CertificateFolderTest, KeysMatchAndAreReadableToTheirOwnerOnly) {
  const auto changes = Fill();
  ASSERT_TRUE(changes.ok()) << changes.status();
  EXPECT_THAT(changes->written, ElementsAre("ca.crt", "server.crt", "robot-anna.crt",
                                            "operator-olga.crt", "access.yaml"));
  for (const char* name : {"ca", "server", "robot-anna", "operator-olga"}) {
    EXPECT_NE(Fingerprint(name), "") << name;
    struct stat info = {};
    ASSERT_EQ(stat((options_.folder + "/" + name + ".key").c_str(), &info), 0);
    EXPECT_EQ(info.st_mode & 0777, 0600) << name;
  }
}

TEST_F(CertificateFolderTest, WhatIsThereIsKeptUntilForced) {
  ASSERT_TRUE(Fill().ok());
  const std::string ca = Fingerprint("ca");
  const std::string anna = Fingerprint("robot-anna");
  options_.robots = {"anna", "bert"};
  auto changes = Fill();
  ASSERT_TRUE(changes.ok()) << changes.status();
  EXPECT_THAT(changes->written, ElementsAre("robot-bert.crt"));
  EXPECT_EQ(Fingerprint("ca"), ca);
  EXPECT_EQ(Fingerprint("robot-anna"), anna);
  options_.force = true;
  ASSERT_TRUE(Fill().ok());
  EXPECT_NE(Fingerprint("ca"), ca);
  EXPECT_NE(Fingerprint("robot-anna"), anna);
}

TEST_F(CertificateFolderTest, HalfAPairIsNotCompletedSilently) {
  ASSERT_TRUE(Fill().ok());
  std::filesystem::remove(options_.folder + "/ca.key");
  EXPECT_EQ(Fill().status().code(), absl::StatusCode::kFailedPrecondition);
}

TEST_F(CertificateFolderTest, NamesThatCannotBeOnesAreRefusedByFlag) {
  const auto refused = [this](const char* flag) {
    const absl::Status status = Fill().status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << flag;
    EXPECT_THAT(std::string(status.message()), StartsWith(flag));
    options_ = CertificateFolderOptions();
    options_.folder = folder_.path() + "/certs";
  };
  options_.robots = {"../anna"};
  refused("--robot");
  options_.operators = {"Olga"};
  refused("--operator");
  options_.server_names = {"localhost,URI:spiffe://x/robot/anna"};
  refused("--server-name");
  options_.trust_domain = "a/b";
  refused("--trust-domain");
  options_.map = "";
  refused("--map");
  options_.days = 0;
  refused("--days");
  EXPECT_FALSE(std::filesystem::exists(options_.folder));
}

}  // namespace
}  // namespace overtone
