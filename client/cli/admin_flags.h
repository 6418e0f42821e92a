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
#include "google/protobuf/util/json_util.h"
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
};

// `act` runs when the command was given. `flags` must outlive it.
CLI::App* AddAdminCommand(CLI::App* app, const std::string& name, const std::string& what,
                          AdminFlagSet set, AdminFlags* flags, std::function<absl::Status()> act,
                          std::function<int()>* run);

// One message on a line, as protobuf's JSON.
template <typename Message>
void PrintJson(const std::vector<Message>& messages) {
  google::protobuf::util::JsonPrintOptions options;
  options.preserve_proto_field_names = true;
  options.always_print_primitive_fields = true;
  for (const Message& message : messages) {
    std::string text;
    if (google::protobuf::util::MessageToJsonString(message, &text, options).ok()) {
      std::cout << text << "\n";
    }
  }
}

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_ADMIN_FLAGS_H_
