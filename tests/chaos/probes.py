"""Whether a program of an installation works again, as it says itself at its own address: nothing that stands in front of it answers."""

import http.client
import json
import socket
from pathlib import Path

from deploy.load.installation import Installation
from deploy.load.scaling.replicas import kind_of
from scripts.places import health_socket

TIMEOUT_S = 5.0


class _OverSocket(http.client.HTTPConnection):
    def __init__(self, path: Path) -> None:
        super().__init__("localhost", timeout=TIMEOUT_S)
        self._path = path

    def connect(self) -> None:
        self.sock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.sock.settimeout(TIMEOUT_S)
        self.sock.connect(str(self._path))


def answer_of(path: Path, address: str = "/readyz", **headers: str) -> tuple[int, list[str]]:
    """Status and reasons; 0 where nobody answers."""
    connection = _OverSocket(path)
    try:
        connection.request("GET", address, headers={"X-Forwarded-Proto": "https", **headers})
        answer = connection.getresponse()
        reported = answer.read()
        return answer.status, json.loads(reported).get("reasons", []) if answer.getheader("Content-Type", "").startswith(
            "application/json"
        ) else []
    except (OSError, http.client.HTTPException, ValueError):
        return 0, []
    finally:
        connection.close()


def is_ready(installation: Installation, name: str) -> bool:
    """It says that it can work; the proxy, which is asked nothing, accepts."""
    if kind_of(name) == "proxy":
        with socket.socket() as caller:
            return caller.connect_ex(("127.0.0.1", installation.port)) == 0
    sockets = installation.sockets
    own = sockets / f"{name}.sock" if kind_of(name) in {"web", "live"} else health_socket(sockets, name)
    return answer_of(own)[0] == 200
