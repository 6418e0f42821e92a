#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The reference of the public headers, as HTML. Doxygen's warnings are errors, but for two kinds of declarations that may go without
# a comment: members whose name says it all, and what stands in core.
#   docs/doxygen/run.sh OUTPUT_FOLDER
set -eu
[ $# = 1 ] || { echo "usage: $0 OUTPUT_FOLDER" >&2; exit 2; }
mkdir -p "$1"
output=$(cd "$1" && pwd)
cd "$(dirname "$0")/../.."
{ cat docs/doxygen/Doxyfile; echo "OUTPUT_DIRECTORY = \"$output\""; } | doxygen - 2>"$output/warnings.txt"
warnings=$(grep -v '^ *$' "$output/warnings.txt" |
  grep -vE '\((variable|enumvalue)\) of .* is not documented|/core/[^ ]* warning: .* is not documented' || true)
[ -z "$warnings" ] || { echo "$warnings" >&2; exit 1; }
echo "$output/html/index.html"
