// SPDX-License-Identifier: Apache-2.0
// Which requests a service on loopback may trust to come from its own page: a browser that shows
// some other site reaches loopback too.
#ifndef OVERTONE_SERVICES_DASHBOARD_HTTP_GUARD_H_
#define OVERTONE_SERVICES_DASHBOARD_HTTP_GUARD_H_

#include <set>
#include <string>

#include "absl/strings/string_view.h"

namespace overtone {

// Without the port and, of an IPv6 address, without brackets; in lower case.
std::string HostName(absl::string_view host_header);

class HttpGuard {
 public:
  // `names`: under which, beside localhost and IP addresses, the page is reached.
  explicit HttpGuard(const std::set<std::string>& names) : names_(names) {}

  // False: some site has pointed a name of its own at our address (DNS rebinding), and its scripts
  // count as ours. An IP address cannot be pointed anywhere.
  bool IsOurHost(absl::string_view host_header) const;

  // Of a request that changes something. `origin` and `fetch_site` are empty when the browser or a
  // tool sent none. `marker` is the header X-Overtone-Dashboard, which no form can set and no other
  // site's script without asking first.
  bool IsOurPage(absl::string_view host_header, absl::string_view origin,
                 absl::string_view fetch_site, absl::string_view marker) const;

 private:
  const std::set<std::string> names_;
};

// Scripts, styles and images of our own and nothing else, in no frame.
extern const char kContentSecurityPolicy[];

}  // namespace overtone

#endif  // OVERTONE_SERVICES_DASHBOARD_HTTP_GUARD_H_
