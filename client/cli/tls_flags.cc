// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/tls_flags.h"

#include <cstdlib>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "overtone/client/internal/channel_credentials.h"

namespace overtone {

void AddTlsFlags(CLI::App* app, TlsFiles* tls) {
  const std::string group = "Transport security";
  app->add_option("--tls-ca", tls->ca_file, "PEM file of the CA that the server must be signed by")
      ->envname("OVERTONE_TLS_CA")
      ->group(group);
  app->add_option("--tls-cert", tls->certificate_file, "PEM file of our certificate")
      ->envname("OVERTONE_TLS_CERT")
      ->group(group);
  app->add_option("--tls-key", tls->key_file, "PEM file of its key")
      ->envname("OVERTONE_TLS_KEY")
      ->group(group);
  app->add_option("--tls-server-name", tls->server_name,
                  "The name in the server's certificate, when --server has another")
      ->envname("OVERTONE_TLS_SERVER_NAME")
      ->group(group);
  app->add_flag("--insecure", tls->insecure, "Talk to another host without certificates")
      ->envname("OVERTONE_INSECURE")
      ->group(group);
}

std::vector<std::string> TlsArguments(const TlsFiles& tls) {
  std::vector<std::string> arguments;
  const auto add = [&arguments](const char* flag, const std::string& value) {
    if (!value.empty()) arguments.push_back(absl::StrCat(flag, "=", value));
  };
  add("--tls-ca", tls.ca_file);
  add("--tls-cert", tls.certificate_file);
  add("--tls-key", tls.key_file);
  add("--tls-server-name", tls.server_name);
  if (tls.insecure) arguments.push_back("--insecure");
  return arguments;
}

void ClearTlsEnvironment() {
  for (const char* name : {"OVERTONE_TLS_CA", "OVERTONE_TLS_CERT", "OVERTONE_TLS_KEY",
                           "OVERTONE_TLS_SERVER_NAME", "OVERTONE_INSECURE"}) {
    unsetenv(name);
  }
}

TlsFiles TlsFilesOfRobot(TlsFiles tls, const std::string& folder, const std::string& robot) {
  if (!tls.enabled()) return tls;
  tls.certificate_file = absl::StrCat(folder, "/robot-", robot, ".crt");
  tls.key_file = absl::StrCat(folder, "/robot-", robot, ".key");
  return tls;
}

absl::Status CheckTlsFlags(const TlsFiles& tls, const std::string& server) {
  absl::Status status = tls.Validate(server);
  if (status.ok()) status = CheckFiles(tls);
  if (status.ok()) return status;
  return absl::Status(status.code(),
                      absl::StrReplaceAll(status.message(), {{"ca_file", "--tls-ca"},
                                                             {"certificate_file", "--tls-cert"},
                                                             {"key_file", "--tls-key"},
                                                             {"server_name", "--tls-server-name"},
                                                             {"insecure", "--insecure"}}));
}

}  // namespace overtone
