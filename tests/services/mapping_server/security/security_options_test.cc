// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/security/security_options.h"

#include <cmath>
#include <functional>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

SecurityOptions Tls() {
  SecurityOptions options;
  options.files = {"ca.crt", "server.crt", "server.key"};
  options.access_file = "access.yaml";
  return options;
}

TEST(SecurityOptions, WithoutTlsOthersMustNotReachUsUnlessWeSaySo) {
  SecurityOptions options;
  EXPECT_TRUE(options.Validate("localhost:7077").ok());
  EXPECT_TRUE(options.Validate("[::1]:0").ok());
  const absl::Status refused = options.Validate("0.0.0.0:7077");
  EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(refused.message()),
              AllOf(StartsWith("listen: "), HasSubstr("tls.ca_file"), HasSubstr("access_file"),
                    HasSubstr("--insecure")));
  options.insecure = true;
  EXPECT_TRUE(options.Validate("0.0.0.0:7077").ok());
}

TEST(SecurityOptions, TlsNeedsAllItsFilesAndAccessRules) {
  EXPECT_TRUE(Tls().Validate("0.0.0.0:7077").ok());
  const std::pair<std::string, std::function<void(SecurityOptions&)>> cases[] = {
      {"tls.ca_file: ", [](auto& o) { o.files.ca_file.clear(); }},
      {"tls.certificate_file: ", [](auto& o) { o.files.certificate_file.clear(); }},
      {"tls.key_file: ", [](auto& o) { o.files.key_file.clear(); }},
      {"access_file: missing", [](auto& o) { o.access_file.clear(); }},
      {"access_file: needs tls", [](auto& o) { o.files = {}; }},
      {"insecure: ", [](auto& o) { o.insecure = true; }},
      {"tls.reload_s: ", [](auto& o) { o.reload_s = 0; }},
      {"tls.reload_s: ", [](auto& o) { o.reload_s = std::nan(""); }},
  };
  for (const auto& [error, change] : cases) {
    SecurityOptions options = Tls();
    change(options);
    const absl::Status status = options.Validate("localhost:7077");
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << error;
    EXPECT_THAT(std::string(status.message()), StartsWith(error));
  }
}

}  // namespace
}  // namespace overtone
