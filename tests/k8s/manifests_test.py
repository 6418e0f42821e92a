# SPDX-License-Identifier: Apache-2.0
"""Renders every overlay as `kubectl apply -k` would, and holds it to manifest_rules.py and to the schemas of Kubernetes, cert-manager and the
Prometheus operator; then breaks it in many ways, each of which must be found."""
import copy
import json
import os
import shutil
import subprocess
import sys

SKIPPED = 77
here = os.path.dirname(os.path.abspath(__file__))
overlays = os.path.join(here, "../../k8s/overlays")

kustomize = ["kubectl", "kustomize"] if shutil.which("kubectl") else ["kustomize", "build"]
if not shutil.which(kustomize[0]):
    print("SKIPPED: neither kubectl nor kustomize is installed")
    sys.exit(SKIPPED)
try:
    import yaml
except ImportError:
    print("SKIPPED: python3-yaml is not installed")
    sys.exit(SKIPPED)
import manifest_rules  # noqa: E402


def render(overlay):
    text = subprocess.run(kustomize + [os.path.join(overlays, overlay)], check=True, stdout=subprocess.PIPE, text=True).stdout
    return [o for o in yaml.safe_load_all(text) if o]


def check_schemas(objects):
    """What the schemas say against these objects; None where they or node are not installed (install_schemas.sh)."""
    modules = os.environ.get("OVERTONE_SCHEMAS", os.path.join(here, "../../build/tools/node_modules"))
    if not shutil.which("node") or not os.path.isdir(os.path.join(modules, "kubernetes-models")):
        return None
    run = subprocess.run(["node", os.path.join(here, "schema_check.mjs"), os.path.abspath(modules)], input=json.dumps(objects),
                         stdout=subprocess.PIPE, text=True)
    return run.stdout.splitlines() if run.returncode in (0, 1) else [f"schema_check.mjs ended with {run.returncode}"]


def at(objects, kind, name):
    return next(o for o in objects if o["kind"] == kind and o["metadata"]["name"] == name)


def pod(o):
    return at(o, "StatefulSet", "overtone")["spec"]["template"]["spec"]


def container(o):
    return pod(o)["containers"][0]


# What is done to the production overlay, and a word of the sentence that must say so.
BROKEN = [
    (lambda o: pod(o).update(hostNetwork=True), "hostNetwork"),
    (lambda o: pod(o)["volumes"].append({"name": "host", "hostPath": {"path": "/"}}), "hostPath"),
    (lambda o: pod(o)["securityContext"].update(runAsUser=0), "root"),
    (lambda o: pod(o)["securityContext"].pop("seccompProfile"), "seccomp"),
    (lambda o: pod(o)["securityContext"].pop("fsGroup"), "fsGroup"),
    (lambda o: pod(o).pop("automountServiceAccountToken"), "token"),
    (lambda o: pod(o).update(terminationGracePeriodSeconds=5), "drained"),
    (lambda o: pod(o)["volumes"].pop(0), "no volume"),
    (lambda o: container(o)["securityContext"].update(privileged=True), "privileged"),
    (lambda o: container(o)["securityContext"].pop("allowPrivilegeEscalation"), "escalate"),
    (lambda o: container(o)["securityContext"]["capabilities"].update(add=["SYS_ADMIN"]), "capabilities"),
    (lambda o: container(o)["securityContext"].update(readOnlyRootFilesystem=False), "root file system"),
    (lambda o: container(o)["resources"]["requests"].pop("memory"), "requests no memory"),
    (lambda o: container(o)["resources"].pop("limits"), "memory limit"),
    (lambda o: container(o).update(image="overtone-server:latest"), "one version"),
    (lambda o: container(o).pop("livenessProbe"), "livenessProbe"),
    (lambda o: container(o)["ports"][0].update(hostPort=7077), "host's port"),
    (lambda o: container(o)["ports"][0].update(containerPort=7078), "listen is"),
    (lambda o: container(o)["ports"][1].update(name="numbers"), "no container has a port metrics"),
    (lambda o: container(o)["env"][0].update(value="/etc/overtone/probe/root.crt"), "root.crt"),
    (lambda o: container(o)["args"].__setitem__(1, "/etc/overtone/server.yaml"), "no /etc/overtone/server.yaml"),
    (lambda o: at(o, "StatefulSet", "overtone")["spec"].update(replicas=2), "share a map"),
    (lambda o: at(o, "StatefulSet", "overtone")["spec"].update(serviceName="overtone"), "headless"),
    (lambda o: at(o, "StatefulSet", "overtone")["spec"]["template"]["metadata"]["labels"].clear(), "own pods"),
    (lambda o: at(o, "PodDisruptionBudget", "overtone")["spec"]["selector"]["matchLabels"].update(a="b"), "PodDisruptionBudget"),
    (lambda o: at(o, "NetworkPolicy", "overtone")["spec"].update(podSelector={}), "NetworkPolicy"),
    (lambda o: at(o, "ServiceMonitor", "overtone")["spec"]["endpoints"][0].update(port="grpcs"), "ServiceMonitor"),
    (lambda o: at(o, "Service", "overtone")["metadata"].update(namespace="default"), "namespace"),
    (lambda o: at(o, "Namespace", "overtone")["metadata"].pop("labels"), "restricted"),
    (lambda o: at(o, "Certificate", "overtone-server")["spec"].update(dnsNames=["localhost"]), "does not name"),
    (lambda o: at(o, "Certificate", "overtone-probe")["spec"].update(secretName="other"), "no Certificate"),
    (lambda o: at(o, "ConfigMap", "overtone-access")["data"].update({"access.yaml": "maps: {a: {robots: ['*'], operators: [probe]}}"}), "the probe"),
    (lambda o: o.append(copy.deepcopy(at(o, "Service", "overtone"))), "twice"),
]


def main():
    failures = []
    for overlay in sorted(os.listdir(overlays)):
        objects = render(overlay)
        failures += [f"{overlay}: {wrong}" for wrong in manifest_rules.wrong(objects, overlay == "production")]
        against = check_schemas(objects)
        print(f"{overlay}: {len(objects)} objects, schemas " + ("not installed" if against is None else "checked"))
        failures += [f"{overlay}: {sentence}" for sentence in against or []]
    pristine = render("production")
    for number, (break_it, expected) in enumerate(BROKEN):
        objects = copy.deepcopy(pristine)
        break_it(objects)
        found = manifest_rules.wrong(objects, production=True)
        if not any(expected in sentence for sentence in found):
            failures.append(f"broken manifest {number}: nothing says '{expected}': {found}")
    misspelt = copy.deepcopy(pristine)
    container(misspelt)["ports"][0]["containerPort"] = "grpc"
    if check_schemas(misspelt) == []:
        failures.append("the schemas let a port that is no number pass")
    print("\n".join(failures) or f"and {len(BROKEN)} broken ones are found to be broken")
    return 1 if failures else 0


sys.exit(main())
