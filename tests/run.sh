#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Installs what is missing, checks schema and format, builds everything, runs what the sanitizers look at (sanitizers.sh), and
# then every test. On a bare Debian 12, as root:
#   tests/run.sh                 all tests
#   tests/run.sh -LE data        what follows goes to ctest; without the sanitizers
set -eu
cd "$(dirname "$0")/.."
GATE_STARTED=$(date +%s)
export GATE_STARTED
docker/install_packages.sh client server test lint sanitize
# Where a Docker engine answers, the images are built and used, too.
! timeout 20 docker info >/dev/null 2>&1 || docker/install_packages.sh container

proto/check.sh
tests/k8s/install_schemas.sh
git ls-files '*.cc' '*.h' | xargs clang-format --dry-run --Werror

# Parallel compilations of gRPC code need about 1.5 GB each.
jobs=$(awk -v cores="$(nproc)" '/MemAvailable/ { n = int($2 / 1500000); print n < 1 ? 1 : n < cores ? n : cores }' /proc/meminfo)
cmake --preset dev
cmake --build --preset dev --parallel "$jobs"
[ $# -gt 0 ] || tests/sanitizers.sh
ctest --test-dir build/dev --output-on-failure --parallel 2 "$@"
