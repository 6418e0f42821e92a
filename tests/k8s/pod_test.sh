#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The production overlay's pod, run by podman with certificates of our own: it gets ready, its probes answer, it may write nothing but its
# volume, and it ends in order.
set -eu
. "$(dirname "$0")/../containers/engine.sh"
command -v podman >/dev/null || skip "there is no podman"
command -v kubectl >/dev/null || skip "there is no kubectl"
docker image inspect overtone-server >/dev/null 2>&1 || skip "container_images has not built overtone-server"
here=$source_dir/tests/k8s
work=$(mktemp -d)
name=overtone-pod-$$
cleanup() {
  status=$?
  [ $status = 0 ] || podman logs "$name-mapping-server" 2>&1 | tail -n 20 >&2 || true
  podman kube down "$work/pod.yaml" >/dev/null 2>&1 || true
  grep -oE '(claimName|name): [a-z0-9-]+$' "$work/pod.yaml" | awk '{ print $2 }' | sort -u | while read -r volume; do
    podman volume rm "$volume" >/dev/null 2>&1 || true
  done
  rm -rf "$work"
}
trap cleanup EXIT

# Podman's own limits may be more than it may set here.
export CONTAINERS_CONF=$work/containers.conf
printf '[containers]\ndefault_ulimits = ["nofile=4096:4096", "nproc=4096:4096"]\n' >"$CONTAINERS_CONF"

docker save overtone-server | podman load -q >/dev/null 2>"$work/load.log" || skip "podman does not run here: $(tail -n 1 "$work/load.log")"
image=$(podman images --format '{{.Repository}}:{{.Tag}}' | grep -m 1 'overtone-server')
podman run --rm --no-healthcheck --network none --entrypoint /usr/bin/overtone "$image" --version >/dev/null 2>"$work/run.log" \
  || skip "podman runs no container here: $(tail -n 1 "$work/run.log")"
mkdir "$work/certs"
chmod 777 "$work/certs"
docker run --rm -v "$work/certs:/out" --user "$(id -u)" --entrypoint /usr/bin/overtone overtone-server certs --out /out --operator probe \
  --server-name localhost >/dev/null
kubectl kustomize "$source_dir/k8s/overlays/production" >"$work/overlay.yaml"
python3 "$here/pod_of_overlay.py" "$work/certs" "$name" "$image" <"$work/overlay.yaml" >"$work/pod.yaml"
# One line for each probe: its command.
python3 - "$work/overlay.yaml" >"$work/probes" <<'PYTHON'
import sys, yaml
container = next(o for o in yaml.safe_load_all(open(sys.argv[1])) if o["kind"] == "StatefulSet")["spec"]["template"]["spec"]["containers"][0]
for probe in ("startupProbe", "livenessProbe", "readinessProbe"):
    print(*container[probe]["exec"]["command"])
PYTHON
podman kube play "$work/pod.yaml" >"$work/play.log" 2>&1 || fail "podman kube play: $(cat "$work/play.log")"

pod=$name-mapping-server
ready() {
  while read -r probe; do
    # shellcheck disable=SC2086
    podman exec "$pod" $probe </dev/null || return 1
  done <"$work/probes"
}
milliseconds=$(wait_until 60 ready) || fail "it does not get ready"
echo "from kube play to ready: $milliseconds ms"
[ "$(podman inspect -f '{{.Config.User}} {{.HostConfig.ReadonlyRootfs}}' "$pod")" = "65532:65532 true" ] \
  || fail "runs as $(podman inspect -f '{{.Config.User}}, read-only {{.HostConfig.ReadonlyRootfs}}' "$pod")"
capabilities=$(podman inspect -f '{{.EffectiveCaps}}' "$pod")
[ "$capabilities" = "[]" ] || fail "keeps capabilities: $capabilities"
[ "$(wc -l <"$work/probes")" = 3 ] || fail "three probes were to be asked"
! podman exec "$pod" /usr/bin/overtone-health --service unheard.of 2>/dev/null || fail "the probe is content with anything"
podman stop -t 30 "$pod" >/dev/null
[ "$(podman inspect -f '{{.State.ExitCode}}' "$pod")" = 0 ] || fail "exit code $(podman inspect -f '{{.State.ExitCode}}' "$pod")"
