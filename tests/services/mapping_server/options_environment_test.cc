// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/options_environment.h"

#include <set>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;

absl::Status Read(const std::vector<std::string>& environment, ServerOptions* options = nullptr,
                  OptionSources* sources = nullptr) {
  ServerOptions own_options;
  OptionSources own_sources;
  return ReadOptionsEnvironment(environment, options == nullptr ? own_options : *options,
                                sources == nullptr ? own_sources : *sources);
}

// Two keys of one name would hide each other; one that looks like a variable of Kubernetes would
// still be read, but its typing mistakes passed over.
TEST(OptionsEnvironment, EveryOptionHasANameOfItsOwn) {
  std::set<std::string> names;
  for (const std::string& key : OptionKeys()) names.insert(EnvironmentName(key));
  EXPECT_EQ(names.size(), OptionKeys().size());
  EXPECT_EQ(EnvironmentName("quotas.max_streams"), "OVERTONE_QUOTAS_MAX_STREAMS");
  EXPECT_EQ(EnvironmentName("data_dir"), "OVERTONE_DATA_DIR");
}

TEST(OptionsEnvironment, EveryOptionCanBeSet) {
  ServerOptions defaults;
  std::vector<std::string> environment;
  for (const Option& option : OptionTable(defaults)) {
    environment.push_back(EnvironmentName(option.key) + "=" + option.get());
  }
  ServerOptions options;
  OptionSources sources;
  const absl::Status status = Read(environment, &options, &sources);
  EXPECT_TRUE(status.ok()) << status;
  EXPECT_EQ(sources.size(), OptionKeys().size());
  EXPECT_EQ(OptionValues(options), OptionValues(defaults));
}

TEST(OptionsEnvironment, ValuesAreTakenAsTheyStand) {
  ServerOptions options;
  OptionSources sources;
  const absl::Status status =
      Read({"OVERTONE_QUOTAS_MAX_STREAMS=7", "OVERTONE_DATA_DIR=/a b=c",
            "OVERTONE_METRICS_LISTEN=", "OVERTONE_MAP_ROBUST=huber", "OVERTONE_REFLECTION=false",
            "OVERTONE_INSECURE=1", "PATH=/bin", "HOME"},
           &options, &sources);
  ASSERT_TRUE(status.ok()) << status;
  EXPECT_EQ(options.quotas.max_streams, 7);
  EXPECT_EQ(options.data_dir, "/a b=c");
  EXPECT_EQ(options.map.robust, MultiRobotMapOptions::Robust::kHuber);
  EXPECT_FALSE(options.reflection);
  EXPECT_TRUE(options.security.insecure);
  EXPECT_EQ(sources.size(), 6u);
  EXPECT_EQ(sources.at("quotas.max_streams").place, "OVERTONE_QUOTAS_MAX_STREAMS");
}

TEST(OptionsEnvironment, AllMistakesAreNamed) {
  const absl::Status status = Read({"OVERTONE_QUOTA_MAX_STREAMS=7", "OVERTONE_MAX_STREAMS=7",
                                    "OVERTONE_LIMITS_MAX_MAPS=many", "OVERTONE_KITCHEN=1"});
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(status.message(),
            "the environment's OVERTONE_QUOTA_MAX_STREAMS is no option of the server; did you mean "
            "'OVERTONE_QUOTAS_MAX_STREAMS'?\n"
            "the environment's OVERTONE_MAX_STREAMS is no option of the server; did you mean "
            "'OVERTONE_QUOTAS_MAX_STREAMS'?\n"
            "the environment's OVERTONE_LIMITS_MAX_MAPS is not integer: 'many'\n"
            "the environment's OVERTONE_KITCHEN is no option of the server");
}

TEST(OptionsEnvironment, WhatIsOthersIsLeftAlone) {
  const absl::Status status = Read({
      "OVERTONE_CONFIG=server.yaml",
      "OVERTONE_SERVER=localhost:7077",
      "OVERTONE_MAP=town",
      "OVERTONE_DASHBOARD_LISTEN=:8080",
      "OVERTONE_TLS_CA=ca.crt",
      "OVERTONE_TLS_ROBOT_CERTS=certs",
      "OVERTONE_FAILPOINT=store:1",
      "OVERTONE_TEST_KILLS=3",
      // A Service named overtone-mapping-server, as its pods see it.
      "OVERTONE_MAPPING_SERVER_SERVICE_HOST=10.0.0.7",
      "OVERTONE_MAPPING_SERVER_SERVICE_PORT=7077",
      "OVERTONE_MAPPING_SERVER_SERVICE_PORT_GRPC=7077",
      "OVERTONE_MAPPING_SERVER_PORT=tcp://10.0.0.7:7077",
      "OVERTONE_MAPPING_SERVER_PORT_7077_TCP=tcp://10.0.0.7:7077",
      "OVERTONE_MAPPING_SERVER_PORT_7077_TCP_ADDR=10.0.0.7",
      "OVERTONE_MAPPING_SERVER_PORT_7077_TCP_PROTO=tcp",
  });
  EXPECT_TRUE(status.ok()) << status;
  EXPECT_THAT(std::string(Read({"OVERTONE_PORTS=1"}).message()), HasSubstr("OVERTONE_PORTS"));
  EXPECT_THAT(std::string(Read({"OVERTONE_PORT_X_TCP=1"}).message()), HasSubstr("no option"));
}

}  // namespace
}  // namespace overtone
