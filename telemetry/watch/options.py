"""What a watch is started with."""

import os
import re
import secrets
import socket
from dataclasses import dataclass, field

from django.conf import settings

LEASE_S = 3.0  # a killed watch's UAVs are taken over within this and one round


@dataclass(frozen=True)
class Options:
    """`name` is the same at every start of one watch, and no other's; `holder` is of this run alone. It holds `most_uavs` at most."""

    name: str
    most_uavs: int
    run: str = field(default_factory=lambda: secrets.token_hex(4))
    lease_s: float = LEASE_S

    @property
    def holder(self) -> str:
        return f"{self.name}/{self.run}"


def options_of_settings(*, name: str | None = None, most_uavs: int | None = None) -> Options:
    """Without a name, of this process alone: two watches on a machine are two."""
    named = name or settings.ESTIMATOR_NAME or f"{socket.gethostname()}-{os.getpid()}"
    return Options(re.sub(r"[^\w.-]", "-", named)[:80], settings.ESTIMATOR_MAX_UAVS if most_uavs is None else most_uavs)
