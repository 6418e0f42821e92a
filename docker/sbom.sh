#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Prints the SPDX 2.3 document of an image: what it contains, and what its programs were built with (headers are compiled in).
#   docker/sbom.sh NAME "GROUP..." PACKAGE...      PACKAGEs are in the image, GROUPs of packages.txt were used to build
# In the environment: PACKAGE_JSON, an npm package file whose (exact) dependencies are bundled into the image's page.
set -eu
here=$(dirname "$0")
name=$1 groups=$2
shift 2
version=$(sed -n 's/^project(overtone VERSION \([0-9.]*\).*/\1/p' "$here/../CMakeLists.txt")
build=$(for group in $groups; do awk -v g="$group" '!/^#/ && $2 == g && $1 ~ /-dev$/ { print $1 }' "$here/packages.txt"; done | sort -u)

# records RELATION PACKAGE...: relation, name, version, supplier, purl; separated by tabs.
records() {
  relation=$1
  shift
  for package in "$@"; do
    dpkg-query -W -f "$relation\t\${Package}\t\${Version}\t\${Maintainer}\tpkg:deb/debian/\${Package}@\${Version}?arch=\${Architecture}&distro=debian-12\n" \
      "$package"
  done
}
all=$(
  records CONTAINS "$@"
  # shellcheck disable=SC2086
  records BUILD $build
  [ -z "${PACKAGE_JSON:-}" ] ||
    sed -n '/^  "dependencies": {/,/}/s|^    "\(.*\)": "\([0-9.]*\)",\{0,1\}$|CONTAINS\t\1\t\2\tnpm\tpkg:npm/\1@\2|p' "$PACKAGE_JSON"
)
created=$(date -u -d "@${SOURCE_DATE_EPOCH:-$(date +%s)}" +%Y-%m-%dT%H:%M:%SZ)
digest=$(printf '%s %s' "$version" "$all" | sha256sum | cut -c 1-32)

printf '%s\n' "$all" | awk -F '\t' -v name="$name" -v version="$version" -v created="$created" -v digest="$digest" '
  function text(s) { gsub(/["\\]/, "\\\\&", s); return s }
  function encoded(purl) { gsub(/\+/, "%2B", purl); return purl }
  function id(s) { gsub(/[^A-Za-z0-9.-]/, "-", s); return "SPDXRef-" s }
  BEGIN {
    unknown = "\"copyrightText\": \"NOASSERTION\", \"downloadLocation\": \"NOASSERTION\", \"filesAnalyzed\": false"
    printf "{\n\"spdxVersion\": \"SPDX-2.3\",\n\"dataLicense\": \"CC0-1.0\",\n\"SPDXID\": \"SPDXRef-DOCUMENT\",\n"
    printf "\"name\": \"%s\",\n\"documentNamespace\": \"urn:spdx:%s-%s-%s\",\n", name, name, version, digest
    printf "\"creationInfo\": {\"created\": \"%s\", \"creators\": [\"Organization: Overtone\"]},\n\"packages\": [\n", created
    printf "{\"SPDXID\": \"SPDXRef-overtone\", \"name\": \"%s\", \"versionInfo\": \"%s\", ", name, version
    printf "\"licenseConcluded\": \"Apache-2.0\", \"licenseDeclared\": \"Apache-2.0\", %s}", unknown
    relations = "{\"spdxElementId\": \"SPDXRef-DOCUMENT\", \"relationshipType\": \"DESCRIBES\", \"relatedSpdxElement\": \"SPDXRef-overtone\"}"
  }
  {
    printf ",\n{\"SPDXID\": \"%s\", \"name\": \"%s\", \"versionInfo\": \"%s\", \"supplier\": \"Organization: %s\", ", id($2), $2, $3, text($4)
    printf "\"licenseConcluded\": \"NOASSERTION\", \"licenseDeclared\": \"NOASSERTION\", %s, ", unknown
    printf "\"externalRefs\": [{\"referenceCategory\": \"PACKAGE-MANAGER\", \"referenceType\": \"purl\", \"referenceLocator\": \"%s\"}]}", encoded($5)
    if ($1 == "CONTAINS") relation = "{\"spdxElementId\": \"SPDXRef-overtone\", \"relationshipType\": \"CONTAINS\", \"relatedSpdxElement\": \"" id($2) "\"}"
    else relation = "{\"spdxElementId\": \"" id($2) "\", \"relationshipType\": \"BUILD_DEPENDENCY_OF\", \"relatedSpdxElement\": \"SPDXRef-overtone\"}"
    relations = relations ",\n" relation
  }
  END { printf "\n],\n\"relationships\": [\n%s\n]\n}\n", relations }'
