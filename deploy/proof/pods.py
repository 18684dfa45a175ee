"""Deployments of the shipped YAML as podman pods: what is changed for one machine without a cluster, and what is then seen of them."""

import contextlib
import copy
import http.client
import json
import os
import shutil
import signal
import ssl
import subprocess
import time
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from operation.json_lines import is_json
from scripts.places import PROJECT_DIR

Manifest = dict[str, Any]
PODMAN_SETTINGS = """[containers]
default_ulimits=["nofile=4096:4096","nproc=4096:4096"]
log_driver="k8s-file"
[engine]
runtime="runc"
cgroup_manager="cgroupfs"
"""


class Podman:
    """podman with settings that a machine without systemd and without CAP_SYS_RESOURCE can follow."""

    def __init__(self, folder: Path) -> None:
        settings = folder / "containers.conf"
        settings.write_text(PODMAN_SETTINGS)
        self._environment = os.environ | {"CONTAINERS_CONF": str(settings)}

    def __call__(self, *arguments: str, check: bool = True, timeout_s: float = 300.0) -> str:
        done = subprocess.run(["podman", *arguments], env=self._environment, capture_output=True, text=True, check=False, timeout=timeout_s)
        if check and done.returncode != 0:
            raise RuntimeError(f"podman {' '.join(arguments[:4])}: {done.stderr.strip()[-2000:]}")
        return done.stdout.strip()

    def logs(self, container: str) -> str:
        done = subprocess.run(["podman", "logs", container], env=self._environment, capture_output=True, text=True, check=False)
        return done.stdout + done.stderr


def shipped(overlay: str) -> list[Manifest]:
    """Every object of an overlay, as kubectl renders it."""
    folder = PROJECT_DIR / "deploy" / "kubernetes" / "overlays" / overlay
    text = subprocess.run(["kubectl", "kustomize", str(folder)], capture_output=True, text=True, check=True).stdout
    return [document for document in yaml.safe_load_all(text) if document]


def _found(manifests: Iterable[Manifest], kind: str, name: str) -> Manifest:
    return next(one for one in manifests if one["kind"] == kind and one["metadata"]["name"].startswith(name))


@dataclass
class Pod:
    """One replica of one program."""

    program: str
    number: int
    manifest: Manifest
    probes: dict[str, Any]
    ports: dict[str, int]
    settings: dict[str, str]
    address: str = ""
    began_s: float = 0.0
    ready_s: float = -1.0
    exit_s: float = -1.0
    faults: list[str] = field(default_factory=list)

    @property
    def name(self) -> str:
        return f"proof-{self.program}-{self.number}"

    @property
    def container(self) -> str:
        return f"{self.name}-pod-0-program"


@dataclass
class Site:
    """The shipped objects, and what this machine has in a cluster's place."""

    podman: Podman
    manifests: list[Manifest]
    image: str
    files: Path
    secrets: dict[str, Path]  # folders by the names of secrets
    gateway: str
    settings: dict[str, str]

    def pod(self, program: str, number: int, **own: str) -> Pod:
        """The Deployment or Job as it is shipped, with these changes: the image of this machine; folders for the claim and for secrets
        (older podmans do not decode these); addresses in place of names that a cluster resolves; the kubelet's probes are asked by this
        program, since podman asks with a curl that the image does not have.
        """
        kind = "Job" if program == "migrate" else "Deployment"
        deployment = copy.deepcopy(_found(self.manifests, kind, program))
        template = deployment["spec"]["template"]
        container = template["spec"]["containers"][0]
        probes = {name: container.pop(name) for name in ("startupProbe", "livenessProbe", "readinessProbe") if name in container}
        container.pop("lifecycle", None)
        ports = {entry["name"]: entry["containerPort"] for entry in container.pop("ports", [])}  # podman would take them on this machine
        container["image"] = self.image
        template["spec"]["hostAliases"] = [{"ip": self.gateway, "hostnames": ["postgresql", "redis"]}]
        for volume in template["spec"].get("volumes", []):
            if "persistentVolumeClaim" in volume:
                volume.pop("persistentVolumeClaim")
                volume["hostPath"] = {"path": str(self.files), "type": "Directory"}
            if "emptyDir" in volume:  # which podman would share between pods, by its name
                volume.pop("emptyDir")
                volume["hostPath"] = {"path": str(self._own_folder(f"proof-{program}-{number}", volume["name"])), "type": "Directory"}
            if "secret" in volume:
                volume["hostPath"] = {"path": str(self.secrets[volume.pop("secret")["secretName"]]), "type": "Directory"}
        name = f"proof-{program}-{number}"
        whole = {"apiVersion": "apps/v1", "kind": "Deployment", "metadata": {"name": name}, "spec": {"replicas": 1, "template": template}}
        template["spec"]["restartPolicy"] = "Never" if program == "migrate" else "Always"
        whole["spec"]["selector"] = {"matchLabels": template["metadata"]["labels"]}
        return Pod(program, number, whole, probes, ports, own)

    def _own_folder(self, pod: str, volume: str) -> Path:
        folder = self.files.parent / "own" / pod / volume
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        folder.chmod(0o1777)
        return folder

    def settings_of(self, pod: Pod) -> Manifest:
        """The settings as they are shipped, with this site's own and the pod's."""
        settings = copy.deepcopy(_found(self.manifests, "ConfigMap", "settings"))
        settings["data"] |= self.settings | pod.settings
        return settings

    def start(self, pod: Pod, folder: Path) -> None:
        path = folder / f"{pod.name}.yaml"
        path.write_text(yaml.safe_dump_all([self.settings_of(pod), pod.manifest]))
        pod.began_s = time.monotonic()
        # A pod that is started again has the address that it had: here no name leads to it.
        self.podman("play", "kube", *(["--ip", pod.address] if pod.address else []), str(path))
        networks = json.loads(self.podman("inspect", pod.container, "--format", "{{json .NetworkSettings.Networks}}"))
        pod.address = next(iter(networks.values()))["IPAddress"]

    def start_again(self, pod: Pod, folder: Path) -> None:
        """What a Deployment does when a pod has ended."""
        self.end(pod)
        self.start(pod, folder)

    def end(self, pod: Pod) -> None:
        with contextlib.suppress(RuntimeError):
            self.podman("pod", "rm", "--force", "--time", "1", f"{pod.name}-pod-0")


