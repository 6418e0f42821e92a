#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The robot's program loads gRPC, Protobuf, abseil, OpenSSL, zstd and SQLite, and nothing of what the server is made of.
#   client_link_list_test.sh PROGRAM
set -eu
libraries=$(ldd "$1" | awk '{ print $1 }')
forbidden='ceres|cholmod|suitesparse|amd|colamd|camd|ccolamd|spqr|cxsparse|metis|lapack|blas|glog|spdlog|fmt|yaml|CLI11'
if echo "$libraries" | grep -E "^lib($forbidden)"; then
  echo "the client must not link these" >&2
  exit 1
fi
# The list itself must be what we think it is.
echo "$libraries" | grep -q '^libgrpc++\.so' || { echo "no gRPC in: $libraries" >&2; exit 1; }
"$1"
