// SPDX-License-Identifier: Apache-2.0
// The access file.
#include "overtone/services/mapping_server/security/access_file.h"

#include "overtone/tests/fuzz/memory_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const overtone::fuzz::MemoryFile file(overtone::fuzz::AsText(data, size));
  const auto rules = overtone::ReadAccessFile(file.path());
  // Whom a good file names for a map, it lets read it.
  if (!rules.ok()) return 0;
  for (const auto& [map, grants] : rules->maps) {
    for (const std::string& robot : grants.robots) {
      if (robot == "*" || map == "*") continue;
      const absl::Status may = rules->MayRead({overtone::PeerRole::kRobot, robot}, map);
      FUZZ_CHECK(may.ok(), may.ToString());
    }
  }
  return 0;
}
