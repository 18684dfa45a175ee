"""Converts a vehicle's time since boot to the server's clock.

Transmission takes an unknown, positive time, so the earliest arrivals determine the offset. A simulated vehicle's clock may run faster or
slower than the server's and change its rate. Messages stored during a lost link arrive late, and faster than they were measured.
"""

from collections import deque
from dataclasses import dataclass, field
from itertools import pairwise
from statistics import median
from typing import NamedTuple

WINDOW_S = 20.0  # of receipt, from which the rate is fitted
MIN_WINDOW_S = 4.0
MIN_POINTS = 8
POINT_INTERVAL_S = 0.2
REFIT_INTERVAL_S = 1.0
ON_TIME_S = 1.0  # delay after the earliest arrivals
STEADY = 0.1  # allowed difference between the rates of both halves of the window
REAL_TIME = 0.05  # a rate this near to 1 counts as 1: clocks are more accurate than this window
SAME_RATE = 0.03
CREEP = 0.2  # share of a small delay that each fit takes for drift
SLOWEST = 0.5  # minimum distance from the previous record, as a share of the vehicle's time between them, unless received sooner
EARLY_SHARE = 0.5  # share of the expected earliness that confirms a faster vehicle clock


class Point(NamedTuple):
    """One message. early_s: the sum of all corrections to the offset for early arrivals until then, this one included."""

    received_s: float
    boot_s: float
    early_s: float


@dataclass
class VehicleClock:
    """offset_s is the server's time at the vehicle's boot, rate the vehicle's seconds per server second."""

    offset_s: float | None = None
    rate: float = 1.0
    _points: deque[Point] = field(default_factory=deque)
    _base: Point | None = None  # an early point of the current rate, as old as possible
    _fitted_at_s: float = 0.0
    _early_s: float = 0.0
    _last: tuple[float, float] | None = None  # since boot, measured

    def measured_s(self, boot_s: float) -> float:
        """Return the server's time of a vehicle time. Only valid after the first `receive`."""
        assert self.offset_s is not None  # noqa: S101 - precondition
        return self.offset_s + boot_s / self.rate

    def lateness_s(self, boot_s: float, now_s: float) -> float:
        """Return how much later than the earliest possible a message arrives; negative before the clock is fitted."""
        return 0.0 if self.offset_s is None else now_s - self.measured_s(boot_s)

    def receive(self, boot_s: float, now_s: float) -> None:
        if self.offset_s is None:
            self.offset_s = now_s - boot_s / self.rate
        lateness_s = self.lateness_s(boot_s, now_s)
        self.offset_s += min(lateness_s, 0.0)
        self._early_s -= min(lateness_s, 0.0)
        if self._points and now_s - self._points[-1].received_s < POINT_INTERVAL_S:
            return
        self._points.append(Point(now_s, boot_s, self._early_s))
        while now_s - self._points[0].received_s > WINDOW_S:
            self._points.popleft()
        if abs(now_s - self._fitted_at_s) >= REFIT_INTERVAL_S:
            self._fitted_at_s = now_s
            self._fit()

    def stamp_s(self, boot_s: float, now_s: float) -> float:
        """Return measured_s, kept in the order of the vehicle's clock while the fit improves, and not after now_s."""
        measured_s = self.measured_s(boot_s)
        if self._last is not None and boot_s <= self._last[0]:
            return min(measured_s, self._last[1])
        if self._last is not None:
            measured_s = max(measured_s, self._last[1] + SLOWEST * (boot_s - self._last[0]) / self.rate)
        self._last = (boot_s, min(measured_s, now_s))
        return self._last[1]

    def _fit(self) -> None:
        points = list(self._points)
        on_time = [point for point in points if self.lateness_s(point.boot_s, point.received_s) < ON_TIME_S]
        if len(on_time) >= MIN_POINTS:
            points = on_time
        rate = _steady_rate(points)
        if rate is None:
            return
        if abs(rate - self.rate) <= SAME_RATE * self.rate:
            self._refine(points)
        elif rate < self.rate or self._has_become_faster(points, rate):
            self.rate, self._base = rate, None
            self.offset_s = _earliest(points, rate)[1]
        # else stored messages arrive faster than they were measured: the rate is unchanged

    def _has_become_faster(self, points: list[Point], rate: float) -> bool:
        took_s = points[-1].received_s - points[0].received_s
        return points[-1].early_s - points[0].early_s > EARLY_SHARE * took_s * (rate / self.rate - 1.0)

    def _refine(self, points: list[Point]) -> None:
        """Improve the rate: the longer it has held, the more precisely it is known."""
        assert self.offset_s is not None  # noqa: S101 - there are points
        point, offset_s = _earliest(points, self.rate)
        if self._base is None:
            self._base = point
        elif self.rate != 1.0 and point.received_s - self._base.received_s > WINDOW_S:
            self.rate = (point.boot_s - self._base.boot_s) / (point.received_s - self._base.received_s)
            self.offset_s = point.received_s - point.boot_s / self.rate
            return
        later_s = offset_s - self.offset_s
        self.offset_s += later_s * (CREEP if later_s < ON_TIME_S else 1.0)


def _earliest(points: list[Point], rate: float) -> tuple[Point, float]:
    """Return the point with the shortest transmission, and the offset that follows from it."""
    point = min(points, key=lambda point: point.received_s - point.boot_s / rate)
    return point, point.received_s - point.boot_s / rate


def _steady_rate(points: list[Point]) -> float | None:
    """Return the rate, 1 if close to 1; None with too few points or a changing rate."""
    if len(points) < MIN_POINTS or points[-1].received_s - points[0].received_s < MIN_WINDOW_S:
        return None
    if any(later.boot_s < earlier.boot_s for earlier, later in pairwise(points)):
        return None
    half = len(points) // 2
    first, second, whole = _rate(points[:half]), _rate(points[half:]), _rate(points)
    if whole <= 0 or abs(first - second) > STEADY * max(first, second):
        return None
    return 1.0 if abs(whole - 1.0) <= REAL_TIME else whole


def _rate(points: list[Point]) -> float:
    """Return the median slope of pairs half the points apart, which single late points do not affect."""
    half = len(points) // 2
    pairs = zip(points, points[half:], strict=False)
    slopes = [
        (later.boot_s - earlier.boot_s) / (later.received_s - earlier.received_s)
        for earlier, later in pairs
        if later.received_s > earlier.received_s
    ]
    return median(slopes) if slopes else 0.0
