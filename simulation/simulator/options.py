"""What a simulator is started with."""

import os
import re
import secrets
import socket
from dataclasses import dataclass, field

from django.conf import settings

from simulation.vehicle_endpoint.radio import Address, address_of

LEASE_S = 10.0  # a killed simulator's simulations are taken over within this and one round


@dataclass(frozen=True)
class Options:
    """`name` is the same at every start of one simulator, and no other's; `holder` is of this run alone.

    `most_load`: simulated seconds a second that it takes on, over all UAVs. `gateway`: where a mission's UAVs connect, None where none
    listens; `host`: where the pool's listen.
    """

    name: str
    most_load: float
    gateway: Address | None
    host: str
    run: str = field(default_factory=lambda: secrets.token_hex(4))
    lease_s: float = LEASE_S

    @property
    def holder(self) -> str:
        return f"{self.name}/{self.run}"


def options_of_settings(*, name: str | None = None, most_uavs: int | None = None, gateway: str | None = None) -> Options:
    """Without a name, of this process alone. Raises WrongAddress."""
    reached_at = gateway or settings.SIMULATOR_GATEWAY or settings.GATEWAY_UDP.split(",")[0]
    named = name or settings.SIMULATOR_NAME or f"{socket.gethostname()}-{os.getpid()}"
    return Options(
        name=re.sub(r"[^\w.-]", "-", named)[:80],
        most_load=float(settings.SIMULATOR_MAX_UAVS if most_uavs is None else most_uavs),
        gateway=gateway_address(reached_at) if reached_at else None,
        host=settings.SIMULATOR_HOST,
    )


def gateway_address(text: str) -> Address:
    """A gateway that listens everywhere is reached on this machine. Raises WrongAddress."""
    host, port = address_of(text)
    return {"0.0.0.0": "127.0.0.1", "::": "::1"}.get(host, host), port  # noqa: S104 - told apart, not bound
