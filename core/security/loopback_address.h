// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_CORE_SECURITY_LOOPBACK_ADDRESS_H_
#define OVERTONE_CORE_SECURITY_LOOPBACK_ADDRESS_H_

#include "absl/strings/string_view.h"

namespace overtone {

// Whether an address that gRPC takes, "host:port" or with a scheme ("dns:///host:port",
// "ipv4:...", "ipv6:...", "unix:..."), never leaves this host: localhost, 127.0.0.0/8, ::1, or a
// Unix socket. Nothing is resolved: any other name counts as remote.
bool IsLoopback(absl::string_view address);

}  // namespace overtone

#endif  // OVERTONE_CORE_SECURITY_LOOPBACK_ADDRESS_H_
