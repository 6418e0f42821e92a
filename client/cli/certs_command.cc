// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/certs_command.h"

#include <algorithm>
#include <iostream>
#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/time/clock.h"
#include "overtone/client/cli/certificate_folder.h"
#include "overtone/client/cli/exit_code.h"

namespace overtone {
namespace {

std::string Flags(const std::string& folder, const std::string& name) {
  return absl::StrCat("--tls-ca ", folder, "/ca.crt --tls-cert ", folder, "/", name,
                      ".crt --tls-key ", folder, "/", name, ".key");
}

// How to start the two ends with what is there now.
std::string NextSteps(const CertificateFolderOptions& options) {
  const std::string& folder = options.folder;
  std::string text = absl::StrCat(
      "\nServer, in its configuration file (then listen where the robots can reach it):\n"
      "  tls:\n    ca_file: ",
      folder, "/ca.crt\n    certificate_file: ", folder, "/server.crt\n    key_file: ", folder,
      "/server.key\n  access_file: ", folder, "/access.yaml\n");
  // A robot's own program sets MappingClientOptions::tls to the same three files.
  for (const std::string& robot : options.robots) {
    absl::StrAppend(&text, "Robot ", robot, ":\n  overtone robot ", Flags(folder, "robot-" + robot),
                    " ...\n");
  }
  for (const std::string& name : options.operators) {
    absl::StrAppend(&text, "Operator ", name, ":\n  overtone status ",
                    Flags(folder, "operator-" + name), "\n");
  }
  return text;
}

int Run(const CertificateFolderOptions& options) {
  const absl::StatusOr<CertificateFolderChanges> changes =
      FillCertificateFolder(options, absl::Now());
  if (!changes.ok()) return Fail("certs", changes.status());
  std::cout << "Written to " << options.folder << ": "
            << (changes->written.empty() ? "nothing" : absl::StrJoin(changes->written, ", "))
            << "\n";
  if (!changes->kept.empty()) {
    std::cout << "Kept as they were: " << absl::StrJoin(changes->kept, ", ") << "\n";
  }
  const auto kept = [&](const std::string& file) {
    return std::find(changes->kept.begin(), changes->kept.end(), file) != changes->kept.end();
  };
  if (kept("access.yaml") && !changes->written.empty()) {
    std::cout << "Add the new names to " << options.folder << "/access.yaml yourself.\n";
  }
  std::cout << NextSteps(options);
  return 0;
}

}  // namespace

void AddCertsCommand(CLI::App* app, std::function<int()>* run) {
  auto options = std::make_shared<CertificateFolderOptions>();
  CLI::App* command = app->add_subcommand(
      "certs", "Make a CA and certificates for development, and an access file");
  command->footer(
      "Writes ca, server, robot-NAME and operator-NAME, each as .crt and .key (readable to you "
      "only), and\n"
      "access.yaml, which lets the robots and operators use --map. Call it again with other names "
      "to add\n"
      "certificates of the same CA: what is there is kept, unless --force makes all anew. Keep "
      "ca.key to\n"
      "yourself: who has it can be any robot. In production let your own CA issue certificates "
      "with the URI\n"
      "spiffe://DOMAIN/robot/NAME or spiffe://DOMAIN/operator/NAME.\n\n"
      "  overtone certs --robot anna --robot bert --operator olga --server-name map.example.org");
  command->add_option("--out", options->folder, "Folder to write to")->capture_default_str();
  command->add_option("--robot", options->robots, "Robot to make a certificate for; repeatable");
  command->add_option("--operator", options->operators,
                      "Operator to make a certificate for; repeatable");
  command
      ->add_option("--server-name", options->server_names,
                   "DNS name or IP address under which the server is reached; repeatable")
      ->capture_default_str();
  command->add_option("--map", options->map, "Map that access.yaml grants")->capture_default_str();
  command->add_option("--trust-domain", options->trust_domain, "Of the spiffe:// names")
      ->capture_default_str();
  command->add_option("--days", options->days, "How long the certificates are good")
      ->check(CLI::Range(1, 36500))
      ->capture_default_str();
  command->add_flag("--force", options->force, "Overwrite everything, the CA too");
  command->callback([options, run] { *run = [options] { return Run(*options); }; });
}

}  // namespace overtone
