// SPDX-License-Identifier: Apache-2.0
// A store's file with bytes of it changed: it opens and is replayed, whatever they say. The input
// is a list of changes, four bytes each: two say where (in units of the file's size / 65536), the
// third in which of so many bytes, the fourth is the new value.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "overtone/services/mapping_server/submap_store/sqlite_submap_store.h"
#include "overtone/tests/fuzz/memory_file.h"
#include "spdlog/spdlog.h"

namespace overtone::fuzz {
namespace {

std::string ReadStore() {
  spdlog::set_level(spdlog::level::off);
  std::ifstream in(OVERTONE_SOURCE_DIR "/tests/data/store/v1.db", std::ios::binary);
  std::string content((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  FUZZ_CHECK(!content.empty(), "no store to begin with");
  return content;
}

SubmapStore::Sink NoSink() {
  SubmapStore::Sink sink;
  sink.on_submap = [](const MissionId&, const std::shared_ptr<const Submap>&) {};
  sink.on_loop_closure = [](const LoopClosure&) {};
  sink.on_finding = [](const std::string&) {};
  sink.on_cloud = [](const MissionId&, int64_t, const std::string&) {};
  sink.on_cloud_gone = [](const MissionId&, int64_t) {};
  return sink;
}

void Run(const uint8_t* data, size_t size) {
  static const std::string store = ReadStore();
  static const MemoryFolder folder("store_file");
  std::string changed = store;
  for (; size >= 4; data += 4, size -= 4) {
    const size_t unit = (256 * data[0] + data[1]) * store.size() / 65536;
    changed[(unit + data[2] % 8) % store.size()] = static_cast<char>(data[3]);
  }
  for (const auto& left : std::filesystem::directory_iterator(folder.path())) {
    std::filesystem::remove(left.path());
  }
  const std::string path = folder.Write("map.db", changed);
  auto opened = SqliteSubmapStore::Open(path, ServerLimits(), NoSink());
  if (!opened.ok()) return;
  if (!(*opened)->Replay().ok()) return;
  (void)(*opened)->GetSnapshot();
  (void)(*opened)->Verify();
}

}  // namespace
}  // namespace overtone::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  overtone::fuzz::Run(data, size);
  return 0;
}
