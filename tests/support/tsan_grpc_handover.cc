// SPDX-License-Identifier: Apache-2.0
// Tells ThreadSanitizer how gRPC hands things from thread to thread, in tests under it and nowhere
// else: see tsan_absl_mutex.cc. Debian's libgrpc is not instrumented, and its queues are free of
// locks.
//
//   who starts an operation         happens before whoever is told that it is done, by its tag
//   a server's reaction             happens before the call's OnDone
//   the end of a call (its OnDone)  happens before the end of its server
//
// and no more: touching what an operation still uses remains a race.
#include <dlfcn.h>
#include <sanitizer/tsan_interface.h>

#include <cstdio>
#include <cstdlib>

#include "grpc/grpc.h"
#include "grpcpp/support/server_callback.h"

namespace {

// Libgrpc's own.
template <typename Function>
Function* Next(const char* symbol, Function*) {
  void* const found = dlsym(RTLD_NEXT, symbol);
  if (found == nullptr) {
    std::fprintf(stderr, "tsan_grpc_handover.cc: gRPC has no %s\n", symbol);
    std::abort();
  }
  return reinterpret_cast<Function*>(found);
}

char calls;  // its address stands for all calls that have ended

}  // namespace

extern "C" {

grpc_call_error grpc_call_start_batch(grpc_call* call, const grpc_op* ops, size_t count, void* tag,
                                      void* reserved) {
  static auto* const next = Next("grpc_call_start_batch", &grpc_call_start_batch);
  __tsan_release(tag);
  return next(call, ops, count, tag, reserved);
}

grpc_event grpc_completion_queue_next(grpc_completion_queue* queue, gpr_timespec deadline,
                                      void* reserved) {
  static auto* const next = Next("grpc_completion_queue_next", &grpc_completion_queue_next);
  const grpc_event event = next(queue, deadline, reserved);
  if (event.type == GRPC_OP_COMPLETE) __tsan_acquire(event.tag);
  return event;
}

grpc_event grpc_completion_queue_pluck(grpc_completion_queue* queue, void* tag,
                                       gpr_timespec deadline, void* reserved) {
  static auto* const next = Next("grpc_completion_queue_pluck", &grpc_completion_queue_pluck);
  const grpc_event event = next(queue, tag, deadline, reserved);
  if (event.type == GRPC_OP_COMPLETE) __tsan_acquire(tag);
  return event;
}

void grpc_call_unref(grpc_call* call) {
  static auto* const next = Next("grpc_call_unref", &grpc_call_unref);
  __tsan_release(&calls);
  next(call);
}

void grpc_server_destroy(grpc_server* server) {
  static auto* const next = Next("grpc_server_destroy", &grpc_server_destroy);
  __tsan_acquire(&calls);
  next(server);
}

}  // extern "C"

namespace grpc::internal {

// Every reaction counts down when it is through, some of them inside of libgrpc++; the last of them
// comes here.
void ServerCallbackCall::ScheduleOnDone(bool inline_ondone) {
  static auto* const next = Next("_ZN4grpc8internal18ServerCallbackCall14ScheduleOnDoneEb",
                                 static_cast<void (*)(ServerCallbackCall*, bool)>(nullptr));
  __tsan_acquire(&callbacks_outstanding_);
  next(this, inline_ondone);
}

}  // namespace grpc::internal
