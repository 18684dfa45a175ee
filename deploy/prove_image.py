"""Proves the image on one machine without a cluster: every program started from the shipped Kubernetes YAML, killed, and stopped.

deploy/prove_image.py IMAGE [--overlay production] [--lasts-s 30] [--json FILE]

As root, with podman, kubectl, PostgreSQL with PostGIS and Redis. The programs run in pods as their Deployments say (user, read-only root,
no capabilities, limits, probes), against PostgreSQL and Redis with TLS and verified certificates. Printed: seconds until ready, seconds
from SIGTERM to the end, and requests that failed while one of two web replicas is killed (SIGKILL), stopped (SIGTERM) and started again,
and while the proxy's certificate is swapped. The bars: ready within 60 s, ended within 10 s, none failed, every line of log JSON. Exit
code 1 if one is missed.
"""

import argparse
import json
import os
import shutil
import ssl
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

PROJECT_DIR = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(PROJECT_DIR))

from deploy.load.certificates import make_certificate  # noqa: E402
from deploy.load.scaling.name_server import NameServer  # noqa: E402
from deploy.proof.load import Counted, Proxy, plan_bodies, under_load  # noqa: E402
from deploy.proof.pods import (  # noqa: E402
    Pod,
    Podman,
    Site,
    answers,
    look_at_lines,
    look_at_rights,
    secret_folder,
    shipped,
    stop_softly,
    wait_until_ready,
)
from deploy.proof.servers import Servers, running_servers  # noqa: E402

READY_S, END_S = 60.0, 10.0
TIMEOUT_S = 900.0  # after which there is nothing to be proven
USER = 10001  # of the image
SERVICES = "spanwise.svc.cluster.local"
BACKUP = "/var/lib/spanwise-files/backups/proof"
PROGRAMS = (
    "live",
    "uav-link",
    "gateway",
    "estimator",
    "simulator",
    "worker-data",
    "worker-flight",
    "worker-planning",
    "worker-proofs",
    "worker-simulation",
    "beat",
)
NETWORK = "podman-default-kube-network"  # what podman play kube puts pods into
DEMO = [
    ["make_demo_region", "/var/lib/spanwise/demo"],
    ["import_osm", "/var/lib/spanwise/demo/demo.osm.pbf", "--synthetic"],
    ["import_zones", "/var/lib/spanwise/demo/demo-zones.json", "--synthetic"],
    ["load_demo", "--user", "proof", "--password-file", "/var/lib/spanwise/password"],
    ["build_graph"],
]


