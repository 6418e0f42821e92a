// SPDX-License-Identifier: Apache-2.0
#include "overtone/tests/support/fault_vfs.h"

#include <algorithm>
#include <fstream>
#include <new>
#include <utility>

#include "sqlite3.h"

namespace overtone {
namespace {

constexpr int64_t kSectorBytes = 512;

sqlite3_vfs* System() {
  static sqlite3_vfs* const vfs = sqlite3_vfs_find("unix");
  return vfs;
}

// SQLite allocates szOsFile bytes: this, then the system's own file.
struct ShimFile {
  sqlite3_file base;
  std::string* path;
  sqlite3_file* real() { return reinterpret_cast<sqlite3_file*>(this + 1); }
};

ShimFile* Of(sqlite3_file* file) { return reinterpret_cast<ShimFile*>(file); }
const sqlite3_io_methods& Real(sqlite3_file* file) { return *Of(file)->real()->pMethods; }

int Close(sqlite3_file* file) {
  const int result = Real(file).xClose(Of(file)->real());
  delete Of(file)->path;
  return result;
}
int Read(sqlite3_file* file, void* bytes, int size, sqlite3_int64 offset) {
  const int result = Real(file).xRead(Of(file)->real(), bytes, size, offset);
  if (result == SQLITE_OK) FaultVfs::Instance().OnRead(static_cast<char*>(bytes), size);
  return result;
}
int Write(sqlite3_file* file, const void* bytes, int size, sqlite3_int64 offset) {
  const std::string content(static_cast<const char*>(bytes), static_cast<size_t>(size));
  const int error = FaultVfs::Instance().OnWrite(*Of(file)->path, offset, content);
  return error != SQLITE_OK ? error : Real(file).xWrite(Of(file)->real(), bytes, size, offset);
}
int Truncate(sqlite3_file* file, sqlite3_int64 size) {
  const int error = FaultVfs::Instance().OnTruncate(*Of(file)->path, size);
  return error != SQLITE_OK ? error : Real(file).xTruncate(Of(file)->real(), size);
}
int Sync(sqlite3_file* file, int) { return FaultVfs::Instance().OnSync(*Of(file)->path); }
int FileSize(sqlite3_file* file, sqlite3_int64* size) {
  return Real(file).xFileSize(Of(file)->real(), size);
}
int Lock(sqlite3_file* file, int lock) { return Real(file).xLock(Of(file)->real(), lock); }
int Unlock(sqlite3_file* file, int lock) { return Real(file).xUnlock(Of(file)->real(), lock); }
int CheckReservedLock(sqlite3_file* file, int* result) {
  return Real(file).xCheckReservedLock(Of(file)->real(), result);
}
int FileControl(sqlite3_file* file, int operation, void* argument) {
  // Sizes in advance and mapped memory would go around us.
  if (operation == SQLITE_FCNTL_SIZE_HINT || operation == SQLITE_FCNTL_CHUNK_SIZE ||
      operation == SQLITE_FCNTL_MMAP_SIZE) {
    return SQLITE_NOTFOUND;
  }
  return Real(file).xFileControl(Of(file)->real(), operation, argument);
}
int SectorSize(sqlite3_file*) { return kSectorBytes; }
int DeviceCharacteristics(sqlite3_file*) { return 0; }
int ShmMap(sqlite3_file* file, int page, int size, int extend, void volatile** memory) {
  return Real(file).xShmMap(Of(file)->real(), page, size, extend, memory);
}
int ShmLock(sqlite3_file* file, int offset, int count, int flags) {
  return Real(file).xShmLock(Of(file)->real(), offset, count, flags);
}
void ShmBarrier(sqlite3_file* file) { Real(file).xShmBarrier(Of(file)->real()); }
int ShmUnmap(sqlite3_file* file, int remove) {
  return Real(file).xShmUnmap(Of(file)->real(), remove);
}

const sqlite3_io_methods kMethods = {
    /*iVersion=*/2,
    Close,
    Read,
    Write,
    Truncate,
    Sync,
    FileSize,
    Lock,
    Unlock,
    CheckReservedLock,
    FileControl,
    SectorSize,
    DeviceCharacteristics,
    ShmMap,
    ShmLock,
    ShmBarrier,
    ShmUnmap};

int Open(sqlite3_vfs*, const char* path, sqlite3_file* file, int flags, int* out_flags) {
  ShimFile* shim = Of(file);
  shim->base.pMethods = nullptr;
  const int result = System()->xOpen(System(), path, shim->real(), flags, out_flags);
  if (result != SQLITE_OK) return result;
  shim->path = new std::string(path == nullptr ? "" : path);
  shim->base.pMethods = &kMethods;
  return SQLITE_OK;
}
int Delete(sqlite3_vfs*, const char* path, int) {
  // A name that goes is a name's change, not content: once the power is off, it stays.
  if (FaultVfs::Instance().power_is_off()) return SQLITE_IOERR_DELETE;
  FaultVfs::Instance().OnDelete(path);
  return System()->xDelete(System(), path, /*syncDir=*/0);
}
int Access(sqlite3_vfs*, const char* path, int flags, int* result) {
  return System()->xAccess(System(), path, flags, result);
}
int FullPathname(sqlite3_vfs*, const char* path, int size, char* full) {
  return System()->xFullPathname(System(), path, size, full);
}
int Randomness(sqlite3_vfs*, int size, char* bytes) {
  return System()->xRandomness(System(), size, bytes);
}
int Sleep(sqlite3_vfs*, int microseconds) { return System()->xSleep(System(), microseconds); }
int CurrentTime(sqlite3_vfs*, double* time) { return System()->xCurrentTime(System(), time); }
int GetLastError(sqlite3_vfs*, int size, char* text) {
  return System()->xGetLastError(System(), size, text);
}
int CurrentTimeInt64(sqlite3_vfs*, sqlite3_int64* time) {
  return System()->xCurrentTimeInt64(System(), time);
}

}  // namespace

FaultVfs& FaultVfs::Instance() {
  static FaultVfs* const instance = new FaultVfs;
  return *instance;
}

FaultVfs::FaultVfs() {
  sqlite3_initialize();
  static sqlite3_vfs vfs = {};
  vfs.iVersion = 2;
  vfs.szOsFile = static_cast<int>(sizeof(ShimFile)) + System()->szOsFile;
  vfs.mxPathname = System()->mxPathname;
  vfs.zName = name();
  vfs.xOpen = Open;
  vfs.xDelete = Delete;
  vfs.xAccess = Access;
  vfs.xFullPathname = FullPathname;
  vfs.xRandomness = Randomness;
  vfs.xSleep = Sleep;
  vfs.xCurrentTime = CurrentTime;
  vfs.xGetLastError = GetLastError;
  vfs.xCurrentTimeInt64 = CurrentTimeInt64;
  sqlite3_vfs_register(&vfs, /*makeDflt=*/0);
}

void FaultVfs::Reset() {
  std::lock_guard<std::mutex> lock(mutex_);
  files_.clear();
  operations_ = 0;
  power_until_ = fail_from_ = fail_until_ = reads_until_flip_ = -1;
}

int64_t FaultVfs::operations() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return operations_;
}

