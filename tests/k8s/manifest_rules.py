# SPDX-License-Identifier: Apache-2.0
"""What the objects of one rendered overlay must be to each other. Every rule yields sentences about what is wrong."""
import re

import pod_rules
import yaml

CLUSTER_WIDE = {"Namespace"}
CERT_MANAGER_KEYS = {"ca.crt", "tls.crt", "tls.key"}


class Manifests:
    def __init__(self, objects, production):
        self.objects, self.production = objects, production

    def of(self, kind):
        return [o for o in self.objects if o["kind"] == kind]

    def named(self, kind, name):
        return next((o for o in self.of(kind) if o["metadata"]["name"] == name), None)

    def workloads(self):
        return self.of("StatefulSet") + self.of("Deployment")


def selects(selector, labels):
    return all(labels.get(key) == value for key, value in selector.items())


def identity(m):
    namespaces = {o["metadata"]["name"] for o in m.of("Namespace")}
    seen = set()
    for o in m.objects:
        key = (o["kind"], o["metadata"]["name"])
        if key in seen:
            yield f"{key} is there twice"
        seen.add(key)
        if o["kind"] not in CLUSTER_WIDE and o["metadata"].get("namespace") not in namespaces:
            yield f"{key} is in no namespace of ours"
    for o in m.of("Namespace"):
        if o["metadata"].get("labels", {}).get("pod-security.kubernetes.io/enforce") != "restricted":
            yield "the namespace does not enforce the restricted standard"


def pods(m):
    for workload in m.workloads():
        name, pod = workload["metadata"]["name"], workload["spec"]["template"]["spec"]
        claims = [c["metadata"]["name"] for c in workload["spec"].get("volumeClaimTemplates", [])]
        for rule in (pod_rules.restricted(pod), pod_rules.house(pod, m.production), pod_rules.mounts(pod, claims)):
            for wrong in rule:
                yield f"{name}: {wrong}"
        if not m.named("ServiceAccount", pod.get("serviceAccountName", "")):
            yield f"{name}: no such service account"
        if workload["kind"] == "StatefulSet" and workload["spec"]["replicas"] != 1:
            yield f"{name}: two servers cannot share a map"


def selectors(m):
    labels = [w["spec"]["template"]["metadata"]["labels"] for w in m.workloads()]
    for workload in m.workloads():
        if not selects(workload["spec"]["selector"]["matchLabels"], workload["spec"]["template"]["metadata"]["labels"]):
            yield f"{workload['metadata']['name']} does not select its own pods"
    chosen = [(o, o["spec"]["selector"]) for o in m.of("Service")]
    chosen += [(o, o["spec"]["selector"]["matchLabels"]) for o in m.of("PodDisruptionBudget")]
    chosen += [(o, o["spec"]["podSelector"].get("matchLabels", {})) for o in m.of("NetworkPolicy")]
    for o, selector in chosen:
        if not selector or sum(selects(selector, l) for l in labels) != 1:
            yield f"{o['kind']} {o['metadata']['name']} does not select the pods of one workload"
    for monitor in m.of("ServiceMonitor"):
        services = [s for s in m.of("Service") if selects(monitor["spec"]["selector"]["matchLabels"], s["metadata"].get("labels", {}))]
        ports = [p["name"] for s in services for p in s["spec"]["ports"]]
        for endpoint in monitor["spec"]["endpoints"]:
            if ports.count(endpoint["port"]) != 1:
                yield f"ServiceMonitor {monitor['metadata']['name']}: {ports.count(endpoint['port'])} ports named {endpoint['port']}"


def ports(m):
    for o in m.of("Service") + m.of("NetworkPolicy"):
        wanted = [p.get("targetPort") for p in o["spec"].get("ports", [])]
        wanted += [p["port"] for rule in o["spec"].get("ingress", []) for p in rule["ports"]]
        selector = o["spec"].get("selector") or o["spec"]["podSelector"].get("matchLabels", {})
        names = {
            p["name"]
            for w in m.workloads() if selects(selector, w["spec"]["template"]["metadata"]["labels"])
            for c in w["spec"]["template"]["spec"]["containers"] for p in c.get("ports", [])
        }
        for port in wanted:
            if port not in names:
                yield f"{o['kind']} {o['metadata']['name']}: no container has a port {port}"
    for workload in m.of("StatefulSet"):
        service = m.named("Service", workload["spec"]["serviceName"])
        if not service or service["spec"].get("clusterIP") != "None":
            yield f"{workload['metadata']['name']}: its service is missing or not headless"


