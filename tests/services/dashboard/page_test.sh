#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# page_test.sh NAME: runs page/NAME.mjs (CMakeLists.txt sets the paths). 77, skipped: something that it needs is not here.
set -eu
name=$1
here=$(cd "$(dirname "$0")" && pwd)

skip() { echo "SKIPPED: $1"; exit 77; }
command -v node >/dev/null || skip "no node"
[ "$(node -p 'process.versions.node.split(".")[0]')" -ge 18 ] || skip "node is older than 18"
if [ "$name" != functions ]; then
  [ -n "${PAGE_TEST_PAGE:-}" ] && [ -f "$PAGE_TEST_PAGE/index.html" ] || skip "the page was not built (no npm, or OVERTONE_BUILD_WEB is OFF)"
fi
case $name in
  page|live|speed)
    [ -d "$PAGE_TEST_WEB/node_modules/playwright-core" ] || skip "playwright-core is not installed (npm ci in $PAGE_TEST_WEB)"
    for candidate in "${CHROMIUM:-}" chromium chromium-browser google-chrome; do
      [ -n "$candidate" ] && CHROMIUM=$(command -v "$candidate") && break
    done
    [ -n "${CHROMIUM:-}" ] || skip "no Chromium"
    export CHROMIUM ;;
esac
exec node --test-reporter=spec --test "$here/page/$name.mjs"
