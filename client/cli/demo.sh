#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The main job, on a bare Debian 12, as root: installs what is missing, builds, drives a simulated team of four robots with LiDAR
# through tunnels, a built-up grid and a cave, and plays what they measured through a mapping server, which finds the loop closures
# itself. What follows goes to `overtone replay`:
#   client/cli/demo.sh --strategy uniform
set -eu
cd "$(dirname "$0")/../.."
docker/install_packages.sh client server

# Parallel compilations of gRPC code need about 1.5 GB each.
jobs=$(awk -v cores="$(nproc)" '/MemAvailable/ { n = int($2 / 1500000); print n < 1 ? 1 : n < cores ? n : cores }' /proc/meminfo)
cmake --preset release
cmake --build --preset release --parallel "$jobs" --target overtone_cli overtone_mapping_server
overtone=build/release/client/cli/overtone
rm -rf run/team  # of an earlier demo: a simulation is only written to a new folder
"$overtone" simulate --scenario subterranean --out run/team
"$overtone" replay --dataset pcd run/team --out run "$@"