def files(m):
    """Where every mounted path comes from, and what the server's configuration says of it."""
    certificates = {c["spec"]["secretName"] for c in m.of("Certificate")}
    for workload in m.workloads():
        name, spec = workload["metadata"]["name"], workload["spec"]["template"]["spec"]
        volumes = {v["name"]: v for v in spec.get("volumes", [])}
        inside = {}
        for mount in spec["containers"][0]["volumeMounts"]:
            volume = volumes.get(mount["name"], {})
            if "configMap" in volume:
                source = m.named("ConfigMap", volume["configMap"]["name"])
                if not source:
                    yield f"{name}: no ConfigMap {volume['configMap']['name']}"
                    continue
                inside.update({f"{mount['mountPath']}/{key}": text for key, text in source["data"].items()})
            if "secret" in volume:
                if volume["secret"]["secretName"] not in certificates:
                    yield f"{name}: no Certificate writes the secret {volume['secret']['secretName']}"
                inside.update({f"{mount['mountPath']}/{key}": "" for key in CERT_MANAGER_KEYS})
        for variable in spec["containers"][0].get("env", []):
            if variable.get("value", "").startswith("/") and variable["value"] not in inside:
                yield f"{name}: {variable['name']} names {variable['value']}, which is not there"
        if workload["kind"] == "StatefulSet":
            yield from server_configuration(name, spec, inside)


def server_configuration(name, spec, inside):
    arguments = spec["containers"][0]["args"]
    path = arguments[arguments.index("--config") + 1]
    if path not in inside:
        yield f"{name}: no {path}"
        return
    config = yaml.safe_load(inside[path])
    for file in list(config["tls"].values()) + [config["access_file"]]:
        if file not in inside:
            yield f"{name}: the configuration names {file}, which is not there"
    ports = {p["name"]: p["containerPort"] for p in spec["containers"][0]["ports"]}
    for key, port in (("listen", "grpc"), ("metrics_listen", "metrics")):
        if config[key] != f"0.0.0.0:{ports.get(port)}":
            yield f"{name}: {key} is {config[key]}, the port {port} {ports.get(port)}"
    mounted = {mount["mountPath"] for mount in spec["containers"][0]["volumeMounts"]}
    if config["data_dir"] not in mounted:
        yield f"{name}: data_dir {config['data_dir']} is no volume"
    if spec["terminationGracePeriodSeconds"] < 2 * config["shutdown_s"]:
        yield f"{name}: killed before it has drained"
    if config.get("insecure"):
        yield f"{name}: serves without certificates"


def certificates(m):
    namespace = m.of("Namespace")[0]["metadata"]["name"]
    server = m.named("Certificate", "overtone-server")
    for wanted in ("localhost", f"overtone.{namespace}.svc"):
        if wanted not in server["spec"]["dnsNames"]:
            yield f"the server's certificate does not name {wanted}"
    for certificate in m.of("Certificate"):
        issuer, secrets = certificate["spec"]["issuerRef"], certificate["spec"]["secretName"]
        if not m.production and not m.named(issuer["kind"], issuer["name"]):
            yield f"Certificate {certificate['metadata']['name']}: no issuer {issuer['name']}"
        if not re.fullmatch(r"[a-z0-9-]+", secrets):
            yield f"Certificate {certificate['metadata']['name']}: {secrets}"
    probe = m.named("Certificate", "overtone-probe")
    access = yaml.safe_load(m.named("ConfigMap", "overtone-access")["data"]["access.yaml"])
    name = probe["spec"]["uris"][0].rpartition("/")[2]
    for map_id, granted in access["maps"].items():
        if name in granted.get("operators", []) or "*" in granted.get("operators", []):
            yield f"the probe may use map {map_id}"
        if m.production and "*" in granted.get("robots", []):
            yield f"any robot may use map {map_id}"


RULES = (identity, pods, selectors, ports, files, certificates)


def wrong(objects, production):
    return [sentence for rule in RULES for sentence in rule(Manifests(objects, production))]
