# SPDX-License-Identifier: Apache-2.0
"""Prometheus's configuration and Grafana's dashboard ask for nothing that the servers do not measure.
    monitoring_test.py SOURCE_DIR"""
import glob
import json
import os
import re
import shutil
import subprocess
import sys

source = sys.argv[1]
# Histograms and counters are asked for by names that Prometheus's formats add these to.
SUFFIXES = ("_bucket", "_sum", "_count")


def read(path):
    with open(path) as f:
        return f.read()


measured = set()
for path in glob.glob(f"{source}/services/**/*.cc", recursive=True):
    measured |= set(re.findall(r'"(overtone_[a-z0-9_]+)"', read(path)))
assert len(measured) > 5, measured


def unknown(text):
    wanted = set(re.findall(r"\bovertone_[a-z0-9_]+", text))
    return {name for name in wanted if name not in measured and not any(name.removesuffix(s) in measured for s in SUFFIXES)}


dashboard = json.loads(read(f"{source}/docker/grafana/overtone.json"))
expressions = [target["expr"] for panel in dashboard["panels"] for target in panel["targets"]]
variables = [v["query"]["query"] for v in dashboard["templating"]["list"] if v["type"] == "query"]
problems = [f"overtone.json: {name} is measured by nobody" for name in sorted(unknown("\n".join(expressions + variables)))]
for alerts in glob.glob(f"{source}/docker/prometheus/alerts*.yml"):
    expressions = re.findall(r"^\s*expr:(.*(?:\n\s+[^\s:]+[^:\n]*$)*)", read(alerts), re.MULTILINE)
    problems += [f"{os.path.basename(alerts)}: {name} is measured by nobody" for name in sorted(unknown("\n".join(expressions)))]
ids = [panel["id"] for panel in dashboard["panels"]]
if len(ids) != len(set(ids)):
    problems.append("overtone.json: two panels of one id")
assert unknown("overtone_nobody_measures_this") == {"overtone_nobody_measures_this"}

if shutil.which("promtool"):
    run = subprocess.run(["promtool", "check", "config", f"{source}/docker/prometheus/prometheus.yml"], capture_output=True, text=True)
    if run.returncode:
        problems.append(run.stdout + run.stderr)
print("\n".join(problems) or f"{len(measured)} metrics, {len(ids)} panels" + ("" if shutil.which("promtool") else "; no promtool"))
sys.exit(1 if problems else 0)