void FaultVfs::CutPowerAfter(int64_t operations) {
  std::lock_guard<std::mutex> lock(mutex_);
  power_until_ = operations_ + operations;
}

bool FaultVfs::power_is_off() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return power_until_ >= 0 && operations_ >= power_until_;
}

void FaultVfs::FailAfter(int64_t operations, int code, int64_t times) {
  std::lock_guard<std::mutex> lock(mutex_);
  fail_from_ = operations_ + operations;
  fail_until_ = fail_from_ + times;
  fail_code_ = code;
}

void FaultVfs::FlipBitAfterReads(int64_t reads, std::mt19937 random) {
  std::lock_guard<std::mutex> lock(mutex_);
  reads_until_flip_ = reads;
  flip_random_ = random;
}

int FaultVfs::Pass() {
  if (power_until_ >= 0 && operations_ >= power_until_) return SQLITE_IOERR_WRITE;
  const int64_t operation = operations_++;
  return operation >= fail_from_ && operation < fail_until_ ? fail_code_ : SQLITE_OK;
}

int FaultVfs::OnWrite(const std::string& path, int64_t offset, const std::string& bytes) {
  std::lock_guard<std::mutex> lock(mutex_);
  if (const int error = Pass(); error != SQLITE_OK) return error;
  files_[path].pending.push_back({offset, 0, bytes});
  return SQLITE_OK;
}

int FaultVfs::OnTruncate(const std::string& path, int64_t size) {
  std::lock_guard<std::mutex> lock(mutex_);
  if (const int error = Pass(); error != SQLITE_OK) return error;
  files_[path].pending.push_back({-1, size, ""});
  return SQLITE_OK;
}

int FaultVfs::OnSync(const std::string& path) {
  std::lock_guard<std::mutex> lock(mutex_);
  if (const int error = Pass(); error != SQLITE_OK) return error;
  File& file = files_[path];
  for (const Change& change : file.pending) Apply(change, file.durable);
  file.pending.clear();
  file.ever_synced = true;
  return SQLITE_OK;
}

void FaultVfs::OnDelete(const std::string& path) {
  std::lock_guard<std::mutex> lock(mutex_);
  files_.erase(path);
}

void FaultVfs::OnRead(char* bytes, int64_t size) {
  std::lock_guard<std::mutex> lock(mutex_);
  if (reads_until_flip_ < 0 || reads_until_flip_-- > 0) return;
  const auto bit = std::uniform_int_distribution<int64_t>(0, 8 * size - 1)(flip_random_);
  bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ (1 << bit % 8));
}

void FaultVfs::Apply(const Change& change, std::string& content) {
  if (change.offset < 0) {
    content.resize(static_cast<size_t>(change.size), '\0');
    return;
  }
  const auto end = static_cast<size_t>(change.offset) + change.bytes.size();
  if (content.size() < end) content.resize(end, '\0');
  content.replace(static_cast<size_t>(change.offset), change.bytes.size(), change.bytes);
}

void FaultVfs::WriteSurvivors(const std::string& from, const std::string& to,
                              std::mt19937& random) {
  std::lock_guard<std::mutex> lock(mutex_);
  for (const auto& [path, file] : files_) {
    if (path.compare(0, from.size(), from) != 0) continue;
    if (!file.ever_synced && random() % 2 == 0) continue;
    std::string content = file.durable;
    for (Change change : file.pending) {
      const auto fate = random() % 4;
      if (fate == 0) continue;
      if (fate == 1 && change.offset >= 0) {
        const auto sectors = static_cast<int64_t>(change.bytes.size()) / kSectorBytes;
        change.bytes.resize(static_cast<size_t>(
            kSectorBytes * (sectors == 0 ? 0 : static_cast<int64_t>(random() % sectors))));
      }
      Apply(change, content);
    }
    std::ofstream(to + path.substr(from.size()), std::ios::binary) << content;
  }
}

}  // namespace overtone
