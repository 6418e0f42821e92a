# SPDX-License-Identifier: Apache-2.0
"""Prints what `podman kube play` needs to run the StatefulSet of a rendered overlay (standard input): its pod, its ConfigMaps, and for each
secret that cert-manager would write one of the certificates in a folder of `overtone certs`.
    pod_of_overlay.py FOLDER POD_NAME IMAGE"""
import base64
import os
import sys

import yaml

folder, name, image = sys.argv[1:]
objects = [o for o in yaml.safe_load_all(sys.stdin) if o]
stateful_set = next(o for o in objects if o["kind"] == "StatefulSet")
template = stateful_set["spec"]["template"]


def encoded(file):
    with open(os.path.join(folder, file), "rb") as f:
        return base64.b64encode(f.read()).decode()


def secret(secret_name, certificate):
    keys = {"ca.crt": "ca.crt", "tls.crt": f"{certificate}.crt", "tls.key": f"{certificate}.key"}
    return {"apiVersion": "v1", "kind": "Secret", "metadata": {"name": secret_name},
            "data": {key: encoded(file) for key, file in keys.items()}}


spec = template["spec"]
spec["containers"][0]["image"] = image
spec["containers"][0]["imagePullPolicy"] = "Never"
claims = []
for claim in stateful_set["spec"]["volumeClaimTemplates"]:
    claim_name = f"{claim['metadata']['name']}-{name}"
    spec["volumes"].append({"name": claim["metadata"]["name"], "persistentVolumeClaim": {"claimName": claim_name}})
    claims.append({"apiVersion": "v1", "kind": "PersistentVolumeClaim", "metadata": {"name": claim_name}, "spec": claim["spec"]})
spec.pop("serviceAccountName")  # there is no API server here
pod = {"apiVersion": "v1", "kind": "Pod", "metadata": {"name": name, "labels": template["metadata"]["labels"]}, "spec": spec}
config_maps = [{**o, "metadata": {"name": o["metadata"]["name"]}} for o in objects if o["kind"] == "ConfigMap"]
secrets = [secret("overtone-server-tls", "server"), secret("overtone-probe-tls", "operator-probe")]
yaml.safe_dump_all(secrets + config_maps + claims + [pod], sys.stdout)
