#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Prints the SPDX 2.3 document of an image: what it contains, and what its programs were built with (headers are compiled in).
#   docker/sbom.sh NAME "GROUP..." PACKAGE...      PACKAGEs are in the image, GROUPs of packages.txt were used to build
set -eu
here=$(dirname "$0")
name=$1 groups=$2
shift 2
version=$(sed -n 's/^project(overtone VERSION \([0-9.]*\).*/\1/p' "$here/../CMakeLists.txt")
build=$(for group in $groups; do awk -v g="$group" '!/^#/ && $2 == g && $1 ~ /-dev$/ { print $1 }' "$here/packages.txt"; done | sort -u)

records=$(
  for package in "$@"; do dpkg-query -W -f "CONTAINS\t\${Package}\t\${Version}\t\${Architecture}\t\${Maintainer}\n" "$package"; done
  for package in $build; do
    dpkg-query -W -f "BUILD\t\${Package}\t\${Version}\t\${Architecture}\t\${Maintainer}\n" "$package"
  done
)
created=$(date -u -d "@${SOURCE_DATE_EPOCH:-$(date +%s)}" +%Y-%m-%dT%H:%M:%SZ)
digest=$(printf '%s %s' "$version" "$records" | sha256sum | cut -c 1-32)

printf '%s\n' "$records" | awk -F '\t' -v name="$name" -v version="$version" -v created="$created" -v digest="$digest" '
  function text(s) { gsub(/["\\]/, "\\\\&", s); return s }
  function encoded(s) { gsub(/\+/, "%2B", s); gsub(/:/, "%3A", s); return s }
  function id(s) { gsub(/[^A-Za-z0-9.-]/, "-", s); return "SPDXRef-" s }
  BEGIN {
    printf "{\n\"spdxVersion\": \"SPDX-2.3\",\n\"dataLicense\": \"CC0-1.0\",\n\"SPDXID\": \"SPDXRef-DOCUMENT\",\n"
    printf "\"name\": \"%s\",\n\"documentNamespace\": \"urn:spdx:%s-%s-%s\",\n", name, name, version, digest
    printf "\"creationInfo\": {\"created\": \"%s\", \"creators\": [\"Organization: Overtone\"]},\n\"packages\": [\n", created
    printf "{\"SPDXID\": \"SPDXRef-overtone\", \"name\": \"%s\", \"versionInfo\": \"%s\", ", name, version
    printf "\"licenseConcluded\": \"Apache-2.0\", \"licenseDeclared\": \"Apache-2.0\", \"copyrightText\": \"NOASSERTION\", "
    printf "\"downloadLocation\": \"NOASSERTION\", \"filesAnalyzed\": false}"
    relations = "{\"spdxElementId\": \"SPDXRef-DOCUMENT\", \"relationshipType\": \"DESCRIBES\", \"relatedSpdxElement\": \"SPDXRef-overtone\"}"
  }
  {
    own = id($2)
    printf ",\n{\"SPDXID\": \"%s\", \"name\": \"%s\", \"versionInfo\": \"%s\", \"supplier\": \"Organization: %s\", ", own, $2, $3, text($5)
    printf "\"licenseConcluded\": \"NOASSERTION\", \"licenseDeclared\": \"NOASSERTION\", \"copyrightText\": \"NOASSERTION\", "
    printf "\"downloadLocation\": \"NOASSERTION\", \"filesAnalyzed\": false, \"externalRefs\": [{\"referenceCategory\": \"PACKAGE-MANAGER\", "
    printf "\"referenceType\": \"purl\", \"referenceLocator\": \"pkg:deb/debian/%s@%s?arch=%s&distro=debian-12\"}]}", encoded($2), encoded($3), $4
    if ($1 == "CONTAINS") relation = "{\"spdxElementId\": \"SPDXRef-overtone\", \"relationshipType\": \"CONTAINS\", \"relatedSpdxElement\": \"" own "\"}"
    else relation = "{\"spdxElementId\": \"" own "\", \"relationshipType\": \"BUILD_DEPENDENCY_OF\", \"relatedSpdxElement\": \"SPDXRef-overtone\"}"
    relations = relations ",\n" relation
  }
  END { printf "\n],\n\"relationships\": [\n%s\n]\n}\n", relations }'
