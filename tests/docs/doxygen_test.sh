#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The reference of the public headers is made without a warning, and holds what our plain comments say; a public function without a
# comment fails.
#   doxygen_test.sh SOURCE_DIR
set -eu
source=$1
command -v doxygen >/dev/null || { echo "skipped: doxygen is not installed"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() {
  echo "$*" >&2
  exit 1
}

"$source/docs/doxygen/run.sh" "$work/output"
page=$work/output/html/classovertone_1_1HostEstimator.html
grep -q 'Applies a batch at once' "$page" || fail "the comment above ApplyConstraints is not in $page"
grep -q 'frames or heartbeats arrive' "$work"/output/html/*.html || fail "the comment behind kLive is nowhere"

mkdir "$work/copy"
cp -r "$source/client" "$source/core" "$source/docs" "$work/copy"
header=$work/copy/client/host_estimator.h
sed -i 's|^  virtual void OnLinkState|  void Undescribed();\n&|; /Whenever it changes/d' "$header"
"$work/copy/docs/doxygen/run.sh" "$work/output" 2>"$work/errors" && fail "a function without a comment passes"
grep -q 'Undescribed.*not documented' "$work/errors" || fail "$(cat "$work/errors")"
