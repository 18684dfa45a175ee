"""TLS between the proxy and the programs behind it: certificates that are renewed while a program runs.

The server of web and live (granian) reads a certificate when its worker starts, by the path that a symbolic link led to at first; a
platform that renews takes that path away. So a copy is served, and whoever looks after it starts the worker again with the new one.
"""

import os
import shutil
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path

CERTIFICATE, KEY = "SPANWISE_INNER_CERTIFICATE", "SPANWISE_INNER_KEY"
POLL_INTERVAL_S = 30.0


class InnerCertificate:
    """What the environment names, and the copies of it in a folder of the program's own."""

    def __init__(self, folder: Path, certificate: Path, key: Path) -> None:
        self.folder = folder
        self.files = {certificate: folder / "inner.crt", key: folder / "inner.key"}

    def arguments(self) -> list[str]:
        """For the server's command line."""
        certificate, key = self.files.values()
        return ["--ssl-certificate", str(certificate), "--ssl-keyfile", str(key)]

    def is_renewed(self) -> bool:
        """Whether what is named differs from the copies. A platform between two states has renewed nothing yet."""
        try:
            return any(not copy.exists() or named.read_bytes() != copy.read_bytes() for named, copy in self.files.items())
        except OSError:
            return False

    def copy(self) -> None:
        """Each file is there as a whole, old or new, and the key for this user alone."""
        self.folder.mkdir(parents=True, exist_ok=True)
        for named, copy in self.files.items():
            draft = copy.with_suffix(f"{copy.suffix}.new")
            draft.touch(mode=0o600)
            shutil.copyfile(named, draft)
            draft.replace(copy)


def inner_certificate(folder: Path) -> InnerCertificate | None:
    """None where programs behind the proxy speak plain HTTP."""
    certificate, key = os.environ.get(CERTIFICATE), os.environ.get(KEY)
    return InnerCertificate(folder, Path(certificate), Path(key)) if certificate and key else None


def look_after(found: InnerCertificate, *, pause: Callable[[float], None] = time.sleep) -> None:
    """Beside the program that this process becomes, for as long as it lives: SIGHUP makes its server start the worker again."""
    program = os.getpid()
    if os.fork():
        return
    while os.getppid() == program:
        pause(POLL_INTERVAL_S)
        if found.is_renewed():
            found.copy()
            print("the certificate inside has changed: the worker starts again with it", file=sys.stderr, flush=True)
            os.kill(program, signal.SIGHUP)
    os._exit(0)
