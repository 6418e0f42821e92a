// SPDX-License-Identifier: Apache-2.0
// No exception may pass between the host and this library, in either direction.
#ifndef OVERTONE_CLIENT_INTERNAL_EXCEPTION_GUARD_H_
#define OVERTONE_CLIENT_INTERNAL_EXCEPTION_GUARD_H_

#include <exception>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"

namespace overtone {

// Returns call(), whose result must be constructible from absl::Status; Internal naming `what` when
// it throws.
template <typename Call>
auto GuardExceptions(absl::string_view what, Call&& call) -> decltype(call()) {
  try {
    return call();
  } catch (const std::exception& exception) {
    return absl::InternalError(absl::StrCat(what, " threw: ", exception.what()));
  } catch (...) {
    return absl::InternalError(absl::StrCat(what, " threw something that is no std::exception"));
  }
}

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_EXCEPTION_GUARD_H_
