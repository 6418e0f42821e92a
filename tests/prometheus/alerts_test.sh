#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The alert rules and the configuration as promtool (Debian's package prometheus) judges them, and that each alert is in
# the tests and says what to do.
set -eu
cd "$(dirname "$0")/../.."
rules=docker/prometheus/alerts.yml
tests=tests/prometheus/alerts_test.yml
command -v promtool >/dev/null || { echo "SKIPPED: no promtool"; exit 77; }
promtool check config docker/prometheus/prometheus.yml
promtool check rules "$rules"
promtool test rules "$tests"
failed=0
for alert in $(sed -n 's/^ *- alert: //p' "$rules"); do
  grep -q "$alert" "$tests" || { echo "$alert: not in $tests"; failed=1; }
done
count() { grep -c "^ *$1:" "$rules" || true; }
alerts=$(grep -c '^ *- alert:' "$rules")
for part in summary description; do
  [ "$(count $part)" -eq "$alerts" ] || { echo "$alerts alerts, but not as many with a $part"; failed=1; }
done
# What the rules speak of is in the table of metrics; a histogram's parts are.
for metric in $(grep -o '\b\(overtone\|process\)_[a-z_]*' "$rules" | grep -v '_\(bucket\|count\|sum\)$' | sort -u); do
  grep -q "^| \`$metric\` " docs/metrics.md || { echo "$metric: not in docs/metrics.md"; failed=1; }
done
for metric in $(grep -o '\bovertone_[a-z_]*_\(bucket\|count\|sum\)\b' "$rules" | sed 's/_[a-z]*$//' | sort -u); do
  grep -q "^| \`$metric\` | histogram " docs/metrics.md || { echo "$metric: no histogram in docs/metrics.md"; failed=1; }
done
exit "$failed"
