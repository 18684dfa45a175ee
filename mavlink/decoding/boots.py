"""Assigns a time since boot to a boot of the vehicle, and converts it to the server's clock.

A time before the previous one comes from a new boot, or was recorded while the link was lost. It counts as a new boot only if the vehicle
could have started since its last message, unless the vehicle's time of day, where known, shows otherwise.
"""

from dataclasses import dataclass, field
from typing import Any

from mavlink.decoding.clock import ON_TIME_S, VehicleClock

OUT_OF_ORDER_S = 1.0  # of the vehicle's time: a message this much older than the newest counts as out of order
SAME_EPOCH_S = 5.0
REBOOT_SLACK_S = 2.0
FIRST_DAY_S = 1_420_070_400.0  # 2015: an earlier time of day means a clock that was never set
BOOTS_KEPT = 3
NO_BOOT = "boot-unknown"
LEAP_S = 10.0
LEAPS_BELIEVED = 5  # in a row


@dataclass
class Boot:
    """One run of a vehicle's clock. `epoch_s` is the reported time of day at boot, `live_at_s` the receipt of the last message on time."""

    key: str
    clock: VehicleClock
    highest_s: float = 0.0
    live_at_s: float = 0.0
    epoch_s: float | None = None


@dataclass(frozen=True)
class Stamp:
    """When a message was measured, by the server's clock, and its permanent key: the boot and the time in it."""

    stream: str
    sequence: int
    measured_s: float


@dataclass
class VehicleTime:
    """Converts each time since boot that a vehicle reports. All server times are seconds since 1970."""

    boots: list[Boot] = field(default_factory=list)  # the current one last
    _leaps: int = 0

    @property
    def clock(self) -> VehicleClock | None:
        return self.boots[-1].clock if self.boots else None

    @property
    def stream(self) -> str:
        """The key of the current boot, NO_BOOT before the vehicle has reported its time."""
        return self.boots[-1].key if self.boots else NO_BOOT

    def receive(self, boot_ms: int, now_s: float, *, unix_s: float | None = None) -> Stamp:
        """Return the stamp of a message.

        unix_s: the vehicle's time of day, if the message has it (SYSTEM_TIME).

        A time far ahead of all earlier ones counts as a fault until several in a row agree. Until then a message is stamped with its
        receipt and does not update the clock.
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
        """Return an earlier boot that reached this time if the current boot cannot have reached it, else None."""
        if not self._is_leap(self.boots[-1], boot_s, now_s):
            return None
        reached = (boot for boot in reversed(self.boots[:-1]) if boot_s <= boot.highest_s + LEAP_S)
        return next(reached, None)

    @staticmethod
    def _is_leap(boot: Boot, boot_s: float, now_s: float) -> bool:
        """Return whether the vehicle's clock would have run far more than the server's since its last message."""
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
