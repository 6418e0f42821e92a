// SPDX-License-Identifier: Apache-2.0
#include "overtone/proto/conversion/report_conversion.h"

#include <functional>
#include <limits>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using ::testing::StartsWith;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

v1::LinkReport GoodLink() {
  v1::LinkReport link;
  link.set_submaps_waiting(3);
  link.mutable_clock_offset()->set_seconds(-2);
  link.mutable_clock_offset()->set_nanos(-500'000'000);
  link.mutable_clock_offset_uncertainty()->set_nanos(1'000'000);
  link.set_client_version("0.1.0");
  return link;
}

v1::ComparisonReport GoodComparison() {
  v1::ComparisonReport comparison;
  comparison.mutable_time()->set_seconds(1'700'000'000);
  comparison.set_nodes(700);
  comparison.set_duration_s(0.01);
  for (int i = 0; i < report_limits::kMaxNodes; ++i) {
    comparison.add_index(2 * i);
    comparison.add_small(0);
    comparison.add_mid(1);
    comparison.add_large(2);
  }
  for (int i = 0; i < report_limits::kMaxConstraintEnds; ++i) comparison.add_largest()->set_to(1);
  comparison.add_constraints()->set_added(7);
  comparison.set_rmse_before_m(1);
  comparison.set_held_back(std::string(report_limits::kMaxHeldBackBytes, 'x'));
  return comparison;
}

template <typename Message>
struct Broken {
  std::string field;  // how the error begins
  std::function<void(Message&)> how;
};

template <typename Message>
void ExpectNamed(const Message& good, const std::vector<Broken<Message>>& cases) {
  EXPECT_TRUE(Validate(good).ok()) << Validate(good);
  EXPECT_TRUE(Validate(Message()).ok()) << Validate(Message());
  for (const Broken<Message>& broken : cases) {
    Message message = good;
    broken.how(message);
    const absl::Status status = Validate(message);
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << broken.field;
    EXPECT_THAT(std::string(status.message()), StartsWith(broken.field + ": "));
  }
}

TEST(ReportConversion, EveryFieldOfALinkIsChecked) {
  ExpectNamed<v1::LinkReport>(
      GoodLink(),
      {
          {"submaps_waiting", [](auto& m) { m.set_submaps_waiting(-1); }},
          {"blobs_waiting", [](auto& m) { m.set_blobs_waiting(-1); }},
          {"bytes_waiting", [](auto& m) { m.set_bytes_waiting(-1); }},
          {"bytes_sent", [](auto& m) { m.set_bytes_sent(-1); }},
          {"bytes_received", [](auto& m) { m.set_bytes_received(-1); }},
          {"report_bytes_sent", [](auto& m) { m.set_report_bytes_sent(-1); }},
          {"reconnects", [](auto& m) { m.set_reconnects(-1); }},
          {"clouds_dropped", [](auto& m) { m.set_clouds_dropped(-1); }},
          {"clock_offset", [](auto& m) { m.mutable_clock_offset()->set_nanos(1); }},
          {"clock_offset", [](auto& m) { m.mutable_clock_offset()->set_nanos(-1'000'000'000); }},
          {"clock_offset", [](auto& m) { m.mutable_clock_offset()->set_seconds(-5'000'000'000); }},
          {"clock_offset_uncertainty.nanos",
           [](auto& m) { m.mutable_clock_offset_uncertainty()->set_nanos(-1); }},
          {"clock_offset_uncertainty.seconds",
           [](auto& m) {
             m.mutable_clock_offset_uncertainty()->set_nanos(0);
             m.mutable_clock_offset_uncertainty()->set_seconds(-1);
           }},
          {"client_version", [](auto& m) { m.set_client_version(std::string(65, '1')); }},
          {"client_version", [](auto& m) { m.set_client_version("\x1b[2J"); }},
      });
}

TEST(ReportConversion, EveryFieldOfAComparisonIsChecked) {
  ExpectNamed<v1::ComparisonReport>(
      GoodComparison(),
      {
          {"time", [](auto& m) { m.mutable_time()->set_seconds(-1); }},
          {"time", [](auto& m) { m.mutable_time()->set_nanos(1'000'000'000); }},
          {"nodes", [](auto& m) { m.set_nodes(-1); }},
          {"duration_s", [](auto& m) { m.set_duration_s(kNan); }},
          {"duration_s", [](auto& m) { m.set_duration_s(-1); }},
          {"index", [](auto& m) { m.add_index(1'000'000); }},
          {"index[0]", [](auto& m) { m.set_index(0, -1); }},
          {"index[2]", [](auto& m) { m.set_index(2, 2); }},
          {"small", [](auto& m) { m.add_small(0); }},
          {"mid", [](auto& m) { m.mutable_mid()->RemoveLast(); }},
          {"large", [](auto& m) { m.clear_large(); }},
          {"small[3]", [](auto& m) { m.set_small(3, static_cast<float>(kNan)); }},
          {"mid[499]", [](auto& m) { m.set_mid(499, -1); }},
          {"large[0]", [](auto& m) { m.set_large(0, static_cast<float>(kInfinity)); }},
          {"constraints[0].added", [](auto& m) { m.mutable_constraints(0)->set_added(-1); }},
          {"constraints",
           [](auto& m) {
             for (int i = 0; i < report_limits::kMaxConstraintCounts; ++i) m.add_constraints();
           }},
          {"largest", [](auto& m) { m.add_largest(); }},
          {"largest[1].from", [](auto& m) { m.mutable_largest(1)->set_from(-1); }},
          {"largest[1].to", [](auto& m) { m.mutable_largest(1)->set_to(2'000'000'000); }},
          {"largest[199].score", [](auto& m) { m.mutable_largest(199)->set_score(kNan); }},
          {"updated", [](auto& m) { m.set_updated(-1); }},
          {"retracted", [](auto& m) { m.set_retracted(-1); }},
          {"rmse_before_m", [](auto& m) { m.set_rmse_before_m(kInfinity); }},
          {"predicted_rmse_m", [](auto& m) { m.set_predicted_rmse_m(-1); }},
          {"small_level.noise", [](auto& m) { m.mutable_small_level()->set_noise(-1); }},
          {"mid_level.largest", [](auto& m) { m.mutable_mid_level()->set_largest(kInfinity); }},
          {"large_level.noise", [](auto& m) { m.mutable_large_level()->set_noise(kNan); }},
          {"held_back", [](auto& m) { m.mutable_held_back()->push_back('x'); }},
          {"held_back", [](auto& m) { m.set_held_back("two\nlines"); }},
      });
}

}  // namespace
}  // namespace overtone
