"""The time that a UAV flies by, beside the server's.

A UAV that is not there may fly faster than real time. Its speeds, the times that were planned for it and how long its battery lasts are all
by its own clock, whose rate against the server's the gateway learns from what it hears; it is 1 of every other UAV.
"""

import math
from bisect import bisect_right
from dataclasses import dataclass, field

SLOWEST, FASTEST = 0.05, 100.0  # what is learnt beyond is no clock's rate
SAME_RATE = 0.02  # by which what is learnt of one rate may differ from time to time
RATES_KEPT = 32


@dataclass(frozen=True, slots=True)
class _Stretch:
    """From `server_s` on, when its own clock showed `uav_s`."""

    server_s: float
    uav_s: float
    rate: float


@dataclass
class UavClock:
    """Both clocks show the same until the rate is another one, and go on from there; what was before stays as it was."""

    _stretches: list[_Stretch] = field(default_factory=lambda: [_Stretch(0.0, 0.0, 1.0)])

    @property
    def rate(self) -> float:
        """Its seconds a second of the server's."""
        return self._stretches[-1].rate

    def run_at(self, rate: float | None, from_s: float) -> None:
        """From a moment of the server's clock on. None, and what cannot be: as the server's."""
        rate = plausible_rate(rate)
        if abs(rate - self.rate) <= SAME_RATE * self.rate:
            return
        last = self._stretches[-1]
        from_s = max(from_s, last.server_s)
        self._stretches.append(_Stretch(from_s, self.uav_s(from_s), rate))
        del self._stretches[:-RATES_KEPT]

    def uav_s(self, server_s: float) -> float:
        place = bisect_right(self._stretches, server_s, key=lambda stretch: stretch.server_s) - 1
        stretch = self._stretches[max(place, 0)]
        return stretch.uav_s + (server_s - stretch.server_s) * stretch.rate

    def server_s(self, uav_s: float) -> float:
        place = bisect_right(self._stretches, uav_s, key=lambda stretch: stretch.uav_s) - 1
        stretch = self._stretches[max(place, 0)]
        return stretch.server_s + (uav_s - stretch.uav_s) / stretch.rate


def plausible_rate(rate: float | None) -> float:
    return rate if rate is not None and math.isfinite(rate) and SLOWEST <= rate <= FASTEST else 1.0
