#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The composed server over mutual TLS: two robots use it, its container is killed in the middle of an upload and comes back, and
# nothing that it had acknowledged is lost; strangers stay out; Prometheus sees it; it ends in order on SIGTERM. images_test.sh has built
# the images.
set -eu
. "$(dirname "$0")/engine.sh"
project=overtone-test-$$
work=$(mktemp -d)
tree=$work/tree
# Free ports: nobody comes from outside here.
export OVERTONE_PORT=0 OVERTONE_PROMETHEUS_PORT=0 OVERTONE_DASHBOARD_PORT=0

cleanup() {
  status=$?
  [ $status = 0 ] || compose logs --no-color --tail 20 >&2 || true
  docker rm -f "$project-robot" >/dev/null 2>&1 || true
  compose down -v -t 2 >/dev/null 2>&1 || true
  rm -rf "$work"
}
trap cleanup EXIT
mkdir "$tree"
git -C "$source_dir" archive HEAD | tar -x -C "$tree"

compose up -d --no-build mapping-server dashboard prometheus >"$work/up.log" 2>&1 || fail "compose up: $(cat "$work/up.log")"
server=$(compose ps -q mapping-server)
serves() { docker exec "$server" /usr/bin/overtone-health --tls-ca "$certs/ca.crt" --tls-cert "$certs/operator-probe.crt" --tls-key "$certs/operator-probe.key"; }
healthy() { [ "$(docker inspect -f '{{.State.Health.Status}}' "$server")" = healthy ]; }
certs=/etc/overtone/certs
wait_until 60 healthy >/dev/null || fail "the server does not get healthy: $(docker inspect -f '{{json .State.Health}}' "$server")"

# As an operator, in the server's own container: there is no shell, but there is the command.
overtone() {
  command=$1
  shift
  docker exec "$server" /usr/bin/overtone "$command" --tls-ca "$certs/ca.crt" --tls-cert "$certs/operator-olga.crt" --tls-key "$certs/operator-olga.key" "$@"
}
# keyframes ROBOT: of its one mission, as the server counts them.
keyframes() {
  overtone missions --map default --json | python3 -c '
import json, sys
for line in sys.stdin:
    mission = json.loads(line)
    if mission["id"]["robot"] == sys.argv[1] and mission["id"]["mission"] == sys.argv[2]:
        print(mission["keyframes"])' "$1" "$2"
}
robot_run="docker run --rm --read-only --cap-drop ALL --network ${project}_overtone -v ${project}_certs:$certs:ro"

echo "== the client image's robot, built against the installed client"
$robot_run overtone-client mapping-server:7077 "$certs/ca.crt" "$certs/robot-robot.crt" "$certs/robot-robot.key" >"$work/robot.log" 2>&1 \
  || fail "the robot: $(cat "$work/robot.log")"
cat "$work/robot.log"
awk '/by odometry/ { before = $(NF - 3) } /constraints/ { after = $2 } END { exit !(before > 1 && after != "" && after < before / 10) }' \
  "$work/robot.log" || fail "the robot was not corrected"
[ "$(keyframes robot circle)" = 61 ] || fail "the server has '$(keyframes robot circle)' of its 61 keyframes"

echo "== strangers stay out"
! $robot_run overtone-client mapping-server:7077 >/dev/null 2>&1 || fail "a robot without certificates got in"
! docker exec "$server" /usr/bin/overtone status --insecure >/dev/null 2>&1 || fail "an operator without certificates got in"
! $robot_run overtone-client mapping-server:7077 "$certs/ca.crt" "$certs/robot-robot1.crt" "$certs/robot-robot1.key" >/dev/null 2>&1 \
  || fail "robot1 wrote for robot"
if docker exec "$server" /usr/bin/overtone missions --map default --tls-ca "$certs/ca.crt" --tls-cert "$certs/operator-probe.crt" \
  --tls-key "$certs/operator-probe.key" >/dev/null 2>&1; then
  fail "the probe's certificate reads maps"
fi

echo "== killed in the middle of an upload"
python3 - >"$work/recording.json" <<'PYTHON'
import json
covariance = [1e-4 if i in (0, 6, 11, 15, 18, 20) else 0 for i in range(21)]
keyframes = [{"stamp_ns": (i + 1) * 10**9, "mission_tform_body": [0.5 * i, 0, 0, 0, 0, 0, 1], "motion_covariance": covariance,
              "degenerate": False} for i in range(20000)]
