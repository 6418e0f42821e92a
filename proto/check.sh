#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Checks the wire schema with buf: STANDARD lint, and no FILE-breaking change since the last release (before the first
# one: since the previous commit).
set -eu
cd "$(dirname "$0")/.."
tools=build/tools
buf=$tools/node_modules/.bin/buf
[ -x "$buf" ] || npm install --loglevel=error --no-audit --no-fund --prefix "$tools" @bufbuild/buf@1.75.0

"$buf" lint
base=$(git describe --tags --abbrev=0 --match 'v*' 2>/dev/null || git rev-parse --verify --quiet HEAD~1 || true)
if [ -n "$base" ] && git cat-file -e "$base:buf.yaml" 2>/dev/null; then
  "$buf" breaking --against ".git#ref=$base"
  echo "proto: lint clean, nothing broken since $base"
else
  echo "proto: lint clean; no earlier schema to compare with"
fi
