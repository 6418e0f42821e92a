# SPDX-License-Identifier: Apache-2.0
# What OVERTONE_SANITIZE=address,undefined or =thread means for the compiler.
set(flags -fsanitize=${OVERTONE_SANITIZE} -fno-omit-frame-pointer)
if(OVERTONE_SANITIZE MATCHES "undefined")
  # The first finding ends the test. AddressSanitizer finds what null and object-size look for; these two and vptr are
  # half of the compiler's work on gRPC's headers.
  list(APPEND flags -fno-sanitize-recover=undefined -fno-sanitize=null,object-size,vptr)
endif()
if(OVERTONE_BUILD_FUZZERS)
  # Counts edges in the libraries, too; tests link the same ones.
  list(APPEND flags -fsanitize=fuzzer-no-link)
endif()
# -O1: the fastest to build that is still fast enough to run. Assertions are on (no NDEBUG), Eigen's bounds checks among them.
add_compile_options(-O1 -g1 ${flags})
add_link_options(${flags})

# Debian's protobuf, abseil and gRPC are built without instrumentation: a vector that they grow and we read looks overrun
# to AddressSanitizer's container checks, and is not. And what their own memcpy and free do is no race of ours.
set(OVERTONE_TEST_ENVIRONMENT ASAN_OPTIONS=detect_container_overflow=0 UBSAN_OPTIONS=print_stacktrace=1
  LSAN_OPTIONS=suppressions=${CMAKE_SOURCE_DIR}/tests/support/lsan_suppressions.txt:print_suppressions=0
  TSAN_OPTIONS=ignore_noninstrumented_modules=1:suppressions=${CMAKE_SOURCE_DIR}/tests/support/tsan_suppressions.txt)

if(OVERTONE_SANITIZE STREQUAL "thread")
  # In every executable, whose definitions the shared libraries then call, too.
  add_library(overtone_tsan_edges OBJECT tests/support/tsan_absl_mutex.cc tests/support/tsan_grpc_handover.cc)
  set(is_executable $<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>)
  target_sources(overtone_warnings INTERFACE $<${is_executable}:$<TARGET_OBJECTS:overtone_tsan_edges>>)
  add_link_options(-Wl,--export-dynamic-symbol=_ZN*4absl*,--export-dynamic-symbol=grpc_*,--export-dynamic-symbol=_ZN4grpc*ScheduleOnDone*)
endif()
