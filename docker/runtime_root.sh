#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Makes the root of an image FROM scratch: the programs, stripped, the shared libraries that they load and no others, a user
# without rights, and papers: each library's copyright, dpkg's record of it (which scanners read) and a list of it all (sbom.sh).
#   docker/runtime_root.sh ROOT NAME "GROUP..." PROGRAM...      GROUPs of packages.txt that the programs were built with
set -eu
here=$(dirname "$0")
root=$1 name=$2 groups=$3
shift 3

for folder in bin lib lib64 sbin; do
  mkdir -p "$root/usr/$folder"
  ln -s "usr/$folder" "$root/$folder"
done
mkdir -p "$root/etc/overtone/certs" "$root/etc/overtone/access" "$root/var/lib/overtone" "$root/var/lib/dpkg/status.d" \
  "$root/usr/share/doc/overtone" "$root/tmp"
chmod 1777 "$root/tmp"
chown 65532:65532 "$root/etc/overtone/certs" "$root/var/lib/overtone"
echo 'overtone:x:65532:65532:Overtone:/var/lib/overtone:/usr/sbin/nologin' >"$root/etc/passwd"
echo 'overtone:x:65532:' >"$root/etc/group"
cp /etc/os-release "$root/etc/os-release"

# ldd's lines: "name => path (address)", and "path (address)" for the loader.
libraries=$(for program in "$@"; do ldd "$program"; done | awk '$2 == "=>" { print $3 } $1 ~ /^\// { print $1 }' | sort -u)
if echo "$libraries" | grep -qx not; then
  echo "a library is missing:" >&2
  for program in "$@"; do ldd "$program" | grep 'not found' >&2; done
  exit 1
fi
packages=
for library in $libraries; do
  mkdir -p "$root$(dirname "$library")"
  cp -L "$library" "$root$library"
  # The package knows the file by its own name, with or without /usr.
  file=$(readlink -f "$library")
  package=$(dpkg -S "$file" 2>/dev/null || dpkg -S "${file#/usr}")
  packages="$packages ${package%%:*}"
done
install -s -t "$root/usr/bin" "$@"
ldconfig -r "$root"

packages=$(printf '%s\n' $packages | sort -u)
for package in $packages; do
  mkdir -p "$root/usr/share/doc/$package"
  cp -L "/usr/share/doc/$package/copyright" "$root/usr/share/doc/$package/"
  dpkg-query -s "$package" >"$root/var/lib/dpkg/status.d/$package"
done
cp "$here/../LICENSE" "$root/usr/share/doc/overtone/copyright"
# shellcheck disable=SC2086
"$here/sbom.sh" "$name" "$groups" $packages >"$root/usr/share/doc/overtone/sbom.spdx.json"
