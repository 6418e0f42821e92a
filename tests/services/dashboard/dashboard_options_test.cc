// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/dashboard/dashboard_options.h"

#include <functional>
#include <limits>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using ::testing::StartsWith;

TEST(DashboardOptions, DefaultsAreValid) {
  EXPECT_TRUE(DashboardOptions().Validate().ok()) << DashboardOptions().Validate();
}

TEST(DashboardOptions, EveryBadValueIsRefusedByItsFlag) {
  using Spoil = std::function<void(DashboardOptions&)>;
  const std::pair<std::string, Spoil> cases[] = {
      {"--server", [](auto& o) { o.connection.server = ""; }},
      {"--tls-ca", [](auto& o) { o.connection.server = "far.example.org:7077"; }},
      {"--tls-key",
       [](auto& o) {
         o.connection.files = {"ca.crt", "me.crt", ""};
       }},
      {"--insecure",
       [](auto& o) {
         o.connection.files = {"ca.crt", "me.crt", "me.key"};
         o.connection.insecure = true;
       }},
      {"--tls-server-name", [](auto& o) { o.connection.server_name = "maps"; }},
      {"--map", [](auto& o) { o.map = "No Map"; }},
      {"--listen", [](auto& o) { o.listen = "localhost"; }},
      {"--listen", [](auto& o) { o.listen = "localhost:99999"; }},
      {"--listen", [](auto& o) { o.listen = "0.0.0.0:8080"; }},  // all could veto
      {"--interval", [](auto& o) { o.mirror.interval = absl::ZeroDuration(); }},
      {"--max-nodes", [](auto& o) { o.mirror.max_nodes = 0; }},
      {"--history-mib", [](auto& o) { o.history_mib = 0; }},
      {"--cloud-points", [](auto& o) { o.cloud_points = 10; }},
      {"--timeout", [](auto& o) { o.timeout_s = std::numeric_limits<double>::quiet_NaN(); }},
  };
  for (const auto& [flag, spoil] : cases) {
    DashboardOptions options;
    spoil(options);
    const absl::Status status = options.Validate();
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << flag << " " << status;
    EXPECT_THAT(std::string(status.message()), StartsWith(flag));
  }
}

TEST(DashboardOptions, OtherHostsMayLookOrAreTrusted) {
  DashboardOptions options;
  options.listen = "0.0.0.0:8080";
  options.read_only = true;
  EXPECT_TRUE(options.Validate().ok());
  options.read_only = false;
  options.trust_network = true;
  EXPECT_TRUE(options.Validate().ok());
}

TEST(DashboardOptions, AddressesOfBothKindsAreParsed) {
  EXPECT_EQ(ParseListenAddress("[::1]:80")->host, "::1");
  EXPECT_EQ(ParseListenAddress("127.0.0.1:0")->port, 0);
  EXPECT_FALSE(ParseListenAddress(":80").ok());
  EXPECT_FALSE(ParseListenAddress("localhost:http").ok());
}

}  // namespace
}  // namespace overtone
