// SPDX-License-Identifier: Apache-2.0
// Tells ThreadSanitizer about absl::Mutex, in tests under it and nowhere else. Debian's abseil and
// gRPC are built without instrumentation, so that TSan sees none of the locking, and every access
// under a mutex looks like a race.
//
// An executable's definitions come before a shared library's: what is defined here is called
// instead of libabsl_synchronization's, by us and by libgrpc, and passes every call on, between the
// annotations that abseil itself makes when it is instrumented. What runs between pre_lock and
// post_lock, or between pre_unlock and post_unlock, is the mutex's own business and is not looked
// at; that covers Conditions, which abseil evaluates on whichever thread holds the lock.
//
// Not known here: that a reader awaits (nobody does), and which Signal wakes which Wait (the mutex
// orders them anyway).
#include <dlfcn.h>
#include <sanitizer/tsan_interface.h>

#include <cstdio>
#include <cstdlib>

#include "absl/synchronization/mutex.h"
#include "absl/synchronization/notification.h"

// As the compiler names a member of absl, in the inline namespace of Debian's abseil.
#define ABSL_SYMBOL(name) "_ZN4absl7debian3" name
#define ABSL_CONST_SYMBOL(name) "_ZNK4absl7debian3" name

namespace absl {
ABSL_NAMESPACE_BEGIN
namespace {

constexpr unsigned kWrite = 0;
constexpr unsigned kRead = __tsan_mutex_read_lock;

// The library's own.
template <typename Function>
Function* Next(const char* symbol) {
  void* const found = dlsym(RTLD_NEXT, symbol);
  if (found == nullptr) {
    std::fprintf(stderr, "tsan_absl_mutex.cc: abseil has no %s\n", symbol);
    std::abort();
  }
  return reinterpret_cast<Function*>(found);
}

// The library implements some of these functions with others of them, which come here as well: only
// the outermost is annotated.
thread_local int depth = 0;

class Locking {
 public:
  Locking(Mutex* mutex, unsigned flags) : mutex_(mutex), flags_(flags) {
    if (depth++ == 0) __tsan_mutex_pre_lock(mutex_, flags_);
  }
  ~Locking() {
    if (--depth == 0) __tsan_mutex_post_lock(mutex_, flags_, /*recursion=*/0);
  }
  void Failed() { flags_ |= __tsan_mutex_try_lock_failed; }

 private:
  Mutex* const mutex_;
  unsigned flags_;
};

class Unlocking {
 public:
  Unlocking(Mutex* mutex, unsigned flags) : mutex_(mutex), flags_(flags) {
    if (depth++ == 0) __tsan_mutex_pre_unlock(mutex_, flags_);
  }
  ~Unlocking() {
    if (--depth == 0) __tsan_mutex_post_unlock(mutex_, flags_);
  }

 private:
  Mutex* const mutex_;
  const unsigned flags_;
};

// Lets go of the mutex and takes it again: the while is the library's.
class Waiting {
 public:
  explicit Waiting(Mutex* mutex) : locking_(LetGo(mutex), kWrite) {}

