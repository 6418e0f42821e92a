// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/common/status_macros.h"

#include <memory>
#include <utility>

#include "gtest/gtest.h"

namespace overtone {
namespace {

absl::Status ReturnIfError(const absl::Status& status, bool& went_on) {
  RETURN_IF_ERROR(status);
  went_on = true;
  return absl::OkStatus();
}

absl::StatusOr<int> AddOne(absl::StatusOr<std::unique_ptr<int>> input) {
  ASSIGN_OR_RETURN(const std::unique_ptr<int> value, std::move(input));  // move-only values pass
  return *value + 1;
}

TEST(ReturnIfError, GoesOnWhenOk) {
  bool went_on = false;
  EXPECT_TRUE(ReturnIfError(absl::OkStatus(), went_on).ok());
  EXPECT_TRUE(went_on);
}

TEST(ReturnIfError, ReturnsTheErrorUnchanged) {
  bool went_on = false;
  const absl::Status error = absl::DataLossError("lost");
  EXPECT_EQ(ReturnIfError(error, went_on), error);
  EXPECT_FALSE(went_on);
}

TEST(ReturnIfError, EvaluatesItsArgumentOnce) {
  int calls = 0;
  const auto call = [&calls] { return ++calls, absl::OkStatus(); };
  const auto body = [&call]() -> absl::Status {
    RETURN_IF_ERROR(call());
    return absl::OkStatus();
  };
  EXPECT_TRUE(body().ok());
  EXPECT_EQ(calls, 1);
}

TEST(AssignOrReturn, HandsOverTheValueOrTheError) {
  EXPECT_EQ(*AddOne(std::make_unique<int>(41)), 42);
  EXPECT_EQ(AddOne(absl::NotFoundError("none")).status(), absl::NotFoundError("none"));
}

TEST(AssignOrReturn, WorksTwiceInOneScopeAndOnAnExistingVariable) {
  const auto sum = [](absl::StatusOr<int> a, absl::StatusOr<int> b) -> absl::StatusOr<int> {
    int total;
    ASSIGN_OR_RETURN(total, a);
    ASSIGN_OR_RETURN(const int more, b);
    return total + more;
  };
  EXPECT_EQ(*sum(1, 2), 3);
  EXPECT_EQ(sum(1, absl::AbortedError("b")).status(), absl::AbortedError("b"));
}

}  // namespace
}  // namespace overtone
