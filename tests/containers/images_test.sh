#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds the images from a clean clone, and holds them to what we say of them: their size, no rights, no shell, papers.
set -eu
. "$(dirname "$0")/engine.sh"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$source_dir/tests/containers/base_image.sh" || exit $?
"$source_dir/tests/containers/warm_ccache.sh" || true

revision=$(git -C "$source_dir" rev-parse HEAD)
# Whom this host trusts, the build trusts.
secret=
[ ! -f /etc/ssl/certs/ca-certificates.crt ] || secret="--secret id=ca,src=/etc/ssl/certs/ca-certificates.crt"
for image in server client dashboard prometheus; do
  begin=$(now_ms)
  # shellcheck disable=SC2086
  git -C "$source_dir" archive HEAD | docker build --progress plain --build-arg "REVISION=$revision" $secret -f "docker/$image.Dockerfile" \
    -t "overtone-$image" - >"$work/$image.log" 2>&1 || fail "building $image: $(tail -n 40 "$work/$image.log")"
  echo "$image: built in $((($(now_ms) - begin) / 1000)) s, $(($(docker image inspect -f '{{.Size}}' "overtone-$image") / 1000000)) MB"
done

field() { docker image inspect -f "$2" "overtone-$1"; }
version=$(sed -n 's/^project(overtone VERSION \([0-9.]*\).*/\1/p' "$source_dir/CMakeLists.txt")
for limit in server:250 client:80 dashboard:80; do
  image=${limit%:*}
  [ "$(field "$image" '{{.Size}}')" -lt "${limit#*:}000000" ] || fail "$image is larger than ${limit#*:} MB"
  [ "$(field "$image" '{{.Config.User}}')" = 65532:65532 ] || fail "$image runs as $(field "$image" '{{.Config.User}}')"
  [ "$(field "$image" '{{index .Config.Labels "org.opencontainers.image.version"}}')" = "$version" ] || fail "$image: not version $version"
  [ "$(field "$image" '{{index .Config.Labels "org.opencontainers.image.revision"}}')" = "$revision" ] || fail "$image: not this revision"
  for shell in /bin/sh /bin/bash /bin/dash /bin/busybox; do
    ! docker run --rm --entrypoint "$shell" "overtone-$image" -c true >/dev/null 2>&1 || fail "$image has $shell"
  done

  # What is in it, from the outside: a container that never runs.
  container=$(docker create "overtone-$image")
  docker export "$container" | tar -C "$work" -x --exclude=dev --one-top-level="$image"
  docker rm "$container" >/dev/null
  python3 - "$work/$image" "$version" <<'PYTHON' || fail "$image: its papers"
import json, os, sys
root, version = sys.argv[1:]
sbom = json.load(open(f"{root}/usr/share/doc/overtone/sbom.spdx.json"))
assert sbom["spdxVersion"] == "SPDX-2.3" and sbom["dataLicense"] == "CC0-1.0"
packages = {p["SPDXID"]: p for p in sbom["packages"]}
assert packages["SPDXRef-overtone"]["versionInfo"] == version
for r in sbom["relationships"]:
    assert r["relatedSpdxElement"] in packages and (r["spdxElementId"] in packages or r["spdxElementId"] == "SPDXRef-DOCUMENT"), r
inside = {packages[r["relatedSpdxElement"]]["name"] for r in sbom["relationships"] if r["relationshipType"] == "CONTAINS"}
npm = {p["name"] for p in sbom["packages"] if "pkg:npm/" in str(p.get("externalRefs"))}
assert npm == ({"three"} if root.endswith("dashboard") else set()), npm
inside -= npm
assert inside == set(os.listdir(f"{root}/var/lib/dpkg/status.d")), inside
for name in inside:
    assert os.path.getsize(f"{root}/usr/share/doc/{name}/copyright") > 0, name
assert {"libc6", "libgrpc++1.51", "libprotobuf32"} <= inside, inside
if root.endswith("client"):  # a robot loads nothing of what the server is made of
    heavy = ("ceres", "cholmod", "suitesparse", "blas", "lapack", "glog", "spdlog", "yaml", "prometheus")
    assert not [n for n in inside if any(h in n for h in heavy)], inside
# Nothing in it may be written to by whom it runs as but the folders that are meant for it, and nothing takes rights.
for folder, _, files in os.walk(root):
    for name in files:
        status = os.lstat(os.path.join(folder, name))
        assert not status.st_mode & 0o6000, (folder, name)
        assert status.st_uid == 0 and not status.st_mode & 0o002 or os.path.islink(os.path.join(folder, name)), (folder, name)
print(f"{os.path.basename(root)}: {len(inside)} Debian packages")
PYTHON
done
