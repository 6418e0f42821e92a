// SPDX-License-Identifier: Apache-2.0
// What the fuzz targets have in common: how they cut their input into pieces, and how they say that
// a law is broken.
#ifndef OVERTONE_TESTS_FUZZ_FUZZ_INPUT_H_
#define OVERTONE_TESTS_FUZZ_FUZZ_INPUT_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "absl/strings/str_split.h"
#include "absl/strings/string_view.h"

// A law that holds for every input. Stops the process, as the sanitizers do: the fuzzer keeps the
// input.
#define FUZZ_CHECK(condition, what)                                                   \
  do {                                                                                \
    if (!(condition)) {                                                               \
      std::fprintf(stderr, "%s:%d: broken: %s: %s\n", __FILE__, __LINE__, #condition, \
                   std::string(what).c_str());                                        \
      std::abort();                                                                   \
    }                                                                                 \
  } while (false)

namespace overtone::fuzz {

inline absl::string_view AsText(const uint8_t* data, size_t size) {
  return absl::string_view(reinterpret_cast<const char*>(data), size);
}

// The first byte, 0 where there is none: which of several things the rest is for.
inline uint8_t TakeSelector(absl::string_view& input) {
  if (input.empty()) return 0;
  const uint8_t selector = static_cast<uint8_t>(input.front());
  input.remove_prefix(1);
  return selector;
}

// A stream of messages: each after its length, 2 bytes, little-endian. The last one may be cut
// short.
inline std::vector<absl::string_view> Messages(absl::string_view input) {
  std::vector<absl::string_view> messages;
  while (input.size() >= 2) {
    const size_t size = static_cast<uint8_t>(input[0]) | static_cast<uint8_t>(input[1]) << 8;
    input.remove_prefix(2);
    messages.push_back(input.substr(0, size));
    input.remove_prefix(std::min(size, input.size()));
  }
  return messages;
}

// Text files one after the other, "%%" on a line of its own between them.
inline std::vector<std::string> Files(absl::string_view input) {
  return absl::StrSplit(input, "%%\n");
}

}  // namespace overtone::fuzz

#endif  // OVERTONE_TESTS_FUZZ_FUZZ_INPUT_H_
