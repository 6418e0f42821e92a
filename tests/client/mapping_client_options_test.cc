// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/mapping_client_options.h"

#include <cmath>
#include <functional>
#include <string>
#include <utility>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

MappingClientOptions Named() {
  MappingClientOptions options;
  options.mission = {"robot_a", "run_1"};
  return options;
}

TEST(MappingClientOptions, DefaultsAreValidOnceTheMissionHasAName) {
  EXPECT_TRUE(Named().Validate().ok()) << Named().Validate();
  EXPECT_FALSE(MappingClientOptions().Validate().ok());
}

TEST(MappingClientOptions, ErrorsNameTheOption) {
  using Change = std::function<void(MappingClientOptions&)>;
  const std::pair<std::string, Change> cases[] = {
      {"server", [](auto& o) { o.server.clear(); }},
      {"tls.ca_file", [](auto& o) { o.server = "map.example.org:7077"; }},
      {"tls.key_file", [](auto& o) { o.tls.ca_file = o.tls.certificate_file = "x"; }},
      {"tls.certificate_file", [](auto& o) { o.tls.ca_file = o.tls.key_file = "x"; }},
      {"tls.ca_file", [](auto& o) { o.tls.certificate_file = o.tls.key_file = "x"; }},
      {"tls.server_name", [](auto& o) { o.tls.server_name = "map"; }},
      {"tls.insecure",
       [](auto& o) {
         o.tls.ca_file = o.tls.certificate_file = o.tls.key_file = "x";
         o.tls.insecure = true;
       }},
      {"map", [](auto& o) { o.map = "Town"; }},
      {"mission.robot", [](auto& o) { o.mission.robot = ""; }},
      {"mission.mission", [](auto& o) { o.mission.mission = "../etc"; }},
      {"outbox_capacity_bytes", [](auto& o) { o.outbox_capacity_bytes = 1000; }},
      {"outbox_sync_interval", [](auto& o) { o.outbox_sync_interval = absl::ZeroDuration(); }},
      {"max_upload_bytes_per_s", [](auto& o) { o.max_upload_bytes_per_s = -1; }},
      {"max_upload_bytes_per_s", [](auto& o) { o.max_upload_bytes_per_s = 999; }},
      {"clock_offset_warning", [](auto& o) { o.clock_offset_warning = -absl::Seconds(1); }},
      {"clouds.resolution_m", [](auto& o) { o.clouds.resolution_m = 0; }},
      {"max_nodes", [](auto& o) { o.max_nodes = -1; }},
      {"max_nodes", [](auto& o) { o.max_nodes = 1'000'001; }},
      {"min_time_between_comparisons",
       [](auto& o) { o.min_time_between_comparisons = -absl::Seconds(1); }},
      {"initial_backoff", [](auto& o) { o.initial_backoff = absl::ZeroDuration(); }},
      {"initial_backoff", [](auto& o) { o.initial_backoff = 2 * o.max_backoff; }},
      {"max_backoff", [](auto& o) { o.max_backoff = absl::InfiniteDuration(); }},
      {"stale_after", [](auto& o) { o.stale_after = -absl::Seconds(1); }},
      {"synchronization.multi_robot_graph",
       [](auto& o) { o.synchronization.multi_robot_graph = true; }},
      {"synchronization.",
       [](auto& o) { o.synchronization.association_tolerance_s = std::nan(""); }},
  };
  for (const auto& [name, change] : cases) {
    MappingClientOptions options = Named();
    change(options);
    const absl::Status status = options.Validate();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << name;
    EXPECT_THAT(std::string(status.message()), testing::StartsWith(name));
  }
}

TEST(MappingClientOptions, PlaintextToAnotherHostMustBeAskedForByName) {
  MappingClientOptions options = Named();
  options.server = "map.example.org:7077";
  options.tls.insecure = true;
  EXPECT_TRUE(options.Validate().ok()) << options.Validate();
  options.tls = TlsFiles();
  options.tls.ca_file = options.tls.certificate_file = options.tls.key_file = "x";
  EXPECT_TRUE(options.Validate().ok()) << options.Validate();
}

}  // namespace
}  // namespace overtone
