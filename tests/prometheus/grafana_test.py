# SPDX-License-Identifier: Apache-2.0
"""Grafana's dashboard asks for nothing but what docs/metrics.md lists (which a test compares with the server), in PromQL that promtool takes.
    grafana_test.py SOURCE_DIR"""
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

source = pathlib.Path(sys.argv[1])
table = re.findall(r"^\| `(\w+)` \| (\w+) \|", (source / "docs/metrics.md").read_text(), re.MULTILINE)
measured = {name for name, _ in table} | {"up"}
measured |= {name + suffix for name, kind in table if kind == "histogram" for suffix in ("_bucket", "_sum", "_count")}


def unknown(text):
    return set(re.findall(r"\b(?:overtone|process)_\w+", text)) - measured


dashboard = json.loads((source / "docker/grafana/overtone.json").read_text())
expressions = [target["expr"] for panel in dashboard["panels"] for target in panel.get("targets", [])]
variables = [variable["query"]["query"] for variable in dashboard["templating"]["list"] if variable["type"] == "query"]
problems = [f"{name} is measured by nobody" for name in sorted(unknown("\n".join(expressions + variables)))]
assert unknown("rate(overtone_nobody_measures_this[5m])"), "the test finds nothing"
ids = [panel["id"] for panel in dashboard["panels"]]
if len(ids) != len(set(ids)):
    problems.append("two panels of one id")

if shutil.which("promtool"):
    # promtool reads rules, and so each expression becomes one; Grafana replaces its variables first.
    rules = [{"record": f"test:panel_{i}", "expr": expression.replace("$map", ".*")} for i, expression in enumerate(expressions)]
    with tempfile.NamedTemporaryFile("w", suffix=".yml") as file:
        json.dump({"groups": [{"name": "grafana", "rules": rules}]}, file)  # JSON is YAML
        file.flush()
        run = subprocess.run(["promtool", "check", "rules", file.name], capture_output=True, text=True)
    if run.returncode:
        problems.append(run.stdout + run.stderr)
print("\n".join(problems) or f"{len(expressions)} queries in {len(ids)} panels")
sys.exit(1 if problems else 0)
