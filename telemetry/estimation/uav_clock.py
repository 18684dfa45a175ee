"""A UAV's clock relative to the server's.

A simulated UAV may fly faster than real time. Its speeds, planned times and battery life follow its own clock. The gateway estimates that
clock's rate from received messages; it is 1 for all other UAVs.
"""

import math
from bisect import bisect_right
from dataclasses import dataclass, field

SLOWEST, FASTEST = 0.05, 100.0  # estimates beyond these are no clock's rate
SAME_RATE = 0.02  # relative difference up to which two estimates count as the same rate
RATES_KEPT = 32


@dataclass(frozen=True, slots=True)
class _Stretch:
    """A period with one rate, from `server_s` on, when the UAV's own clock showed `uav_s`."""

    server_s: float
    uav_s: float
    rate: float


@dataclass
class UavClock:
    """Converts between both clocks. They agree until the rate changes and continue from there; earlier times stay unchanged."""

    _stretches: list[_Stretch] = field(default_factory=lambda: [_Stretch(0.0, 0.0, 1.0)])

    @property
    def rate(self) -> float:
        """Return its seconds per server second."""
        return self._stretches[-1].rate

    def run_at(self, rate: float | None, from_s: float) -> None:
        """Set the rate from a moment of the server's clock on. None and implausible rates count as the server's."""
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