def secret_folder(folder: Path, values: dict[str, str], user: int) -> Path:
    """Files that this user alone can read."""
    folder.mkdir()
    for name, value in values.items():
        path = folder / name
        path.touch(mode=0o400)
        path.write_text(value)
        os.chown(path, user, user)
    os.chown(folder, user, user)
    return folder


def answers(pod: Pod, probe: str, timeout_s: float = 5.0) -> bool:
    """Whether the pod passes a probe of its Deployment now, as a kubelet would ask it."""
    asked = pod.probes[probe]["httpGet"]
    connection: http.client.HTTPConnection
    if asked.get("scheme") == "HTTPS":  # a kubelet looks at no certificate
        unchecked = ssl.create_default_context()
        unchecked.check_hostname, unchecked.verify_mode = False, ssl.CERT_NONE
        connection = http.client.HTTPSConnection(pod.address, pod.ports[asked["port"]], timeout=timeout_s, context=unchecked)
    else:
        connection = http.client.HTTPConnection(pod.address, pod.ports[asked["port"]], timeout=timeout_s)
    try:
        connection.request("GET", asked["path"])
        return 200 <= connection.getresponse().status < 400
    except OSError:
        return False
    finally:
        connection.close()


def wait_until_ready(pods: list[Pod], patience_s: float) -> None:
    """Notes for each how long it took from its own start."""
    waiting, end_s = list(pods), time.monotonic() + patience_s
    while waiting and time.monotonic() < end_s:
        for pod in list(waiting):
            if answers(pod, "startupProbe") and answers(pod, "readinessProbe"):
                pod.ready_s = time.monotonic() - pod.began_s if pod.ready_s < 0 else pod.ready_s  # the first time counts
                waiting.remove(pod)
        time.sleep(0.2)
    if waiting:
        raise TimeoutError(f"not ready after {patience_s:.0f} s: {', '.join(pod.name for pod in waiting)}")


def look_at_rights(podman: Podman, pod: Pod) -> None:
    """What the kernel says of the program's own process: user, capabilities, whether it may gain any, and where it may write."""
    process = podman("inspect", pod.container, "--format", "{{.State.Pid}}")
    facts = dict(line.split(":\t", 1) for line in Path(f"/proc/{process}/status").read_text().splitlines() if ":\t" in line)
    if facts["Uid"].split()[0] != "10001":
        pod.faults.append(f"runs as user {facts['Uid'].split()[0]}")
    if int(facts["CapEff"], 16) or int(facts["CapBnd"], 16):
        pod.faults.append("has capabilities")
    if facts["NoNewPrivs"].strip() != "1":
        pod.faults.append("may gain rights")
    root = next(line for line in Path(f"/proc/{process}/mounts").read_text().splitlines() if line.split()[1] == "/")
    if "ro" not in root.split()[3].split(","):
        pod.faults.append("its root can be written to")


def stop_softly(podman: Podman, pod: Pod, patience_s: float) -> None:
    """SIGTERM to the container's first process, and how long it took to end."""
    process = int(podman("inspect", pod.container, "--format", "{{.State.Pid}}"))
    began_s = time.monotonic()
    os.kill(process, signal.SIGTERM)  # podman would take seconds of its own on a busy machine
    while _is_running(process) and time.monotonic() - began_s < patience_s:
        time.sleep(0.02)
    pod.exit_s = time.monotonic() - began_s
    if _is_running(process):
        pod.faults.append(f"still there {patience_s:.0f} s after SIGTERM")


def _is_running(process: int) -> bool:
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def look_at_lines(pod: Pod, written: str) -> None:
    """Where logs are JSON, every line is."""
    others = [line for line in written.splitlines() if line.strip() and not is_json(line)]
    if others:
        pod.faults.append(f"{len(others)} lines are no JSON, first: {others[0][:120]!r}")
