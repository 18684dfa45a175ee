"""All that detectors may look at, of one UAV at one moment."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from telemetry.alerting.limits import Limits
from telemetry.alerting.memory import Memory
from telemetry.alerting.watched import WatchedUav

Key = tuple[str, str]  # code and subject


@dataclass(frozen=True, slots=True)
class LinkFacts:
    """What is known of the UAV's link. `heard_s` is when anything was last received, by the server's clock."""

    heard_s: float | None = None
    mode: str = ""
    is_armed: bool | None = None
    is_in_air: bool | None = None


@dataclass(frozen=True, slots=True)
class Situation:
    """`open_levels` are those of the alerts that are open, by code and subject: a cause that is known already clears later than it rose."""

    now_s: float
    uav: WatchedUav
    limits: Limits
    memory: Memory
    link: LinkFacts = field(default_factory=LinkFacts)
    open_levels: Mapping[Key, str] = field(default_factory=dict)

    def is_open(self, code: str, subject: str = "") -> bool:
        return (code, subject) in self.open_levels

    @property
    def heard_s(self) -> float | None:
        received_s = None if self.uav.newest is None else self.uav.newest.received_s
        told = [moment for moment in (self.link.heard_s, received_s) if moment is not None]
        return max(told) if told else None

    @property
    def is_in_flight(self) -> bool:
        """As far as is known: armed, or in the air."""
        newest = None if self.uav.newest is None else self.uav.newest.measurement
        is_armed = self.link.is_armed if newest is None or newest.is_armed is None else newest.is_armed
        is_in_air = self.link.is_in_air if newest is None or newest.is_in_air is None else newest.is_in_air
        return bool(is_in_air) or (is_in_air is None and bool(is_armed))
