// SPDX-License-Identifier: Apache-2.0
// The access file.
#include "overtone/services/mapping_server/security/access_file.h"

#include "overtone/tests/fuzz/memory_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const overtone::fuzz::MemoryFile file(overtone::fuzz::AsText(data, size));
  const auto rules = overtone::ReadAccessFile(file.path());
  // A good file grants nothing to those that it revokes.
  if (!rules.ok()) return 0;
  for (const overtone::PeerIdentity& peer : rules->revoked) {
    for (const auto& [map, grants] : rules->maps) {
      FUZZ_CHECK(!rules->MayRead(peer, map).ok(), "revoked, and reads " + map);
    }
  }
  return 0;
}
