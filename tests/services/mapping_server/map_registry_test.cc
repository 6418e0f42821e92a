// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/map_registry.h"

#include "gtest/gtest.h"

namespace overtone {
namespace {

ServerOptions TestOptions() {
  ServerOptions options;
  options.data_dir = ":memory:";
  return options;
}

// A store's last answers come after the streams have ended.
TEST(MapRegistry, AMapWhoseFirstSubmapIsStoredWhileTheServerEndsIsClosed) {
  MapRegistry registry(TestOptions());
  ASSERT_TRUE(registry.Open().ok());
  {
    const auto map = registry.Acquire("town");
    ASSERT_TRUE(map.ok()) << map.status();
    registry.Stop();
    registry.Keep(*map);
  }
  EXPECT_TRUE(registry.List().empty());
}

TEST(MapRegistry, OthersFindAMapOnceItIsKept) {
  MapRegistry registry(TestOptions());
  ASSERT_TRUE(registry.Open().ok());
  const auto map = registry.Acquire("town");
  ASSERT_TRUE(map.ok()) << map.status();
  EXPECT_EQ(registry.Find("town").status().code(), absl::StatusCode::kNotFound);
  registry.Keep(*map);
  ASSERT_TRUE(registry.Find("town").ok());
  EXPECT_EQ(*registry.Find("town"), *map);
}

}  // namespace
}  // namespace overtone
