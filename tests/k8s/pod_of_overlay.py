# SPDX-License-Identifier: Apache-2.0
"""Prints what `podman kube play` needs to run the StatefulSet of a rendered overlay (standard input): its pod, its ConfigMaps, and for each
secret that cert-manager would write a ConfigMap with one of the certificates in a folder of `overtone certs` (podman before 4.4 leaves
secrets in base64).
    pod_of_overlay.py FOLDER POD_NAME IMAGE"""
import os
import sys

import yaml

CERTIFICATES = {"overtone-server-tls": "server", "overtone-probe-tls": "operator-probe"}

folder, name, image = sys.argv[1:]
objects = [o for o in yaml.safe_load_all(sys.stdin) if o]
stateful_set = next(o for o in objects if o["kind"] == "StatefulSet")
template = stateful_set["spec"]["template"]


def text(file):
    with open(os.path.join(folder, file)) as f:
        return f.read()


def config_map(map_name, data):
    return {"apiVersion": "v1", "kind": "ConfigMap", "metadata": {"name": map_name}, "data": data}


def secret(secret_name):
    certificate = CERTIFICATES[secret_name]
    return config_map(secret_name, {"ca.crt": text("ca.crt"), "tls.crt": text(f"{certificate}.crt"), "tls.key": text(f"{certificate}.key")})


spec = template["spec"]
spec.pop("serviceAccountName")  # there is no API server here
spec["containers"][0].update(image=image, imagePullPolicy="Never")
for probe in ("startupProbe", "livenessProbe", "readinessProbe"):
    spec["containers"][0].pop(probe)  # podman runs them by a shell; pod_test.sh runs their commands
documents = [config_map(o["metadata"]["name"], o["data"]) for o in objects if o["kind"] == "ConfigMap"]
for volume in spec["volumes"]:
    if "secret" in volume:
        documents.append(secret(volume["secret"]["secretName"]))
        volume["configMap"] = {"name": volume.pop("secret")["secretName"]}
spec["containers"][0].pop("ports")  # podman before 4.4 would take the host's
for claim in stateful_set["spec"]["volumeClaimTemplates"]:
    claim_name = f"{claim['metadata']['name']}-{name}"
    spec["volumes"].append({"name": claim["metadata"]["name"], "persistentVolumeClaim": {"claimName": claim_name}})
    documents.append({"apiVersion": "v1", "kind": "PersistentVolumeClaim", "metadata": {"name": claim_name}, "spec": claim["spec"]})
documents.append({"apiVersion": "v1", "kind": "Pod", "metadata": {"name": name, "labels": template["metadata"]["labels"]}, "spec": spec})
yaml.safe_dump_all(documents, sys.stdout)
