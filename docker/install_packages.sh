#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Installs the groups of docker/packages.txt that are named, and nothing when all of them are there.
#   docker/install_packages.sh client server
set -eu
list=$(dirname "$0")/packages.txt
[ $# -gt 0 ] || { echo "usage: $0 GROUP...   (groups: client server test sanitize lint benchmark prometheus container)" >&2; exit 2; }

missing=""
for group in "$@"; do
  for package in $(awk -v g="$group" '!/^#/ && $2 == g { print $1 }' "$list"); do
    # A newer npm that came with another Node.js serves as well as Debian's.
    [ "$package" = npm ] && command -v npm >/dev/null && continue
    [ "$package" = docker-compose ] && docker compose version >/dev/null 2>&1 && continue # the plugin
    dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing="$missing $package"
  done
done
[ -n "$missing" ] || exit 0

[ "$(id -u)" = 0 ] || { echo "$0: as root, please; missing:$missing" >&2; exit 1; }
echo "Installing:$missing"
export DEBIAN_FRONTEND=noninteractive
apt-get update -qq
# shellcheck disable=SC2086
apt-get install -y -qq --no-install-recommends $missing >/dev/null
