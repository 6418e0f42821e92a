// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_CLIENT_TLS_FILES_H_
#define OVERTONE_CLIENT_TLS_FILES_H_

#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"

namespace overtone {

// Our end of the server's mutual TLS: PEM files. All three, or none: plaintext.
struct TlsFiles {
  std::string ca_file;           // who signed the server's certificate
  std::string certificate_file;  // says who we are: spiffe://<trust domain>/robot/<id>
  std::string key_file;          // without a passphrase
  // The name that the server's certificate has, when it is not the one that we connect to.
  std::string server_name;
  // How often the files are looked at, whole seconds; a connection uses what was there when it was
  // made. Replace a file by renaming a new one over it.
  absl::Duration reload_every = absl::Seconds(10);
  // Plaintext, and to a server on another host: everybody on the way can read and change all.
  bool insecure = false;

  // Any file is given.
  bool enabled() const {
    return !ca_file.empty() || !certificate_file.empty() || !key_file.empty();
  }

  // InvalidArgument naming the member: some files without the others, or plaintext to a `server`
  // (host:port) that is not this host without `insecure`. Reads no file.
  absl::Status Validate(absl::string_view server) const;
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_TLS_FILES_H_
