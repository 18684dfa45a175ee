"""Returns of several UAVs, straight or along their routes: conflicts between them, and heights and delays that avoid these.

Heights are AMSL; NaN if unknown. Heights that cannot be compared count as equal.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from inspection.geodesy import LonLat, distance_m
from planning.rules import SeparationRules
from planning.separation.separation import TimedRoute, conflicts

CLIMB_MPS, DESCENT_MPS = 2.5, 1.0  # ArduCopter's WPNAV_SPEED_UP; between WPNAV_SPEED_DN and the slow end of a landing
WAITS_S = (*(10.0 * step for step in range(12)), *(120.0 + 30.0 * step for step in range(27)))  # delays tried, up to 15 minutes


@dataclass(frozen=True)
class StraightReturn:
    """A UAV at `position` that climbs vertically to `level_m`, flies straight to `goal` and lands there at `ground_m`."""

    uav: str
    position: LonLat
    height_m: float
    goal: LonLat
    level_m: float
    ground_m: float
    speed_mps: float

    def duration_s(self) -> float:
        """Return the seconds to the landing. Without heights, only those of the horizontal flight."""
        length_m = float(distance_m(np.array([self.position]), np.array([self.goal]))[0])
        return self.climb_s + length_m / self.speed_mps + self.descent_s

    @property
    def climb_s(self) -> float:
        return _seconds(self.level_m - self.height_m, CLIMB_MPS)

    @property
    def descent_s(self) -> float:
        return _seconds(self.level_m - self.ground_m, DESCENT_MPS)

    def after(self, wait_s: float) -> TimedRoute:
        """Return the timed route in seconds from now, beginning with a hold of `wait_s`."""
        climbed_s = wait_s + self.climb_s
        lands_s = wait_s + self.duration_s()
        return TimedRoute(
            self.uav,
            position=np.array([self.position, self.position, self.goal], dtype=np.float64),
            height_m=np.array([self.height_m, self.level_m, self.level_m]),
            arrival_s=np.array([0.0, climbed_s, lands_s - self.descent_s]),
            hold_s=np.array([wait_s, 0.0, 0.0]),
            take_off_m=self.height_m,
            lands_s=lands_s,
            landing_m=self.ground_m,
        )


def staying(uav: str, position: LonLat, height_m: float) -> TimedRoute:
    """Return the timed route of a UAV that hovers at its position, in seconds from now."""
    return TimedRoute(
        uav, np.array([position], dtype=np.float64), np.array([height_m]), np.zeros(1), np.zeros(1), take_off_m=height_m, lands_s=None
    )


def flying_on(uav: str, points: Sequence[tuple[LonLat, float, float]], speed_mps: float, *, lands: bool) -> TimedRoute:
    """Return the timed route of a UAV through points, each with a height and hold seconds, beginning now."""
    position = np.array([place for place, _height_m, _hold_s in points], dtype=np.float64)
    hold_s = np.array([stay_s for _place, _height_m, stay_s in points])
    legs_s = np.concatenate([[0.0], distance_m(position[:-1], position[1:]) / speed_mps])
    arrival_s = np.cumsum(legs_s) + np.cumsum(hold_s) - hold_s
    height_m = np.array([at_m for _place, at_m, _hold_s in points])
    ends_s = float(arrival_s[-1] + hold_s[-1])
    return TimedRoute(
        uav, position, height_m, arrival_s, hold_s, take_off_m=float(height_m[0]), lands_s=ends_s if lands else None,
        landing_m=float(height_m[-1]),
    )  # fmt: skip


def chosen_apart(
    choices: Sequence[Sequence[TimedRoute]], fixed: Sequence[TimedRoute], rules: SeparationRules, first: Sequence[TimedRoute]
) -> list[int | None]:
    """Return for each UAV its first choice without a conflict; None if there is none, in which case it flies as in `first`.

    UAVs choose one after another, in their order. If one has no choice left, the order is tried by ascending and descending duration of the
    first choice. fixed: routes of all other UAVs in the air.
    """
    in_order = list(range(len(choices)))
    by_duration = sorted(in_order, key=lambda number: (first[number].end_s, number))
    found = []
    for order in (in_order, by_duration, by_duration[::-1]):
        chosen = _chosen(choices, fixed, rules, first, order)
        if None not in chosen:
            return chosen
        found.append(chosen)
    return min(found, key=lambda chosen: chosen.count(None))


def _chosen(
    choices: Sequence[Sequence[TimedRoute]], fixed: Sequence[TimedRoute], rules: SeparationRules, first: Sequence[TimedRoute],
    order: Sequence[int],
) -> list[int | None]:  # fmt: skip
    placed: list[TimedRoute] = []
    chosen: list[int | None] = [None] * len(choices)
    for number in order:
        free = (place for place, one in enumerate(choices[number]) if not _meets(one, [*placed, *fixed], rules))
        place = chosen[number] = next(free, None)
        placed.append(first[number] if place is None else choices[number][place])
    return chosen


def _meets(route: TimedRoute, others: Sequence[TimedRoute], rules: SeparationRules) -> bool:
    return any(conflicts([route], [other], rules=rules) for other in others)


def _seconds(metres: float, mps: float) -> float:
    return 0.0 if math.isnan(metres) else max(metres, 0.0) / mps
