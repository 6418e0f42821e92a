// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/dashboard/dashboard_options.h"

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "overtone/core/common/ids.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/security/loopback_address.h"

namespace overtone {
namespace {

absl::Status WithinRange(const char* flag, double value, double least, double most) {
  if (value >= least && value <= most) return absl::OkStatus();  // not so for NaN
  return absl::InvalidArgumentError(
      absl::StrCat(flag, ": within ", least, " and ", most, ", got ", value));
}

}  // namespace

absl::StatusOr<ListenAddress> ParseListenAddress(const std::string& text) {
  const size_t colon = text.rfind(':');
  ListenAddress address;
  if (colon == std::string::npos || colon == 0 ||
      !absl::SimpleAtoi(text.substr(colon + 1), &address.port) || address.port < 0 ||
      address.port > 65535) {
    return absl::InvalidArgumentError(absl::StrCat("--listen: '", text, "' is not host:port"));
  }
  address.host = text.substr(0, colon);
  if (address.host.front() == '[' && address.host.back() == ']') {
    address.host = address.host.substr(1, address.host.size() - 2);
  }
  return address;
}

absl::Status DashboardOptions::Validate() const {
  RETURN_IF_ERROR(connection.Validate());
  RETURN_IF_ERROR(ParseListenAddress(listen).status());
  RETURN_IF_ERROR(ValidateId(map, "--map"));
  if (!read_only && !trust_network && !IsLoopback(listen)) {
    return absl::InvalidArgumentError(absl::StrCat(
        "--listen: other hosts reach ", listen,
        ", and the page has no log-in: all of them could veto closures. Give --read-only, or "
        "--trust-network where everybody who can reach it may"));
  }
  RETURN_IF_ERROR(WithinRange("--timeout", timeout_s, 0.1, 600));
  RETURN_IF_ERROR(WithinRange("--interval", absl::ToDoubleSeconds(mirror.interval), 0.05, 3600));
  RETURN_IF_ERROR(WithinRange("--max-nodes", static_cast<double>(mirror.max_nodes), 100, 2e6));
  RETURN_IF_ERROR(WithinRange("--history-mib", history_mib, 1, 65536));
  return WithinRange("--cloud-points", static_cast<double>(cloud_points), 1000, 1e7);
}

}  // namespace overtone
