// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/server_error.h"

#include <initializer_list>

#include "absl/strings/ascii.h"
#include "absl/strings/cord.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "overtone/proto/conversion/status_conversion.h"

namespace overtone {
namespace {

constexpr char kFromServer[] = "overtone/from-server";

// Whatever the case; `words` are in lower case.
bool SaysOneOf(absl::string_view message, std::initializer_list<absl::string_view> words) {
  const std::string lower = absl::AsciiStrToLower(message);
  for (const absl::string_view word : words) {
    if (absl::StrContains(lower, word)) return true;
  }
  return false;
}

// gRPC has no code for why a connection failed: its words must do.
const char* ConnectionHint(absl::string_view message, bool tls) {
  if (SaysOneOf(message, {"refused"})) {
    return "nobody listens there. Is overtone-mapping-server running? --server host:port, or "
           "OVERTONE_SERVER, says where";
  }
  if (SaysOneOf(message, {"dns resolution failed", "name resolution"})) {
    return "there is no host of that name. --server host:port, or OVERTONE_SERVER, says where";
  }
  if (tls && SaysOneOf(message, {"wrong_version_number", "wrong version number"})) {
    return "it speaks no TLS there. Leave out --tls-ca, --tls-cert and --tls-key "
           "(OVERTONE_TLS_...) "
           "if it is meant to run without";
  }
  if (tls && SaysOneOf(message, {"certificate_verify_failed", "certificate verify failed",
                                 "peer name", "hostname verification"})) {
    return "its certificate is not signed by --tls-ca, or is made out to another name "
           "(--tls-server-name)";
  }
  if (tls && SaysOneOf(message, {"handshake", "socket closed", "reset", "closed"})) {
    return "it does not take our certificate, or speaks no TLS there. Look at its log, and at "
           "--tls-cert and --tls-key";
  }
  if (!tls && SaysOneOf(message, {"socket closed", "reset", "closed"})) {
    return "it closes connections without TLS. If it wants TLS, give --tls-ca, --tls-cert and "
           "--tls-key (`overtone certs` makes them)";
  }
  return "is it there, and is the network?";
}

std::string Sentence(const absl::Status& status, bool tls) {
  const std::string message(status.message());
  switch (status.code()) {
    case absl::StatusCode::kUnavailable:
      // The server's own words know better: it is shutting down, a map is being changed.
      if (!SaysOneOf(message, {"connect", "closed", "reset", "refused", "handshake", "dns",
                               "goaway", "resolution", "broken pipe"})) {
        return absl::StrCat(message, "; try again");
      }
      return absl::StrCat("cannot be reached: ", ConnectionHint(message, tls), " (", message, ")");
    case absl::StatusCode::kDeadlineExceeded:
      return absl::StrCat("no answer in time. --timeout waits longer (", message, ")");
    case absl::StatusCode::kUnauthenticated:
      return absl::StrCat(message, "; --tls-cert must be one that the server knows");
    case absl::StatusCode::kPermissionDenied:
      return absl::StrCat(message, "; the server's access file says who may (docs/security.md)");
    case absl::StatusCode::kUnimplemented:
      return absl::StrCat(
          "does not know this call: it is older than this program, or no mapping "
          "server (",
          message, ")");
    default:
      return message;
  }
}

}  // namespace

absl::Status ServerError(const std::string& server, const TlsFiles& tls,
                         const grpc::Status& status) {
  const absl::Status plain = FromGrpcStatus(status);
  if (plain.ok()) return plain;
  absl::Status error(plain.code(),
                     absl::StrCat("server ", server, ": ", Sentence(plain, tls.enabled())));
  error.SetPayload(kFromServer, absl::Cord());
  return error;
}

bool IsFromServer(const absl::Status& status) { return status.GetPayload(kFromServer).has_value(); }

absl::Status WithHint(const absl::Status& status, const std::string& hint) {
  absl::Status longer(status.code(), absl::StrCat(status.message(), hint));
  if (IsFromServer(status)) longer.SetPayload(kFromServer, absl::Cord());
  return longer;
}

bool MayComeBack(const absl::Status& status) {
  return IsFromServer(status) && (absl::IsUnavailable(status) || absl::IsDeadlineExceeded(status));
}

}  // namespace overtone
