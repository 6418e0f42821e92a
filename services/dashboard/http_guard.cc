// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/dashboard/http_guard.h"

#include <arpa/inet.h>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"

namespace overtone {
namespace {

bool IsAddress(const std::string& name) {
  in6_addr address;
  return inet_pton(AF_INET, name.c_str(), &address) == 1 ||
         inet_pton(AF_INET6, name.c_str(), &address) == 1;
}

}  // namespace

const char kContentSecurityPolicy[] =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src "
    "'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

std::string HostName(absl::string_view host_header) {
  absl::string_view name = host_header;
  const size_t bracket = name.find(']');
  if (!name.empty() && name.front() == '[' && bracket != absl::string_view::npos) {
    const absl::string_view rest = name.substr(bracket + 1);
    // What is no address with a port stays whole, and is then nobody's name.
    if (rest.empty() || rest.front() == ':') name = name.substr(1, bracket - 1);
  } else {
    name = name.substr(0, name.rfind(':'));
  }
  return absl::AsciiStrToLower(name);
}

bool HttpGuard::IsOurHost(absl::string_view host_header) const {
  const std::string name = HostName(host_header);
  return name == "localhost" || IsAddress(name) || names_.count(name) > 0;
}

bool HttpGuard::IsOurPage(absl::string_view host_header, absl::string_view origin,
                          absl::string_view fetch_site, absl::string_view marker) const {
  if (marker != "1" || !IsOurHost(host_header)) return false;
  if (!fetch_site.empty() && fetch_site != "same-origin") return false;
  return origin.empty() || origin == absl::StrCat("http://", host_header) ||
         origin == absl::StrCat("https://", host_header);
}

}  // namespace overtone
