"""The proxy's certificate: a copy, replaced as a whole once certificate and key match.

nginx reads it at each handshake. So a new one needs no reload, which would close connections about to be used, and clients never get a
mismatched pair.
"""

import shutil
import ssl
from pathlib import Path

CERTIFICATE, KEY = "tls.crt", "tls.key"


class ServedCertificate:
    """Copies, in the proxy's own folder, of certificate files that are renewed elsewhere."""

    def __init__(self, folder: Path, certificate: Path, key: Path) -> None:
        self._folder = folder
        self._named = {CERTIFICATE: certificate, KEY: key}
        self._in_use = folder / "in-use"
        self._turn = 0
        self._served: Path | None = None
        self._before: Path | None = None  # a handshake may still be reading it
        shutil.rmtree(folder, ignore_errors=True)  # left by an earlier proxy
        folder.mkdir(mode=0o700, parents=True)

    @property
    def certificate(self) -> Path:
        return self._in_use / CERTIFICATE

    @property
    def key(self) -> Path:
        return self._in_use / KEY

    def take(self) -> bool:
        """Serve the current files; returns False while certificate and key do not match, as during a replacement."""
        self._turn += 1
        place = self._folder / str(self._turn)
        place.mkdir(mode=0o700)
        try:
            for name, named in self._named.items():
                shutil.copyfile(named, place / name)
            ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER).load_cert_chain(place / CERTIFICATE, place / KEY)
        except (OSError, ssl.SSLError):
            shutil.rmtree(place)
            return False
        link = self._folder / "next"
        link.symlink_to(place.name)
        link.replace(self._in_use)
        if self._before is not None:
            shutil.rmtree(self._before)
        self._before = self._served
        self._served = place
        return True
