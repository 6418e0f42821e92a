// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/tls_files.h"

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/security/loopback_address.h"

namespace overtone {
namespace {

absl::Status ValidateFiles(const TlsFiles& tls) {
  const auto need = [](absl::string_view member, const std::string& value) {
    if (!value.empty()) return absl::OkStatus();
    return absl::InvalidArgumentError(
        absl::StrCat(member, ": missing; TLS needs ca_file, certificate_file and key_file"));
  };
  RETURN_IF_ERROR(need("ca_file", tls.ca_file));
  RETURN_IF_ERROR(need("certificate_file", tls.certificate_file));
  RETURN_IF_ERROR(need("key_file", tls.key_file));
  if (tls.insecure) return absl::InvalidArgumentError("insecure: contradicts the files");
  if (tls.reload_every >= absl::Seconds(1) && tls.reload_every <= absl::Hours(24)) {
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(absl::StrCat("reload_every: within 1 s and 24 h, got ",
                                                 absl::FormatDuration(tls.reload_every)));
}

}  // namespace

absl::Status TlsFiles::Validate(absl::string_view server) const {
  if (enabled()) return ValidateFiles(*this);
  if (!server_name.empty()) {
    return absl::InvalidArgumentError("server_name: without certificates there is none to check");
  }
  if (insecure || IsLoopback(server)) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      "ca_file: missing, and ", server,
      " is another host: everybody on the way could read and change what is sent. Give ca_file, "
      "certificate_file and key_file, or say insecure where every host of the network is trusted"));
}

}  // namespace overtone
