#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Runs the benchmarks that this project is measured by, keeps their results as JSON, fits how each grows with its size, draws it, and
# writes tables and exponents into README.md, here, and the plots beside it. TMPDIR: on the disk to be measured.
#   benchmark/run.sh [--quick] [OUT]      OUT: the folder of the results, build/benchmark otherwise
#   --quick: the smaller sizes, in about five minutes; report and plots go to OUT, and README.md stays as it is.
# Needs the packages of docker/install_packages.sh client server test benchmark; without --quick 3 GB of memory and about half an hour.
set -eu
cd "$(dirname "$0")/.."
quick=
if [ "${1-}" = --quick ]; then quick=1; shift; fi
out=${1:-build/benchmark}

# A line a program: how often it runs (of CPU times the smallest counts), and what --quick leaves of it.
programs='
trajectory_comparison  3  nodes:(200|1000|5000)/
onboard_estimator      3  BM_ApplyFifteenConstraints/poses:(1000|5000|20000)/
map_cycle              1  keyframes:(1000|10000)/
spectral               3  /(200|1000|5000)$
fan_out                1  nodes:(200|2000)/.*own:0
downlink               1  own:
upload_throughput      1  robots:8/
'

targets=$(echo "$programs" | awk 'NF { print $1 "_benchmark" }')
mkdir -p "$out"
rm -f "$out"/*.json  # of another run
cmake --preset dev >/dev/null
# shellcheck disable=SC2086
nice cmake --build build/dev --target $targets >"$out/build.txt" || { tail -30 "$out/build.txt"; exit 1; }
echo "$programs" | while read -r program repetitions filter; do
  [ -n "$program" ] || continue
  echo "== $program: $(uptime | sed 's/.*load/load/')"
  "build/dev/benchmark/${program}_benchmark" --benchmark_filter="${quick:+$filter}" \
    --benchmark_repetitions="${repetitions}" --benchmark_out="$out/$program.json" --benchmark_out_format=json </dev/null >"$out/$program.txt" 2>&1 ||
    { tail "$out/$program.txt"; exit 1; }
done
if [ -n "$quick" ]; then
  benchmark/report.py "$out" --plots "$out" >"$out/report.md"
  cat "$out/report.md"
else
  benchmark/report.py "$out" --plots benchmark/plots --readme benchmark/README.md
fi
