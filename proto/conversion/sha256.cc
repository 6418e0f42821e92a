// SPDX-License-Identifier: Apache-2.0
#include "overtone/proto/conversion/sha256.h"

#include "openssl/evp.h"

namespace overtone {

std::string Sha256(absl::string_view bytes) {
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned int size = 0;
  EVP_Digest(bytes.data(), bytes.size(), digest, &size, EVP_sha256(), nullptr);
  return std::string(reinterpret_cast<const char*>(digest), size);
}

}  // namespace overtone
