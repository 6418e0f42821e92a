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
  podman volume rm "data-$name" >/dev/null 2>&1 || true
  podman secret rm overtone-server-tls overtone-probe-tls >/dev/null 2>&1 || true
  rm -rf "$work"
}
trap cleanup EXIT

docker save overtone-server | podman load -q >/dev/null 2>"$work/load.log" || skip "podman does not run here: $(tail -n 1 "$work/load.log")"
image=$(podman images --format '{{.Repository}}:{{.Tag}}' | grep -m 1 'overtone-server')
mkdir "$work/certs"
chmod 777 "$work/certs"
docker run --rm -v "$work/certs:/out" --user "$(id -u)" --entrypoint /usr/bin/overtone overtone-server certs --out /out --operator probe \
  --server-name localhost >/dev/null
kubectl kustomize "$source_dir/k8s/overlays/production" | python3 "$here/pod_of_overlay.py" "$work/certs" "$name" "$image" >"$work/pod.yaml"
podman kube play "$work/pod.yaml" >"$work/play.log" 2>&1 || fail "podman kube play: $(cat "$work/play.log")"

pod=$name-mapping-server
ready() { podman exec "$pod" /usr/bin/overtone-health --service overtone.v1.MappingService; }
echo "from kube play to ready: $(wait_until 60 ready) ms" || fail "it does not get ready"
[ "$(podman inspect -f '{{.Config.User}} {{.HostConfig.ReadonlyRootfs}}' "$pod")" = "65532:65532 true" ] \
  || fail "runs as $(podman inspect -f '{{.Config.User}}, read-only {{.HostConfig.ReadonlyRootfs}}' "$pod")"
capabilities=$(podman inspect -f '{{.EffectiveCaps}}' "$pod")
[ "$capabilities" = "[]" ] || fail "keeps capabilities: $capabilities"
podman healthcheck run "$pod" || fail "the liveness probe as podman runs it"
podman stop -t 30 "$pod" >/dev/null
[ "$(podman inspect -f '{{.State.ExitCode}}' "$pod")" = 0 ] || fail "exit code $(podman inspect -f '{{.State.ExitCode}}' "$pod")"
