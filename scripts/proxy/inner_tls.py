"""TLS between the proxy and the programs behind it, with certificates that are renewed while a program runs.

The server of web and live (granian) reads a certificate when its worker starts, by the path to which a symbolic link first pointed; a
platform that renews it removes that path. So a copy is served, and a watcher restarts the worker with the new one.
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
    """The certificate files of the environment, and their copies in the program's own folder."""

    def __init__(self, folder: Path, certificate: Path, key: Path) -> None:
        self.folder = folder
        self.files = {certificate: folder / "inner.crt", key: folder / "inner.key"}

    def arguments(self) -> list[str]:
        """Return the arguments for the server's command line."""
        certificate, key = self.files.values()
        return ["--ssl-certificate", str(certificate), "--ssl-keyfile", str(key)]

    def is_renewed(self) -> bool:
        """Whether the files differ from their copies; False while a platform is replacing them."""
        try:
            return any(not copy.exists() or named.read_bytes() != copy.read_bytes() for named, copy in self.files.items())
        except OSError:
            return False

    def copy(self) -> None:
        """Copy each file atomically, the key readable by this user only."""
        self.folder.mkdir(parents=True, exist_ok=True)
        for named, copy in self.files.items():
            draft = copy.with_suffix(f"{copy.suffix}.new")
            draft.touch(mode=0o600)
            shutil.copyfile(named, draft)
            draft.replace(copy)


def inner_certificate(folder: Path) -> InnerCertificate | None:
    """Return the certificate; None where programs behind the proxy use plain HTTP."""
    certificate, key = os.environ.get(CERTIFICATE), os.environ.get(KEY)
    return InnerCertificate(folder, Path(certificate), Path(key)) if certificate and key else None


def look_after(found: InnerCertificate, *, pause: Callable[[float], None] = time.sleep) -> None:
    """Watch the certificate beside this program as long as it lives: SIGHUP makes its server restart the worker."""
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
