# SPDX-License-Identifier: Apache-2.0
"""What a pod template must keep to: the Pod Security Standard "restricted" (kubernetes.io/docs/concepts/security/pod-security-standards),
and what we ask beyond it. Every rule yields sentences about what is wrong."""

ALLOWED_VOLUMES = {"configMap", "csi", "downwardAPI", "emptyDir", "ephemeral", "persistentVolumeClaim", "projected", "secret"}


def containers(pod):
    return pod.get("initContainers", []) + pod["containers"]


def restricted(pod):
    for key in ("hostNetwork", "hostPID", "hostIPC"):
        if pod.get(key):
            yield f"{key} is on"
    for volume in pod.get("volumes", []):
        for kind in set(volume) - {"name"} - ALLOWED_VOLUMES:
            yield f"volume {volume['name']} is a {kind}"
    pod_context = pod.get("securityContext", {})
    for container in containers(pod):
        name, context = container["name"], container.get("securityContext", {})

        def effective(key):
            return context.get(key, pod_context.get(key))

        if context.get("privileged"):
            yield f"{name} is privileged"
        if context.get("allowPrivilegeEscalation") is not False:
            yield f"{name} may escalate privileges"
        if effective("runAsNonRoot") is not True or effective("runAsUser") == 0:
            yield f"{name} may run as root"
        if effective("seccompProfile") not in ({"type": "RuntimeDefault"},) and (effective("seccompProfile") or {}).get("type") != "Localhost":
            yield f"{name} has no seccomp profile"
        capabilities = context.get("capabilities", {})
        if "ALL" not in capabilities.get("drop", []) or set(capabilities.get("add", [])) - {"NET_BIND_SERVICE"}:
            yield f"{name} keeps capabilities"
        for port in container.get("ports", []):
            if port.get("hostPort"):
                yield f"{name} takes the host's port {port['hostPort']}"


def house(pod, production):
    """Beyond the standard."""
    if pod.get("automountServiceAccountToken") is not False:
        yield "the pod is given a token for the API server"
    if pod.get("securityContext", {}).get("fsGroup") is None:
        yield "no fsGroup: the volume would not be writable"
    for container in containers(pod):
        name, resources = container["name"], container.get("resources", {})
        if container.get("securityContext", {}).get("readOnlyRootFilesystem") is not True:
            yield f"{name} may write to its root file system"
        for resource in ("cpu", "memory"):
            if resource not in resources.get("requests", {}):
                yield f"{name} requests no {resource}"
        if "memory" not in resources.get("limits", {}):
            yield f"{name} has no memory limit"
        tag = container["image"].rpartition("/")[2].partition(":")[2]
        if production and tag in ("", "latest"):
            yield f"{name}: image {container['image']} is not one version"
        for probe in ("livenessProbe", "readinessProbe", "startupProbe"):
            if probe not in container:
                yield f"{name} has no {probe}"


def mounts(pod, claims=()):
    known = {volume["name"] for volume in pod.get("volumes", [])} | set(claims)
    for container in containers(pod):
        for mount in container.get("volumeMounts", []):
            if mount["name"] not in known:
                yield f"{container['name']} mounts {mount['name']}, which is no volume"
