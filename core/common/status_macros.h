// SPDX-License-Identifier: Apache-2.0
// RETURN_IF_ERROR and ASSIGN_OR_RETURN for absl::Status and absl::StatusOr (Debian 12's abseil has
// none).
#ifndef OVERTONE_CORE_COMMON_STATUS_MACROS_H_
#define OVERTONE_CORE_COMMON_STATUS_MACROS_H_

#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

// RETURN_IF_ERROR(DoIt());
#define RETURN_IF_ERROR(expr)                          \
  do {                                                 \
    absl::Status overtone_status = (expr);             \
    if (!overtone_status.ok()) return overtone_status; \
  } while (false)

#define OVERTONE_CONCAT_INNER(a, b) a##b
#define OVERTONE_CONCAT(a, b) OVERTONE_CONCAT_INNER(a, b)

// ASSIGN_OR_RETURN(const auto value, MakeIt());
#define ASSIGN_OR_RETURN(lhs, expr) \
  OVERTONE_ASSIGN_OR_RETURN(OVERTONE_CONCAT(overtone_status_or_, __LINE__), lhs, expr)
#define OVERTONE_ASSIGN_OR_RETURN(status_or, lhs, expr) \
  auto status_or = (expr);                              \
  if (!status_or.ok()) return status_or.status();       \
  lhs = std::move(status_or).value()

#endif  // OVERTONE_CORE_COMMON_STATUS_MACROS_H_
