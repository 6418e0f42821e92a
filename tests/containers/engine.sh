# SPDX-License-Identifier: Apache-2.0
# What the container tests share; sourced. Ends with 77, which ctest counts as skipped, where no Docker engine answers.
export DOCKER_BUILDKIT=1 COMPOSE_DOCKER_CLI_BUILD=1
source_dir=$(cd "$(dirname "$0")/../.." && pwd)

fail() {
  echo "FAILED: $*" >&2
  exit 1
}
skip() {
  echo "SKIPPED: $*"
  exit 77
}

[ "${OVERTONE_TEST_CONTAINERS:-ON}" != OFF ] || skip "OVERTONE_TEST_CONTAINERS=OFF"
command -v docker >/dev/null || skip "there is no docker"
timeout 20 docker info >/dev/null 2>&1 || skip "no Docker engine answers"

compose() {
  if docker compose version >/dev/null 2>&1; then
    docker compose -p "$project" -f "$tree/docker/compose.yaml" "$@"
  else
    docker-compose -p "$project" -f "$tree/docker/compose.yaml" "$@"
  fi
}

now_ms() { date +%s%3N; }

# wait_until SECONDS COMMAND...: until it succeeds, and says after how many ms.
wait_until() {
  begin=$(now_ms) deadline=$(($(now_ms) + $1 * 1000))
  shift
  until "$@" >/dev/null 2>&1; do
    [ "$(now_ms)" -lt "$deadline" ] || return 1
    sleep 0.1
  done
  echo $(($(now_ms) - begin))
}
