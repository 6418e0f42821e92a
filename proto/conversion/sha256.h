// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_PROTO_CONVERSION_SHA256_H_
#define OVERTONE_PROTO_CONVERSION_SHA256_H_

#include <string>

#include "absl/strings/string_view.h"

namespace overtone {

// SHA-256, 32 bytes: the name of a blob on the wire.
std::string Sha256(absl::string_view bytes);

}  // namespace overtone

#endif  // OVERTONE_PROTO_CONVERSION_SHA256_H_
