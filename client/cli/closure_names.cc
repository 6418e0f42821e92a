// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/closure_names.h"

#include "absl/strings/ascii.h"
#include "absl/strings/string_view.h"
#include "absl/strings/strip.h"

namespace overtone {
namespace {

std::string WithoutPrefix(absl::string_view name, absl::string_view prefix) {
  if (name.empty()) return "unspecified";  // a value that our enum does not know
  return absl::AsciiStrToLower(absl::StripPrefix(name, prefix));
}

}  // namespace

std::string VerdictName(v1::LoopClosureVerdict verdict) {
  return WithoutPrefix(v1::LoopClosureVerdict_Name(verdict), "LOOP_CLOSURE_VERDICT_");
}

std::string ProposerName(v1::LoopClosureProposer proposer) {
  return WithoutPrefix(v1::LoopClosureProposer_Name(proposer), "LOOP_CLOSURE_PROPOSER_");
}

}  // namespace overtone
