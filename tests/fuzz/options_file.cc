// SPDX-License-Identifier: Apache-2.0
// The server's configuration file.
#include "overtone/services/mapping_server/options_file.h"

#include "overtone/tests/fuzz/memory_file.h"

namespace overtone::fuzz {
namespace {

void Run(absl::string_view input) {
  ServerOptions options;
  OptionSources sources;
  const absl::Status status = ReadOptionsFile(MemoryFile(input).path(), options, sources);
  if (!status.ok()) {
    FUZZ_CHECK(absl::IsInvalidArgument(status), status.ToString());
    return;
  }
  (void)options.Validate();
  OptionValues(options);
}

}  // namespace
}  // namespace overtone::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  overtone::fuzz::Run(overtone::fuzz::AsText(data, size));
  return 0;
}