class Proof:
    """One run: what was started, and what came of it."""

    def __init__(self, options: argparse.Namespace, folder: Path) -> None:
        self.options, self.folder = options, folder
        self.podman = Podman(folder)
        self.pods: list[Pod] = []
        self.figures: dict[str, str] = {}
        self.missed: list[str] = []

    def run(self) -> int:
        if NETWORK not in self.podman("network", "ls", "--format", "{{.Name}}").split():
            self.podman("network", "create", NETWORK)  # which podman does at its first pod, later than its gateway is asked for here
        network = json.loads(self.podman("network", "inspect", NETWORK))[0]["subnets"][0]
        with running_servers(self.folder, network["subnet"]) as servers:
            self.names = NameServer("0.0.0.0")  # noqa: S104 - which a cluster has; pods reach it at their gateway, once there is one
            self.site = self._site(servers, network["gateway"])
            try:
                self._migrate()
                self._start_all()
                self._bring_ground()
                self._kill_under_load()
                self._swap_certificate(servers)
                self._back_up()
                self._stop_all()
                self._restore()
            finally:
                for pod in list(self.pods):
                    self._end(pod)
                self.names.close()
        return self._report()

    def _end(self, pod: Pod) -> None:
        if self.options.keep_logs:
            self.options.keep_logs.mkdir(parents=True, exist_ok=True)
            (self.options.keep_logs / f"{pod.name}.log").write_text(self.podman.logs(pod.container))
        self.site.end(pod)
        self.pods.remove(pod)

    def _notify(self, what: str, figure: str) -> None:
        """At once: a run that ends early has not been for nothing."""
        self.figures[what] = figure
        print(f"{what}: {figure}", flush=True)

    def _site(self, servers: Servers, gateway: str) -> Site:
        files = self.folder / "files"
        files.mkdir()
        shutil.chown(files, USER, USER)
        trust = Path("/run/trust/ca.crt")
        secrets = {
            "database-url": servers.database_url.replace("/run/secrets/ca-certificate", str(trust)),
            "redis-url": servers.redis_url.replace("/run/secrets/ca-certificate", str(trust)),
            "secret-key": (servers.secrets / "secret-key").read_text().strip(),
            "email-url": "console://",
        }
        own = {
            "SPANWISE_PROXY_NAME_SERVER": f"{gateway}:{self.names.address.rpartition(':')[2]}",
            "SPANWISE_PLAN_RATE": "1000/second",
            "SPANWISE_SIMULATOR_GATEWAY": f"{gateway}:14550",
        }
        folders = {
            "secrets": secret_folder(self.folder / "program-secrets", secrets, USER),
            "trust": secret_folder(self.folder / "trust", {"ca.crt": (servers.secrets / "ca.crt").read_text()}, USER),
            **{f"inner-{program}-certificate": self._inner_certificate(servers, program) for program in ("web", "live", "uav-link")},
        }
        return Site(self.podman, shipped(self.options.overlay), self.options.image, files, folders, gateway, own)

    def _inner_certificate(self, servers: Servers, program: str) -> Path:
        """What cert-manager makes: by the authority inside, for the name of the program's Service."""
        made = self.folder / f"inner-{program}"
        made.mkdir()
        for name in ("ca.crt", "ca.key"):
            shutil.copyfile(servers.secrets / name, made / name)
        files = make_certificate(made, f"DNS:{program}.{SERVICES}")
        return secret_folder(self.folder / f"inner-{program}-secret", {path.name: path.read_text() for path in files}, USER)

    def _start(self, pod: Pod) -> Pod:
        self.pods.append(pod)
        self.site.start(pod, self.folder)
        return pod

    def _migrate(self) -> None:
        began_s = time.monotonic()
        pod = self._start(self.site.pod("migrate", 1))
        code = self.podman("wait", pod.container, timeout_s=600)
        if code != "0":
            raise RuntimeError(f"the migration ended with {code}: {self.podman.logs(pod.container)[-2000:]}")
        self._notify("migration of an empty database", f"{time.monotonic() - began_s:.1f} s")

    def _start_all(self) -> None:
        """All at once, as a cluster does."""
        began_s = time.monotonic()
        first = [self.site.pod("web", 1), self.site.pod("web", 2), *(self.site.pod(program, 1) for program in PROGRAMS)]
        with ThreadPoolExecutor(4) as several:
            started = list(several.map(self._start, first))
        self.web = started[:2]
        self.names.notify(f"web.{SERVICES}", [pod.address for pod in self.web])  # also of one that is gone: the proxy finds out by itself
        for name in ("live", "uav-link"):
            self.names.notify(f"{name}.{SERVICES}", [next(pod for pod in started if pod.program == name).address])
        self.proxy_pod = self._start(self.site.pod("proxy", 1))
        self.running = [*started, self.proxy_pod]
        wait_until_ready(self.running, TIMEOUT_S)
        whole_s = time.monotonic() - began_s
        self._notify("every program ready", f"{whole_s:.1f} s after the first was started")
        if whole_s > READY_S:
            self.missed.append(f"all programs were ready after {whole_s:.0f} s, not {READY_S:.0f} s")
        for pod in self.running:
            look_at_rights(self.podman, pod)
            if not answers(pod, "livenessProbe"):
                pod.faults.append("is not alive by its liveness probe")
            if self.podman("exec", pod.container, "sh", "-c", "spanwise healthy >/dev/null 2>&1 && echo yes", check=False) != "yes":
                pod.faults.append("is not healthy by the image's own health check")

    def _manage(self, *arguments: str) -> str:
        return self.podman("exec", self.web[0].container, "spanwise", "manage", *arguments, timeout_s=600)

    def _bring_ground(self) -> None:
        began_s = time.monotonic()
        self.podman("exec", self.web[0].container, "sh", "-c", "head -c 18 /dev/urandom | base64 >/var/lib/spanwise/password")
        for command in DEMO:
            self._manage(*command)
        self._notify("demo region, imported and its graph built", f"{time.monotonic() - began_s:.1f} s")
        token = self._manage("api_token", "proof", "--days", "1").splitlines()[-1]
        self.proxy = Proxy(self.proxy_pod.address, 8080, token)
        self.bodies = plan_bodies(self.proxy)
        for _ in range(3):  # both replicas have read the graph
            under_load(self.proxy, self.bodies, 8, 2.0, lambda: None)

    def _note(self, what: str, counted: Counted) -> None:
        self._notify(what, str(counted))
        if counted.failed:
            self.missed.append(f"{what}: {counted.failed} failed, first: {counted.faults[:3]}")

    def _kill_under_load(self) -> None:
        victim = self.web[0]
        kill = lambda: self.podman("kill", "--signal", "KILL", victim.container)  # noqa: E731
        self._note("one of two web replicas killed under load", self._load(kill))
        self._again(victim)
        stop = lambda: self.podman("kill", "--signal", "TERM", victim.container)  # noqa: E731
        self._note("one of two web replicas stopped under load", self._load(stop))
        self._again(victim)

    def _again(self, pod: Pod) -> None:
        self.site.start_again(pod, self.folder)
        wait_until_ready([pod], TIMEOUT_S)

    def _load(self, meanwhile: object) -> Counted:
        return under_load(self.proxy, self.bodies, self.options.people, self.options.lasts_s, lambda: (meanwhile(), None)[1])  # type: ignore[operator]

    def _swap_certificate(self, servers: Servers) -> None:
        """A proxy that speaks TLS itself, as compose has it. Its certificate is replaced twice under load."""
        certificates = servers.secrets / "web"
        for file in certificates.iterdir():
            shutil.chown(file, USER, USER)
        pod = self.site.pod("proxy", 2, SPANWISE_TLS_CERTIFICATE="/run/certificate/tls.crt", SPANWISE_TLS_KEY="/run/certificate/tls.key")
        template = pod.manifest["spec"]["template"]["spec"]
        template["containers"][0]["volumeMounts"].append({"name": "certificate", "mountPath": "/run/certificate"})
        template["volumes"].append({"name": "certificate", "hostPath": {"path": str(certificates), "type": "Directory"}})
        self._start(pod)
        wait_until_ready([pod], TIMEOUT_S)
        trust = ssl.create_default_context()
        trust.check_hostname, trust.verify_mode = False, ssl.CERT_NONE  # two self-signed ones follow each other
        proxy = Proxy(pod.address, 8443, self.proxy.token, trust)
        seen = {_serial(pod.address)}

        def swap() -> None:
            for _ in range(2):
                for name in ("tls.crt", "tls.key"):
                    (certificates / name).unlink()
                subprocess.run(
                    [PROJECT_DIR / "deploy" / "make-secrets", "spanwise.example.org", servers.secrets], check=True, capture_output=True
                )
                for file in certificates.iterdir():
                    shutil.chown(file, USER, USER)
                end_s = time.monotonic() + TIMEOUT_S
                while (serial := _serial(pod.address)) in seen and time.monotonic() < end_s:
                    time.sleep(0.2)
                seen.add(serial)

        self._note("certificate swapped twice under load", under_load(proxy, self.bodies, self.options.people, self.options.lasts_s, swap))
        if len(seen) != 3:
            self.missed.append(f"{len(seen)} certificates were seen, not 3")
        self._notify("TLS below 1.2", "refused" if _refuses_old_tls(pod.address) else "accepted")
        if self.figures["TLS below 1.2"] != "refused":
            self.missed.append("TLS 1.1 is accepted")
        connection = Proxy(pod.address, 8080, self.proxy.token).connect()
        connection.request("GET", "/sign-in", headers={"Host": "spanwise.example.org"})
        answer = connection.getresponse()
        self._notify("http", f"{answer.status} {answer.headers.get('Location', '')}")
        if (answer.status, answer.headers.get("Location")) != (308, "https://spanwise.example.org/sign-in"):
            self.missed.append("http does not lead to https")

    def _back_up(self) -> None:
        """While everything runs."""
        began_s = time.monotonic()
        self.podman("exec", self.web[0].container, "spanwise", "backup", BACKUP, timeout_s=TIMEOUT_S)
        self._notify("backup while everything runs", f"{time.monotonic() - began_s:.1f} s")

    def _restore(self) -> None:
        """In a pod made of the migration's Job, with the files, as the documentation has it."""
        began_s = time.monotonic()
        pod = self.site.pod("migrate", 2)
        template = pod.manifest["spec"]["template"]["spec"]
        template["containers"][0]["args"] = ["restore", BACKUP, "--replace"]
        template["containers"][0]["volumeMounts"].append({"name": "files", "mountPath": "/var/lib/spanwise-files"})
        template["volumes"].append({"name": "files", "hostPath": {"path": str(self.site.files), "type": "Directory"}})
        self._start(pod)
        code = self.podman("wait", pod.container, timeout_s=TIMEOUT_S)
        self._notify("restore into the same database", f"{time.monotonic() - began_s:.1f} s")
        if code != "0":
            self.missed.append(f"the restore ended with {code}: {self.podman.logs(pod.container)[-500:]}")

    def _stop_all(self) -> None:
        for pod in reversed(self.running):
            stop_softly(self.podman, pod, END_S)
            look_at_lines(pod, self.podman.logs(pod.container))
            self._end(pod)  # or it would be started again, as a cluster does

    def _report(self) -> int:
        print(f"{'program':<20} {'ready s':>8} {'end s':>8}")
        for pod in self.running:
            print(f"{pod.name.removeprefix('proof-'):<20} {pod.ready_s:8.1f} {pod.exit_s:8.2f}  {'; '.join(pod.faults)}")
            self.missed += [f"{pod.name}: {fault}" for fault in pod.faults]
        self._notify("load of the machine at the end", f"{os.getloadavg()[1]:.1f} on {os.cpu_count()} cores")
        for missed in self.missed:
            print(f"MISSED {missed}")
        if self.options.json:
            programs = {pod.name: {"ready_s": pod.ready_s, "exit_s": pod.exit_s} for pod in self.running}
            self.options.json.write_text(json.dumps({"programs": programs, "figures": self.figures, "missed": self.missed}, indent=1))
        return int(bool(self.missed))


def _serial(address: str) -> str:
    return ssl.get_server_certificate((address, 8443), timeout=10)


def _refuses_old_tls(address: str) -> bool:
    done = subprocess.run(
        ["openssl", "s_client", "-connect", f"{address}:8443", "-tls1_1", "-cipher", "ALL@SECLEVEL=0"],
        stdin=subprocess.DEVNULL, capture_output=True, check=False, timeout=30,
    )  # fmt: skip
    return done.returncode != 0 or b"Cipher is (NONE)" in done.stdout


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("image")
    parser.add_argument("--overlay", default="production")
    parser.add_argument("--people", type=int, default=16, help="who ask at once under load")
    parser.add_argument("--lasts-s", type=float, default=30.0, help="of each load")
    parser.add_argument("--json", type=Path)
    parser.add_argument("--keep-logs", type=Path, metavar="FOLDER", help="what the programs have written")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="spanwise-proof-") as folder:
        return Proof(options, Path(folder)).run()


if __name__ == "__main__":
    sys.exit(main())
