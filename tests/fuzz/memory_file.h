// SPDX-License-Identifier: Apache-2.0
// Files without a disk, for readers that take a path.
#ifndef OVERTONE_TESTS_FUZZ_MEMORY_FILE_H_
#define OVERTONE_TESTS_FUZZ_MEMORY_FILE_H_

#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "absl/strings/string_view.h"
#include "overtone/tests/fuzz/fuzz_input.h"

namespace overtone::fuzz {

// One file, as long as it lives. Its name has no suffix.
class MemoryFile {
 public:
  explicit MemoryFile(absl::string_view content)
      : descriptor_(memfd_create("fuzz", 0)),
        path_("/proc/self/fd/" + std::to_string(descriptor_)) {
    const bool written = descriptor_ >= 0 && write(descriptor_, content.data(), content.size()) ==
                                                 static_cast<ssize_t>(content.size());
    FUZZ_CHECK(written, "no memory file");
  }
  ~MemoryFile() { close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  const std::string& path() const { return path_; }

 private:
  const int descriptor_;
  const std::string path_;
};

// A folder of this process's own, below TMPDIR: in memory when that is. Removed at the end.
class MemoryFolder {
 public:
  explicit MemoryFolder(const std::string& name)
      : path_(std::filesystem::temp_directory_path() / ("fuzz_" + std::to_string(getpid())) /
              name) {
    std::filesystem::create_directories(path_);
  }
  ~MemoryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
    std::filesystem::remove(path_.parent_path(), ignored);  // when it was the last
  }
  MemoryFolder(const MemoryFolder&) = delete;
  MemoryFolder& operator=(const MemoryFolder&) = delete;

  std::string path() const { return path_.string(); }

  std::string Write(const std::string& name, absl::string_view content) const {
    const std::filesystem::path file = path_ / name;
    std::ofstream(file, std::ios::binary) << content;
    return file.string();
  }

  // The files named that there is content for; the others are not there.
  void Replace(const std::vector<std::string>& names,
               const std::vector<std::string>& contents) const {
    for (size_t i = 0; i < names.size(); ++i) {
      if (i < contents.size()) {
        Write(names[i], contents[i]);
      } else {
        std::error_code ignored;
        std::filesystem::remove(path_ / names[i], ignored);
      }
    }
  }

 private:
  const std::filesystem::path path_;
};

}  // namespace overtone::fuzz

#endif  // OVERTONE_TESTS_FUZZ_MEMORY_FILE_H_
