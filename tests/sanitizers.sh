#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds and runs what the sanitizers look at, and prints how long each part took. After tests/run.sh, which installs what is missing.
#   tests/sanitizers.sh             what the gate has time for: the tests labelled concurrency under ASan and UBSan and under TSan,
#                                   and every fuzz target; each part only if it begins within 12 minutes of GATE_STARTED
#   tests/sanitizers.sh asan        ASan and UBSan: unit and integration tests, but those labelled numeric (arithmetic on numbers
#                                   of our own) and fault
#   tests/sanitizers.sh asan-all    those, too
#   tests/sanitizers.sh fuzz        every fuzz target, FUZZ_SECONDS (60) in all
#   tests/sanitizers.sh tsan        TSan: the tests labelled concurrency
set -eu
cd "$(dirname "$0")/.."
jobs=$(awk -v cores="$(nproc)" '/MemAvailable/ { n = int($2 / 1500000); print n < 1 ? 1 : n < cores ? n : cores }' /proc/meminfo)
started=$(date +%s)

lap() {
  now=$(date +%s)
  echo "-- $1: $(( now - started )) s"
  started=$now
}

build() { # preset, targets...
  preset=$1
  shift
  cmake --preset "$preset" >/dev/null
  cmake --build --preset "$preset" --parallel "$jobs" --target "$@"
  lap "$preset built"
}

run() { # preset, what goes to ctest...
  preset=$1
  shift
  ctest --test-dir "build/$preset" --output-on-failure --parallel "$jobs" "$@"
  lap "$preset tests"
}

# Memory in use and the linked libraries are not those of a normal build.
not_under_asan='client_mapping_client_memory|packaging_.*'

asan() {
  build asan-ubsan outside_tests
  run asan-ubsan -LE 'numeric|fault' -E "$not_under_asan"
}

asan_all() {
  build asan-ubsan all
  run asan-ubsan -E "$not_under_asan"
}

fuzz() {
  build asan-ubsan fuzz_targets
  tests/fuzz/run.sh "${FUZZ_SECONDS:-60}"
  lap fuzzing
}

tsan() {
  build tsan concurrency_tests
  run tsan -L concurrency
}

# The gate has 40 minutes on two cores. Where nothing is compiled yet, the builds alone would take longer.
in_time() { # what
  elapsed=$(( $(date +%s) - ${GATE_STARTED:-$(date +%s)} ))
  [ "$elapsed" -ge 720 ] || return 0
  echo "-- $1: LEFT OUT after $elapsed s of compiling; tests/sanitizers.sh runs it"
  return 1
}

case ${1:-gate} in
  asan) asan ;;
  asan-all) asan_all ;;
  fuzz) fuzz ;;
  tsan) tsan ;;
  gate)
    if in_time "ASan, UBSan and fuzzing"; then
      build asan-ubsan concurrency_tests
      run asan-ubsan -L concurrency -LE numeric -E "$not_under_asan"
      fuzz
    fi
    if in_time TSan; then tsan; fi
    ;;
  *)
    echo "usage: $0 [asan|asan-all|fuzz|tsan]" >&2
    exit 2
    ;;
esac
