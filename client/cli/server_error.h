// SPDX-License-Identifier: Apache-2.0
// What a call to a server ended with, in sentences that say what to do next.
#ifndef OVERTONE_CLIENT_CLI_SERVER_ERROR_H_
#define OVERTONE_CLIENT_CLI_SERVER_ERROR_H_

#include <string>

#include "absl/status/status.h"
#include "grpcpp/support/status.h"
#include "overtone/client/tls_files.h"

namespace overtone {

// Ok stays ok. Else the same code, "server host:port: ..." and a hint where there is one: nobody
// listens there, the one end speaks TLS and the other does not, a certificate is not believed.
// `tls`: what we came with.
absl::Status ServerError(const std::string& server, const TlsFiles& tls,
                         const grpc::Status& status);

// Whether it is one of those; a local file can be Unavailable as well.
bool IsFromServer(const absl::Status& status);

// The same error with more words behind it.
absl::Status WithHint(const absl::Status& status, const std::string& hint);

// The server cannot be reached or asks for patience: the same call may succeed later.
bool MayComeBack(const absl::Status& status);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_SERVER_ERROR_H_
