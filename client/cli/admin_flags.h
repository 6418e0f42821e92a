// SPDX-License-Identifier: Apache-2.0
// What the operators' commands have in common.
#ifndef OVERTONE_CLIENT_CLI_ADMIN_FLAGS_H_
#define OVERTONE_CLIENT_CLI_ADMIN_FLAGS_H_

#include <functional>
#include <iostream>
#include <string>
#include <vector>

#include "CLI/CLI.hpp"
#include "absl/status/status.h"
#include "google/protobuf/message.h"
#include "overtone/client/cli/admin_client.h"

namespace overtone {

struct AdminFlags {
  std::string server = "localhost:7077";
  TlsFiles tls;
  std::string map = "default";
  bool json = false;
  double timeout_s = 10;

  AdminClient Client() const { return AdminClient(server, absl::Seconds(timeout_s), tls); }
};

// Which of the flags a command takes beside --server, --timeout and those of tls_flags.h.
struct AdminFlagSet {
  bool map = true;
  bool json = false;
  // Whatever goes wrong at run time is exit code 1: health checks know no other.
  bool one_failure = false;
};

// `act` runs when the command was given. `flags` must outlive it. To an error about what is not
// there it adds what there is. The members of AdminFlags are set when the command is chosen, from
// what they are now: several commands may share `flags`.
CLI::App* AddAdminCommand(CLI::App* app, const std::string& name, const std::string& what,
                          AdminFlagSet set, AdminFlags* flags, std::function<absl::Status()> act,
                          std::function<int()>* run);

// Protobuf's JSON on one line, the fields named as in the schema and all of them there.
std::string ToJson(const google::protobuf::Message& message);

// One message on a line.
template <typename Message>
void PrintJson(const std::vector<Message>& messages) {
  for (const Message& message : messages) std::cout << ToJson(message) << "\n";
}

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_ADMIN_FLAGS_H_
