"""Address of a process's metrics: HOST:PORT or unix:PATH, from SPANWISE_METRICS. Only the standard library: the probe starts often."""

import os
from dataclasses import dataclass

VARIABLE = "SPANWISE_METRICS"


class WrongAddress(ValueError):
    """Raised for text that is neither HOST:PORT nor unix:PATH."""


@dataclass(frozen=True)
class Address:
    """Either a path or a host with a port."""

    path: str = ""
    host: str = ""
    port: int = 0

    def __str__(self) -> str:
        if self.path:
            return f"unix:{self.path}"
        return f"[{self.host}]:{self.port}" if ":" in self.host else f"{self.host}:{self.port}"


def address_of(text: str) -> Address | None:
    """Return the address; None for an empty text: metrics are off. Raises WrongAddress."""
    text = text.strip()
    if not text:
        return None
    if text.startswith("unix:"):
        if not text.startswith("unix:/"):
            raise WrongAddress(f"{VARIABLE}: the path of a socket begins with a slash: unix:/path")
        return Address(path=text.removeprefix("unix:"))
    host, _, port = text.rpartition(":")
    if not host or not port.isdigit() or int(port) > 65_535:
        raise WrongAddress(f"{VARIABLE}: {text!r} is no address: HOST:PORT is, or unix:/path")
    return Address(host=host.strip("[]"), port=int(port))


def address_of_environment() -> Address | None:
    """Return the address of the environment. Raises WrongAddress."""
    return address_of(os.environ.get(VARIABLE, ""))
