#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# What every Dockerfile does with the sources: configures PRESET, builds TARGETS, and runs the unit tests where TESTS is ON.
#   docker/build.sh PRESET TARGET...
set -eu
cd "$(dirname "$0")/.."
preset=$1
shift
export LANG=C.UTF-8 # ccache tells locales apart: one for all images, and hosts' usual one
# Parallel compilations of gRPC code need about 1.5 GB each.
jobs=$(awk -v cores="$(nproc)" '/MemAvailable/ { n = int($2 / 1500000); print n < 1 ? 1 : n < cores ? n : cores }' /proc/meminfo)

tests=OFF
[ "${TESTS:-}" != ON ] || tests=ON
cmake --preset "$preset" -DOVERTONE_BUILD_TESTS=$tests >/dev/null
cmake --build --preset "$preset" --parallel "$jobs" --target "$@"
if [ $tests = ON ]; then
  cmake --build --preset "$preset" --parallel "$jobs"
  ctest --test-dir "build/$preset" --output-on-failure --parallel "$jobs" -R '^(core|proto|client|cli|services)_' -LE 'integration|fault|data'
fi
ccache --show-stats | grep -i hits | head -n 1 || true
