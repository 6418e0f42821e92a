// SPDX-License-Identifier: Apache-2.0
#include "overtone/tests/support/largest_allocation.h"

#include <atomic>
#include <cstdlib>
#include <new>

namespace overtone::testing {
namespace {

std::atomic<size_t> largest{0};

void Note(size_t bytes) {
  size_t seen = largest.load(std::memory_order_relaxed);
  while (bytes > seen && !largest.compare_exchange_weak(seen, bytes)) {
  }
}

}  // namespace

size_t TakeLargestAllocation() { return largest.exchange(0); }

void* Allocate(size_t bytes) {
  Note(bytes);
  void* memory = std::malloc(bytes);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace overtone::testing

void* operator new(size_t bytes) { return overtone::testing::Allocate(bytes); }
void* operator new[](size_t bytes) { return overtone::testing::Allocate(bytes); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, size_t) noexcept { std::free(memory); }
