#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Runs every fault test that is built, one after the other, and prints their table.
#   tests/fault/run.sh [--full] [BUILD_DIR]     BUILD_DIR: build/dev
# --full: the long runs (500 kills, a minute's cut in real time, 10,000 stored submaps, an hour of soak). What is set in the
# environment stays as it is.
set -u
cd "$(dirname "$0")/../.."
build=build/dev
for argument; do
  case $argument in
    --full)
      : "${OVERTONE_TEST_KILLS:=500}" "${OVERTONE_TEST_LINK_REAL:=1}" "${OVERTONE_TEST_RESTARTS:=20}"
      : "${OVERTONE_TEST_RESTART_SUBMAPS:=10000}" "${OVERTONE_TEST_FAULT_RUNS:=3000}" "${OVERTONE_TEST_STORE_MUTATIONS:=50000}"
      : "${OVERTONE_TEST_SOAK_S:=3600}" "${OVERTONE_TEST_STALLED_REVISIONS:=300}"
      export OVERTONE_TEST_KILLS OVERTONE_TEST_LINK_REAL OVERTONE_TEST_RESTARTS OVERTONE_TEST_RESTART_SUBMAPS OVERTONE_TEST_FAULT_RUNS
      export OVERTONE_TEST_STORE_MUTATIONS OVERTONE_TEST_SOAK_S OVERTONE_TEST_STALLED_REVISIONS
      ;;
    *) build=$argument ;;
  esac
done

OVERTONE_TEST_FAULT_TABLE=$(mktemp)
export OVERTONE_TEST_FAULT_TABLE
trap 'rm -f "$OVERTONE_TEST_FAULT_TABLE"' EXIT
ctest --test-dir "$build" --label-regex '^fault$' --output-on-failure --parallel 1
result=$?
echo
echo "| test | what | figure |"
echo "|---|---|---|"
cat "$OVERTONE_TEST_FAULT_TABLE"
exit $result
