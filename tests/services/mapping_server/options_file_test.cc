// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/options_file.h"

#include <fstream>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;

std::string Write(const std::string& text) {
  const std::string path = ::testing::TempDir() + "/options.yaml";
  std::ofstream(path) << text;
  return path;
}

TEST(OptionsFile, TheDefaultsAreValid) {
  const absl::Status status = ServerOptions().Validate();
  EXPECT_TRUE(status.ok()) << status;
}

// Every key of the documented file exists, and its value is the default: spoiling an option
// beforehand shows that the file sets it back.
TEST(OptionsFile, TheDocumentedFileHoldsTheDefaults) {
  ServerOptions options;
  options.listen = "elsewhere:1";
  options.limits.max_maps = 7;
  options.limits.max_blob_bytes = 5;
  options.limits.max_stored_blob_bytes = 5;
  options.publisher.units.stamp_ns = 5;
  options.publisher.tolerance.rotation_rad = 0.2;
  options.graph.radius_graph.sigma = 9;
  options.map.robust = MultiRobotMapOptions::Robust::kNone;
  const absl::Status status = ReadOptionsFile(
      std::string(OVERTONE_SOURCE_DIR) + "/services/mapping_server/configs/default.yaml", options);
  ASSERT_TRUE(status.ok()) << status;
  const ServerOptions defaults;
  EXPECT_EQ(options.listen, defaults.listen);
  EXPECT_EQ(options.limits.max_maps, defaults.limits.max_maps);
  EXPECT_EQ(options.limits.max_blob_bytes, defaults.limits.max_blob_bytes);
  EXPECT_EQ(options.limits.max_stored_blob_bytes, defaults.limits.max_stored_blob_bytes);
  EXPECT_EQ(options.publisher.units.stamp_ns, defaults.publisher.units.stamp_ns);
  EXPECT_EQ(options.publisher.tolerance.rotation_rad, defaults.publisher.tolerance.rotation_rad);
  EXPECT_EQ(options.graph.max_nodes, defaults.graph.max_nodes);
  EXPECT_EQ(options.graph.radius_graph.sigma, defaults.graph.radius_graph.sigma);
  EXPECT_EQ(options.map.robust, defaults.map.robust);
}

TEST(OptionsFile, MistakesAreNamedWithTheirLine) {
  const struct {
    std::string text;
    std::string message;
  } cases[] = {
      {"graph:\n  max_node: 5\n",
       ":2: unknown key 'graph.max_node'; did you mean 'graph.max_nodes'?"},
      {"lissten: a:1\n", ":1: unknown key 'lissten'; did you mean 'listen'?"},
      {"\nlimits:\n  max_maps: many\n", ":3: limits.max_maps has a value of the wrong type"},
      {"listen: [a, b]\n", ":1: listen has a value of the wrong type"},
      {"map:\n  robust: always\n", ":2: map.robust has a value of the wrong type"},
      {"listen: a:1\nlisten: b:2\n", ":2: listen is given twice"},
      {"graph: 3\n", ":1: unknown key 'graph'"},
      {"\nlisten: a: b\n", "options.yaml:2: "},
      {"- listen\n", ":1: not a mapping"},
  };
  for (const auto& bad : cases) {
    ServerOptions options;
    const absl::Status status = ReadOptionsFile(Write(bad.text), options);
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << bad.text;
    EXPECT_THAT(std::string(status.message()), HasSubstr(bad.message));
  }
  ServerOptions options;
  EXPECT_EQ(ReadOptionsFile("/nowhere.yaml", options).code(), absl::StatusCode::kNotFound);
  EXPECT_TRUE(ReadOptionsFile(Write(""), options).ok());
}

}  // namespace
}  // namespace overtone
