#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Installs what schema_check.mjs reads, beside buf.
set -eu
cd "$(dirname "$0")/../.."
[ -d build/tools/node_modules/kubernetes-models ] || npm install --loglevel=error --no-audit --no-fund --prefix build/tools \
  kubernetes-models@5.1.0 @kubernetes-models/cert-manager@6.0.0 @kubernetes-models/prometheus-operator@6.0.0
