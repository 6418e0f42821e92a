#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Python stubs of the schema, written into FOLDER. Needs protoc and grpc_python_plugin: Debian's protobuf-compiler and
# protobuf-compiler-grpc.
#   generate_stubs.sh FOLDER
set -eu
[ $# = 1 ] || { echo "usage: $0 FOLDER" >&2; exit 2; }
mkdir -p "$1"
out=$(cd "$1" && pwd)
cd "$(dirname "$0")/../../../proto"
protoc -I. --python_out="$out" --grpc_python_out="$out" --plugin=protoc-gen-grpc_python="$(command -v grpc_python_plugin)" \
  overtone/v1/*.proto
