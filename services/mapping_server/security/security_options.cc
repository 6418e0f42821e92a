// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/security/security_options.h"

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/security/loopback_address.h"
#include "overtone/proto/conversion/field_path.h"

namespace overtone {
namespace {

absl::Status ValidateTls(const SecurityOptions& options) {
  const auto need = [](absl::string_view option, const std::string& value) {
    if (!value.empty()) return absl::OkStatus();
    return InvalidField(option, "missing; tls needs ca_file, certificate_file and key_file");
  };
  RETURN_IF_ERROR(need("tls.ca_file", options.files.ca_file));
  RETURN_IF_ERROR(need("tls.certificate_file", options.files.certificate_file));
  RETURN_IF_ERROR(need("tls.key_file", options.files.key_file));
  if (options.insecure) return InvalidField("insecure", "contradicts tls");
  if (!options.access_file.empty()) return absl::OkStatus();
  return InvalidField("access_file",
                      "missing; with tls it says which robots and operators may use which map "
                      "(`overtone certs` writes one)");
}

}  // namespace

absl::Status SecurityOptions::Validate(absl::string_view listen) const {
  if (!(reload_s >= 0.05 && reload_s <= 3600)) {  // also for NaN
    return InvalidField("tls.reload_s", absl::StrCat(reload_s, " is not in [0.05, 3600]"));
  }
  if (tls()) return ValidateTls(*this);
  if (!access_file.empty()) {
    return InvalidField("access_file",
                        "needs tls: without certificates nobody can be told from another");
  }
  if (insecure || IsLoopback(listen)) return absl::OkStatus();
  return InvalidField(
      "listen",
      absl::StrCat("others can reach ", listen,
                   ", and without tls anybody could read and change every map. Set tls.ca_file, "
                   "tls.certificate_file, tls.key_file and access_file (`overtone certs` makes "
                   "them), or listen on localhost, or say insecure: true (--insecure) where every "
                   "host of the network is trusted"));
}

}  // namespace overtone
