// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_PROTO_CONVERSION_SHA256_H_
#define OVERTONE_PROTO_CONVERSION_SHA256_H_

#include <memory>
#include <string>

#include "absl/strings/string_view.h"

namespace overtone {

// SHA-256, 32 bytes: the name of a blob on the wire.
std::string Sha256(absl::string_view bytes);

// The same of bytes that come piece by piece.
class Sha256Sum {
 public:
  Sha256Sum();
  ~Sha256Sum();

  void Add(absl::string_view bytes);
  // Of all that was added. Once, and nothing is added afterwards.
  std::string Finish();

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

}  // namespace overtone

#endif  // OVERTONE_PROTO_CONVERSION_SHA256_H_
