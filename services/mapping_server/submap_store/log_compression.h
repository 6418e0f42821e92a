// SPDX-License-Identifier: Apache-2.0
// How a log entry's bytes lie on disk.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_LOG_COMPRESSION_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_LOG_COMPRESSION_H_

#include <cstdint>
#include <string>

#include "absl/strings/string_view.h"

namespace overtone {

enum class LogEncoding : int64_t {
  kPlain = 0,
  kZstd = 1,  // one frame that says how long its content is
};

struct EncodedLogBytes {
  LogEncoding encoding = LogEncoding::kPlain;
  std::string bytes;
};

// Compressed where that makes them smaller.
EncodedLogBytes EncodeLogBytes(absl::string_view bytes);

// Empty when they are damaged (the digest of the row shows it). Takes at most 64 MiB of memory,
// whatever a damaged frame says.
std::string DecodeLogBytes(LogEncoding encoding, absl::string_view encoded);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_LOG_COMPRESSION_H_