 private:
  static Mutex* LetGo(Mutex* mutex) {
    Unlocking unlocking(mutex, kWrite);
    return mutex;
  }
  Locking locking_;
};

}  // namespace

Mutex::~Mutex() {
  static auto* const next = Next<void(Mutex*)>(ABSL_SYMBOL("5MutexD1Ev"));
  // After whoever unlocked it last: that they are through is often known from a count of references
  // in a library that we do not see into. Who locks it later still is a race.
  { Locking locking(this, kWrite); }
  { Unlocking unlocking(this, kWrite); }
  next(this);
  __tsan_mutex_destroy(this, 0);
}

void Mutex::Lock() {
  static auto* const next = Next<void(Mutex*)>(ABSL_SYMBOL("5Mutex4LockEv"));
  Locking locking(this, kWrite);
  next(this);
}

void Mutex::Unlock() {
  static auto* const next = Next<void(Mutex*)>(ABSL_SYMBOL("5Mutex6UnlockEv"));
  Unlocking unlocking(this, kWrite);
  next(this);
}

bool Mutex::TryLock() {
  static auto* const next = Next<bool(Mutex*)>(ABSL_SYMBOL("5Mutex7TryLockEv"));
  Locking locking(this, kWrite | __tsan_mutex_try_lock);
  const bool locked = next(this);
  if (!locked) locking.Failed();
  return locked;
}

void Mutex::ReaderLock() {
  static auto* const next = Next<void(Mutex*)>(ABSL_SYMBOL("5Mutex10ReaderLockEv"));
  Locking locking(this, kRead);
  next(this);
}

void Mutex::ReaderUnlock() {
  static auto* const next = Next<void(Mutex*)>(ABSL_SYMBOL("5Mutex12ReaderUnlockEv"));
  Unlocking unlocking(this, kRead);
  next(this);
}

bool Mutex::ReaderTryLock() {
  static auto* const next = Next<bool(Mutex*)>(ABSL_SYMBOL("5Mutex13ReaderTryLockEv"));
  Locking locking(this, kRead | __tsan_mutex_try_lock);
  const bool locked = next(this);
  if (!locked) locking.Failed();
  return locked;
}

void Mutex::LockWhen(const Condition& condition) {
  static auto* const next =
      Next<void(Mutex*, const Condition&)>(ABSL_SYMBOL("5Mutex8LockWhenERKNS0_9ConditionE"));
  Locking locking(this, kWrite);
  next(this, condition);
}

bool Mutex::LockWhenWithTimeout(const Condition& condition, Duration timeout) {
  static auto* const next = Next<bool(Mutex*, const Condition&, Duration)>(
      ABSL_SYMBOL("5Mutex19LockWhenWithTimeoutERKNS0_9ConditionENS0_8DurationE"));
  Locking locking(this, kWrite);
  return next(this, condition, timeout);
}

bool Mutex::LockWhenWithDeadline(const Condition& condition, Time deadline) {
  static auto* const next = Next<bool(Mutex*, const Condition&, Time)>(
      ABSL_SYMBOL("5Mutex20LockWhenWithDeadlineERKNS0_9ConditionENS0_4TimeE"));
  Locking locking(this, kWrite);
  return next(this, condition, deadline);
}

void Mutex::Await(const Condition& condition) {
  static auto* const next =
      Next<void(Mutex*, const Condition&)>(ABSL_SYMBOL("5Mutex5AwaitERKNS0_9ConditionE"));
  Waiting waiting(this);
  next(this, condition);
}

bool Mutex::AwaitWithTimeout(const Condition& condition, Duration timeout) {
  static auto* const next = Next<bool(Mutex*, const Condition&, Duration)>(
      ABSL_SYMBOL("5Mutex16AwaitWithTimeoutERKNS0_9ConditionENS0_8DurationE"));
  Waiting waiting(this);
  return next(this, condition, timeout);
}

bool Mutex::AwaitWithDeadline(const Condition& condition, Time deadline) {
  static auto* const next = Next<bool(Mutex*, const Condition&, Time)>(
      ABSL_SYMBOL("5Mutex17AwaitWithDeadlineERKNS0_9ConditionENS0_4TimeE"));
  Waiting waiting(this);
  return next(this, condition, deadline);
}

void CondVar::Wait(Mutex* mutex) {
  static auto* const next = Next<void(CondVar*, Mutex*)>(ABSL_SYMBOL("7CondVar4WaitEPNS0_5MutexE"));
  Waiting waiting(mutex);
  next(this, mutex);
}

bool CondVar::WaitWithTimeout(Mutex* mutex, Duration timeout) {
  static auto* const next = Next<bool(CondVar*, Mutex*, Duration)>(
      ABSL_SYMBOL("7CondVar15WaitWithTimeoutEPNS0_5MutexENS0_8DurationE"));
  Waiting waiting(mutex);
  return next(this, mutex, timeout);
}

bool CondVar::WaitWithDeadline(Mutex* mutex, Time deadline) {
  static auto* const next = Next<bool(CondVar*, Mutex*, Time)>(
      ABSL_SYMBOL("7CondVar16WaitWithDeadlineEPNS0_5MutexENS0_4TimeE"));
  Waiting waiting(mutex);
  return next(this, mutex, deadline);
}

// A waiter that comes late looks at an atomic of the library's and takes no lock.
void Notification::Notify() {
  static auto* const next = Next<void(Notification*)>(ABSL_SYMBOL("12Notification6NotifyEv"));
  __tsan_release(this);
  next(this);
}

void Notification::WaitForNotification() const {
  static auto* const next =
      Next<void(const Notification*)>(ABSL_CONST_SYMBOL("12Notification19WaitForNotificationEv"));
  next(this);
  __tsan_acquire(const_cast<Notification*>(this));
}

bool Notification::WaitForNotificationWithTimeout(Duration timeout) const {
  static auto* const next = Next<bool(const Notification*, Duration)>(
      ABSL_CONST_SYMBOL("12Notification30WaitForNotificationWithTimeoutENS0_8DurationE"));
  const bool notified = next(this, timeout);
  if (notified) __tsan_acquire(const_cast<Notification*>(this));
  return notified;
}

ABSL_NAMESPACE_END
}  // namespace absl
