"""Which boot of a vehicle a time since boot belongs to, and when that was.

A time that lies behind the one before is of a new boot, or of what the vehicle has kept while the link was lost: of a new boot only if
the vehicle could have started it since it was last heard, unless its own clock of the day, where it has one, says otherwise.
"""

from dataclasses import dataclass, field
from typing import Any

from mavlink.decoding.clock import ON_TIME_S, VehicleClock

OUT_OF_ORDER_S = 1.0  # of the vehicle's time; so far back a message may come late without any question
SAME_EPOCH_S = 5.0
REBOOT_SLACK_S = 2.0
FIRST_DAY_S = 1_420_070_400.0  # 2015: a clock that shows less has not been set
BOOTS_KEPT = 3
LEAP_S = 10.0
LEAPS_BELIEVED = 5  # one after the other


@dataclass
class Boot:
    """One run of a vehicle's clock. `epoch_s` is its day's time at boot as it says itself, `live_at_s` when it was last heard on time."""

    key: str
    clock: VehicleClock
    highest_s: float = 0.0
    live_at_s: float = 0.0
    epoch_s: float | None = None


@dataclass(frozen=True)
class Stamp:
    """When a message was measured, by the server's clock, and what names it for ever: the boot and its time in it."""

    stream: str
    sequence: int
    measured_s: float


@dataclass
class VehicleTime:
    """Fed with every time since boot that a vehicle tells. All times of ours are seconds since 1970."""

    boots: list[Boot] = field(default_factory=list)  # the present one last
    _leaps: int = 0

    @property
    def clock(self) -> VehicleClock | None:
        return self.boots[-1].clock if self.boots else None

    def receive(self, boot_ms: int, now_s: float, *, unix_s: float | None = None) -> Stamp:
        """unix_s: the vehicle's day time, where the message tells it (SYSTEM_TIME).

        A time far ahead of all before it is a fault until several in a row say so: it is stamped with its receipt and teaches nothing.
        """
        boot_s = boot_ms / 1000.0
        epoch_s = unix_s - boot_s if unix_s is not None and unix_s >= FIRST_DAY_S else None
        boot = self._boot_of(boot_s, now_s, epoch_s)
        self._leaps = self._leaps + 1 if self._is_leap(boot, boot_s, now_s) else 0
        if 0 < self._leaps < LEAPS_BELIEVED:
            return Stamp(boot.key, boot_ms, now_s)
        boot.clock.receive(boot_s, now_s)
        if boot.clock.lateness_s(boot_s, now_s) < ON_TIME_S:
            boot.live_at_s = max(boot.live_at_s, now_s)
        boot.highest_s = max(boot.highest_s, boot_s)
        if epoch_s is not None:
            boot.epoch_s = epoch_s
        return Stamp(boot.key, boot_ms, boot.clock.stamp_s(boot_s, now_s))

    def _boot_of(self, boot_s: float, now_s: float, epoch_s: float | None) -> Boot:
        if not self.boots:
            return self._new(boot_s, now_s)
        present = self.boots[-1]
        if epoch_s is not None:
            same = [boot for boot in self.boots if boot.epoch_s is not None and abs(boot.epoch_s - epoch_s) <= SAME_EPOCH_S]
            if same:
                return same[-1]
        if boot_s >= present.highest_s - OUT_OF_ORDER_S:
            return self._former(boot_s, now_s) or present
        if epoch_s is not None and present.epoch_s is not None:
            return self._new(boot_s, now_s)
        started_s = now_s - boot_s / present.clock.rate
        return present if started_s < present.live_at_s - REBOOT_SLACK_S else self._new(boot_s, now_s)

    def _former(self, boot_s: float, now_s: float) -> Boot | None:
        """A boot before the present one, if the time cannot be of the present one yet but was reached then."""
        if not self._is_leap(self.boots[-1], boot_s, now_s):
            return None
        reached = (boot for boot in reversed(self.boots[:-1]) if boot_s <= boot.highest_s + LEAP_S)
        return next(reached, None)

    @staticmethod
    def _is_leap(boot: Boot, boot_s: float, now_s: float) -> bool:
        """Whether the vehicle's clock would have run far more than ours since it was last heard."""
        since_s = max(now_s - boot.live_at_s, 0.0) * boot.clock.rate
        return boot_s - boot.highest_s > LEAP_S + 3 * since_s

    def _new(self, boot_s: float, now_s: float) -> Boot:
        rate = self.boots[-1].clock.rate if self.boots else 1.0
        boot = Boot(f"boot-{(now_s - boot_s / rate) * 1000:.0f}", VehicleClock(rate=rate), highest_s=boot_s, live_at_s=now_s)
        self.boots = [*self.boots[1 - BOOTS_KEPT :], boot]
        return boot

    def to_json(self) -> list[dict[str, Any]]:
        return [_boot_to_json(boot) for boot in self.boots]

    @classmethod
    def from_json(cls, stored: list[dict[str, Any]]) -> "VehicleTime":
        return cls([_boot_from_json(boot) for boot in stored])


def _boot_to_json(boot: Boot) -> dict[str, Any]:
    fields = {name: value for name, value in vars(boot).items() if name != "clock"}
    return fields | {"offset_s": boot.clock.offset_s, "rate": boot.clock.rate}


def _boot_from_json(stored: dict[str, Any]) -> Boot:
    clock = VehicleClock(stored["offset_s"], stored["rate"])
    return Boot(stored["key"], clock, stored["highest_s"], stored["live_at_s"], stored["epoch_s"])
