#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The main job on a built-in example, on a bare Debian 12, as root: installs what is missing, builds, and replays a simulated team of three
# robots through a mapping server. What follows goes to `overtone replay`:
#   client/cli/demo.sh --strategy uniform
set -eu
cd "$(dirname "$0")/../.."
docker/install_packages.sh client server

# Parallel compilations of gRPC code need about 1.5 GB each.
jobs=$(awk -v cores="$(nproc)" '/MemAvailable/ { n = int($2 / 1500000); print n < 1 ? 1 : n < cores ? n : cores }' /proc/meminfo)
cmake --preset release
cmake --build --preset release --parallel "$jobs" --target overtone_cli overtone_mapping_server
build/release/client/cli/overtone replay --dataset example --out run "$@"
