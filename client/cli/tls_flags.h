// SPDX-License-Identifier: Apache-2.0
// Flags of every command that talks to a server: the certificate to show, and whom to trust.
#ifndef OVERTONE_CLIENT_CLI_TLS_FLAGS_H_
#define OVERTONE_CLIENT_CLI_TLS_FLAGS_H_

#include <string>
#include <vector>

#include "CLI/CLI.hpp"
#include "absl/status/status.h"
#include "overtone/client/tls_files.h"

namespace overtone {

// --tls-ca, --tls-cert, --tls-key, --tls-server-name and --insecure, each also as an environment
// variable OVERTONE_TLS_CA, ..., OVERTONE_INSECURE. `tls` must outlive the parsing.
void AddTlsFlags(CLI::App* app, TlsFiles* tls);

// The flags that give `tls` again when parsed; none of it from the environment.
std::vector<std::string> TlsArguments(const TlsFiles& tls);

// Whom we start next inherits none of the flags by way of the environment.
void ClearTlsEnvironment();

// The files of one robot in the folder that `overtone certs` has written; CA and server name as in
// `tls`.
TlsFiles TlsFilesOfRobot(TlsFiles tls, const std::string& folder, const std::string& robot);

// Ok: a channel to `server` can be made. Else with the flag's name.
absl::Status CheckTlsFlags(const TlsFiles& tls, const std::string& server);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_TLS_FLAGS_H_
