"""nginx in a container: configuration from the environment, graceful shutdown on SIGTERM, certificate renewal without a lost request."""

import os
import signal
import subprocess
import sys
import threading
from dataclasses import replace
from pathlib import Path
from types import FrameType

from config.private_servers import state_directory
from scripts.installation.system_packages import find_program
from scripts.proxy import proxy_lines
from scripts.proxy.proxy import is_https_asked_for, site_configuration
from scripts.proxy.proxy_site import Site
from scripts.proxy.served_certificate import ServedCertificate

POLL_INTERVAL_S = 5.0
ENDS_WITHIN_S = 8.0
NAME_SERVERS = Path("/etc/resolv.conf")


def name_server(text: str) -> str:
    """Return the first name server of a resolv.conf, as nginx writes it; empty where there is none."""
    for line in text.splitlines():
        words = line.split()
        if len(words) >= 2 and words[0] == "nameserver":
            return f"[{words[1]}]" if ":" in words[1] else words[1]
    return ""


def site_of_environment(folder: Path) -> Site:
    """Return the site of SPANWISE_PROXY_WEB, SPANWISE_PROXY_LIVE and SPANWISE_PROXY_UAV_LINK (default: web serves UAVs).

    Each is a comma-separated list of addresses, or one name with SPANWISE_PROXY_RESOLVES=1. SPANWISE_PROXY_NAME_SERVER sets the name
    server, by default that of the container's resolv.conf. SPANWISE_PROXY_TRUST: the authority of the certificates of web, live and
    uav-link; without it they are reached by plain HTTP. SPANWISE_TLS_CERTIFICATE and SPANWISE_TLS_KEY: files; with them nginx serves TLS on
    SPANWISE_PROXY_TLS_PORT.
    """
    certificate, key = os.environ.get("SPANWISE_TLS_CERTIFICATE"), os.environ.get("SPANWISE_TLS_KEY")
    resolves = os.environ.get("SPANWISE_PROXY_RESOLVES", "0") == "1"
    return Site(
        folder=folder,
        static=Path(os.environ.get("SPANWISE_STATIC_DIR") or state_directory() / "static"),
        web=tuple(os.environ.get("SPANWISE_PROXY_WEB", "web:8000").split(",")),
        live=tuple(os.environ.get("SPANWISE_PROXY_LIVE", "live:8001").split(",")),
        uav_link=tuple(named.split(",")) if (named := os.environ.get("SPANWISE_PROXY_UAV_LINK")) else (),
        listens_at=os.environ.get("SPANWISE_PROXY_PORT", "8080"),
        is_behind_https=is_https_asked_for(),
        certificate=Path(certificate) if certificate and key else None,
        key=Path(key) if certificate and key else None,
        listens_at_tls=os.environ.get("SPANWISE_PROXY_TLS_PORT", "8443"),
        trust=Path(trust) if (trust := os.environ.get("SPANWISE_PROXY_TRUST")) else None,
        resolver=(os.environ.get("SPANWISE_PROXY_NAME_SERVER") or name_server(NAME_SERVERS.read_text())) if resolves else "",
    )


def fingerprint(site: Site) -> tuple[int, ...]:
    """Return a value that changes with the certificate's files, also if a platform replaces their folder."""
    found = []
    for path in (site.certificate, site.key):
        if path is not None:
            try:
                status = path.stat()
            except OSError:
                return ()  # during a replacement
            found += [status.st_ino, status.st_mtime_ns, status.st_size]
    return tuple(found)


def main() -> int:
    folder = state_directory() / "proxy"
    folder.mkdir(parents=True, exist_ok=True)
    site = named = site_of_environment(folder)
    known = fingerprint(named)
    served: ServedCertificate | None = None
    if named.certificate is not None and named.key is not None:
        served = ServedCertificate(folder / "certificate", named.certificate, named.key)
        if not served.take():
            print(f"{named.certificate} and {named.key} are no certificate and its key", file=sys.stderr, flush=True)
            return 1
        site = replace(named, certificate=served.certificate, key=served.key)
    path = folder / "nginx.conf"
    path.write_text(site_configuration(site))
    command = [find_program("nginx") or "nginx", "-e", "stderr", "-p", str(folder), "-c", str(path)]
    nginx = proxy_lines.start(command)

    def end(number: int, frame: FrameType | None) -> None:
        nginx.send_signal(signal.SIGQUIT)  # accepts no new requests and exits after the current ones
        hurry = threading.Timer(ENDS_WITHIN_S, nginx.terminate)  # websockets do not end by themselves
        hurry.daemon = True
        hurry.start()

    for number in (signal.SIGTERM, signal.SIGINT, signal.SIGQUIT):
        signal.signal(number, end)
    while True:
        try:
            return nginx.wait(POLL_INTERVAL_S)
        except subprocess.TimeoutExpired:
            seen = fingerprint(named)
            if served is not None and seen and seen != known and served.take():
                known = seen
                print(proxy_lines.reported("the certificate has changed: new connections get the new one"), file=sys.stderr, flush=True)
