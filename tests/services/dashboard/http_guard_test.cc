// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/dashboard/http_guard.h"

#include "gtest/gtest.h"

namespace overtone {
namespace {

TEST(HttpGuard, TakesTheNameWithoutPortAndBrackets) {
  EXPECT_EQ(HostName("localhost:8080"), "localhost");
  EXPECT_EQ(HostName("LocalHost"), "localhost");
  EXPECT_EQ(HostName("[::1]:8080"), "::1");
  EXPECT_EQ(HostName("[::1]"), "::1");
  EXPECT_EQ(HostName("10.0.0.7:80"), "10.0.0.7");
  EXPECT_EQ(HostName(""), "");
  EXPECT_EQ(HostName("["), "[");
}

TEST(HttpGuard, KnowsLocalhostAddressesAndTheNamesItWasGiven) {
  const HttpGuard guard({"maps.example.org"});
  for (const char* host : {"localhost:8080", "127.0.0.1:1", "[::1]:8080", "192.168.1.20",
                           "[fe80::1]", "maps.example.org", "Maps.Example.ORG:443"}) {
    EXPECT_TRUE(guard.IsOurHost(host)) << host;
  }
  // Names that somebody else may point at this address.
  for (const char* host : {"", "evil.example.org", "localhost.evil.org", "127.0.0.1.evil.org",
                           "maps.example.org.evil.org", "1.2.3.4.5", "[::1].evil.org"}) {
    EXPECT_FALSE(guard.IsOurHost(host)) << host;
  }
}

TEST(HttpGuard, ARequestThatChangesSomethingMustComeFromOurPage) {
  const HttpGuard guard({});
  const char host[] = "localhost:8080";
  EXPECT_TRUE(guard.IsOurPage(host, "http://localhost:8080", "same-origin", "1"));
  EXPECT_TRUE(guard.IsOurPage(host, "https://localhost:8080", "same-origin", "1"));
  EXPECT_TRUE(guard.IsOurPage(host, "", "", "1"));  // a tool, not a browser
  EXPECT_FALSE(guard.IsOurPage(host, "http://localhost:8080", "same-origin", ""));
  EXPECT_FALSE(guard.IsOurPage(host, "http://evil.example.org", "", "1"));
  EXPECT_FALSE(guard.IsOurPage(host, "http://localhost:9090", "", "1"));
  EXPECT_FALSE(guard.IsOurPage(host, "null", "", "1"));
  EXPECT_FALSE(guard.IsOurPage(host, "", "cross-site", "1"));
  EXPECT_FALSE(guard.IsOurPage(host, "", "same-site", "1"));
  EXPECT_FALSE(guard.IsOurPage("evil.example.org", "http://evil.example.org", "same-origin", "1"));
}

}  // namespace
}  // namespace overtone
