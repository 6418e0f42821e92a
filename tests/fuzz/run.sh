#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Runs every fuzz target for its share of the time on its examples, and prints what came of it. The corpus stays as it is.
#   tests/fuzz/run.sh [SECONDS in all, default 60] [EXECUTIONS each, default as many as fit]
#   BUILD=build/fuzz tests/fuzz/run.sh 3600     another build
#   TARGETS="uploads requests" ...              only these
#   KEEP=/tmp/corpora ...                       goes on from what an earlier run found worth keeping, and adds to it
#   TIMEOUT=120 ...                             seconds by the clock for one input, for a machine that does other things, too
# A crash, a leak, a broken law, an input that takes 10 s or 1 GiB: the input is named, kept, and the exit code is 1.
set -u
cd "$(dirname "$0")/../.." || exit 2
total=${1:-60}
executions=${2:--1}
build=${BUILD:-build/asan-ubsan}
all=$(cd tests/fuzz && ls *.cc | sed 's/\.cc$//' | grep -v make_corpus)
targets=${TARGETS:-$all}
work=$(mktemp -d)
trap 'rm -rf "$work" "$files"' EXIT INT TERM
# Readers that take a path: files in memory where there is such a place.
files=$(mktemp -d -p /dev/shm 2>/dev/null || mktemp -d)
export TMPDIR="$files"
found=${FOUND:-build/fuzz-found}

# Debian's protobuf, abseil and gRPC are built without instrumentation: a vector that they grow and we read looks
# overrun to the container checks, and is not. What one input frees need not be kept for the next ones: a small
# quarantine stays in the processor's cache.
export ASAN_OPTIONS=detect_container_overflow=0:allocator_may_return_null=0:detect_leaks=1:quarantine_size_mb=8
export UBSAN_OPTIONS=print_stacktrace=1
export LSAN_OPTIONS=suppressions=tests/support/lsan_suppressions.txt:print_suppressions=0

# shellcheck disable=SC2086
share=$(( total / $(echo $targets | wc -w) ))
[ "$share" -gt 0 ] || share=1
failed=0
printf '%-20s %12s %10s   %s\n' target executions exec/s result
for target in $targets; do
  log=$work/$target.log
  grown=${KEEP:-$work}/$target
  mkdir -p "$grown" "$found/$target"
  if "$build/tests/fuzz/fuzz_$target" -max_total_time="$share" -runs="$executions" -timeout="${TIMEOUT:-10}" -rss_limit_mb=1024 \
    -max_len=4096 -print_final_stats=1 -artifact_prefix="$found/$target/" "$grown" "tests/fuzz/corpus/$target" >"$log" 2>&1
  then
    result=clean
  else
    result="FAILED: $(grep -o "Test unit written to .*" "$log" | head -1)"
    failed=1
  fi
  awk -v target="$target" -v result="$result" '
    /stat::number_of_executed_units/ { executed = $2 }
    /stat::average_exec_per_sec/ { rate = $2 }
    END { printf "%-20s %12d %10d   %s\n", target, executed, rate, result }' "$log"
  [ "$result" = clean ] || tail -60 "$log"
done
exit $failed