json.dump({"robot": "robot1", "mission": "line", "keyframes": keyframes, "loop_closures": []}, __import__("sys").stdout)
PYTHON
chmod 755 "$work"
mkfifo "$work/ask" "$work/answer"
$robot_run -i --name "$project-robot" -v "$work/recording.json:/recording.json:ro" --entrypoint /usr/bin/overtone overtone-server robot \
  --recording /recording.json --server mapping-server:7077 --timeout 60 --tls-ca "$certs/ca.crt" --tls-cert "$certs/robot-robot1.crt" \
  --tls-key "$certs/robot-robot1.key" <"$work/ask" >"$work/answer" 2>"$work/robot.err" &
exec 3>"$work/ask" 4<"$work/answer"
acknowledged() { read -r line <&4 && echo "$line" | python3 -c 'import json, sys; print(json.load(sys.stdin)["keyframes"])'; }

echo "advance 2500" >&3
before=$(acknowledged) || fail "the robot: $(cat "$work/robot.err")"
echo "advance 20000" >&3
docker kill -s KILL "$server" >/dev/null
echo "$before keyframes acknowledged before"
begin=$(now_ms)
docker start "$server" >/dev/null
started=$(($(now_ms) - begin))
ready=$(wait_until 60 serves) || fail "the server does not come back"
echo "from docker start to serving: $((started + ready)) ms, of which the engine took $started"
kept=$(keyframes robot1 line)
[ "$kept" -ge "$before" ] || fail "$before keyframes were acknowledged, $kept are there"
[ "$(keyframes robot circle)" = 61 ] || fail "the other robot's mission is not what it was"
after=$(acknowledged) || fail "the robot did not go on: $(cat "$work/robot.err")"
[ "$after" = 20000 ] || fail "$after of 20000 keyframes acknowledged"
exec 3>&- 4<&-
stored=
all_stored() { stored=$(keyframes robot1 line) && [ "$stored" = "$after" ]; }
wait_until 60 all_stored >/dev/null || fail "$after keyframes were acknowledged, $stored are there"
echo "$after keyframes acknowledged in the end, and as many there"
overtone verify --map default || fail "the store is damaged"

echo "== Prometheus"
prometheus=$(compose ps -q prometheus)
scraped() { docker exec "$prometheus" promtool query instant http://localhost:9090 'overtone_keyframes{map="default"}' | grep -q "=> 20061 "; }
wait_until 60 scraped >/dev/null || fail "Prometheus: $(docker exec "$prometheus" promtool query instant http://localhost:9090 '{job="overtone"}' 2>&1 | tail -n 5)"

echo "== the dashboard"
page=$(docker inspect -f '{{(index (index .NetworkSettings.Ports "8080/tcp") 0).HostPort}}' "$(compose ps -q dashboard)")
fetched() { python3 -c 'import sys, urllib.request; print(urllib.request.urlopen(sys.argv[1], timeout=5).read().decode())' "http://localhost:$page$1"; }
fetched / | grep -q '<title>' || fail "no page"
shown() { fetched /api/state | grep -q 20061; }
wait_until 60 shown >/dev/null || fail "the page does not know the map: $(fetched /api/state | head -c 500)"

echo "== without rights, and ended in order"
[ "$(docker inspect -f '{{.HostConfig.ReadonlyRootfs}} {{.Config.User}} {{.HostConfig.CapDrop}}' "$server")" = "true 65532:65532 [ALL]" ] \
  || fail "the server's container is not as hard as it should be"
wait_until 60 healthy >/dev/null || fail "the health check: $(docker inspect -f '{{json .State.Health}}' "$server")"
echo "memory: $(docker stats --no-stream --format '{{.MemUsage}}' "$server")"
begin=$(now_ms)
docker stop -t 30 "$server" >/dev/null
echo "from SIGTERM to the end: $(($(now_ms) - begin)) ms"
[ "$(docker inspect -f '{{.State.ExitCode}}' "$server")" = 0 ] || fail "exit code $(docker inspect -f '{{.State.ExitCode}}' "$server")"
docker start "$server" >/dev/null
wait_until 60 serves >/dev/null || fail "the server does not start again"
[ "$(keyframes robot1 line)" = 20000 ] || fail "the map is not what it was"
