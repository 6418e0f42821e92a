// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/security/loopback_address.h"

#include "gtest/gtest.h"

namespace overtone {
namespace {

TEST(LoopbackAddress, OnlyWhatCannotLeaveThisHostCounts) {
  for (const char* address :
       {"localhost:7077", "LOCALHOST:1", "127.0.0.1:0", "127.255.3.4:7077", "[::1]:7077", "::1",
        "localhost", "dns:///localhost:7077", "dns:localhost:7077", "ipv4:127.0.0.1:7077",
        "ipv6:[::1]:7077", "unix:/run/overtone.sock", "unix-abstract:overtone"}) {
    EXPECT_TRUE(IsLoopback(address)) << address;
  }
  for (const char* address :
       {"", "0.0.0.0:7077", "[::]:7077", "10.0.0.1:7077", "128.0.0.1:1", "localhost.example.org:1",
        "127.0.0.1.example.org:1", "notlocalhost:1", "127.1:1", "dns:///map.example.org:7077",
        "[fe80::1]:7077", "ipv4:192.168.0.1:7077"}) {
    EXPECT_FALSE(IsLoopback(address)) << address;
  }
}

}  // namespace
}  // namespace overtone
