#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Installs the client from a build tree, builds the examples against nothing but that, and runs them with a server.
#   install_test.sh CMAKE BUILD_DIR SOURCE_DIR SERVER|no-server
set -eu
cmake=$1 build=$2 source=$3 server=$4
work=$(mktemp -d)
server_pid=
cleanup() {
  [ -z "$server_pid" ] || kill "$server_pid" 2>/dev/null || true
  rm -rf "$work"
}
trap cleanup EXIT

fail() {
  echo "$*" >&2
  exit 1
}

"$cmake" --install "$build" --component client --prefix "$work/prefix" >"$work/install.log" || fail "$(cat "$work/install.log")"
[ -f "$work/prefix/include/overtone/client/mapping_client.h" ] || fail "no public header installed"
[ ! -e "$work/prefix/include/overtone/client/internal" ] || fail "internal headers installed"
[ ! -e "$work/prefix/bin" ] || fail "programs installed with the client: $(ls "$work/prefix/bin")"
if grep -rEi 'ceres|cholmod|suitesparse|spdlog|glog|yaml|nanoflann|spectra[^l]' "$work/prefix/lib"*/cmake "$work/prefix/lib/"*/cmake 2>/dev/null; then
  fail "the package asks for more than gRPC, Protobuf, OpenSSL, zstd, Eigen and abseil"
fi
if grep -rl "$source\|$build" "$work/prefix" --include='*.cmake' --include='*.h'; then
  fail "paths of the build in the package"
fi

for example in 01_robot 02_no_optimiser; do
  cp -r "$source/client/examples/$example" "$work/$example"
  "$cmake" -S "$work/$example" -B "$work/$example/build" -DCMAKE_PREFIX_PATH="$work/prefix" -DCMAKE_BUILD_TYPE=Debug >"$work/log" 2>&1 || fail "$(cat "$work/log")"
  "$cmake" --build "$work/$example/build" >"$work/log" 2>&1 || fail "$(cat "$work/log")"
done
[ "$server" != no-server ] || exit 0

# The server writes one line when it is ready; a FIFO makes reading it wait.
mkfifo "$work/ready"
"$server" --listen 127.0.0.1:0 >"$work/ready" 2>"$work/server.log" &
server_pid=$!
read -r _ _ address <"$work/ready" || fail "server: $(cat "$work/server.log")"

for program in 01_robot/build/robot 02_no_optimiser/build/robot_without_optimiser; do
  echo "== $program"
  "$work/$program" "$address" >"$work/output" || fail "$(cat "$work/output" "$work/server.log")"
  cat "$work/output"
  # "... N m by odometry" and "and N m after K constraints": the gap has shrunk at least tenfold.
  awk '/by odometry/ { for (i = 1; i < NF; i++) if ($(i + 1) == "m" && before == "") before = $i }
       /constraints/ { after = $2 }
       END { exit !(before > 1 && after != "" && after < before / 10) }' "$work/output" || fail "$program did not get better"
done

kill -TERM "$server_pid"
wait "$server_pid" || fail "the server did not stop cleanly"
server_pid=
