"""Straight ways home from all along a flight, as an autopilot flies them by itself, and what lies in these ways.

Unlike the return of `lost_link`, whose height is chosen for the ground below it, the height is the autopilot's: it is looked at as it is.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from inspection.geodesy import LonLat, distance_m
from planning.clearance.surroundings import SAMPLE_SPACING_M, Surroundings
from planning.clearance.zone_clearance import TAKE_OFF, BoolArray, FlownRoute, breaches
from planning.trajectory.heights import GroundHeights
from planning.trajectory.spans_below import tops_below
from planning.trajectory.waypoints import FloatArray, IntArray

LOOKED_AT_EVERY_M = 50.0  # along the flight
ROUNDING_M = 0.5  # heights are stored in tenths, and kept in centimetres
Level = Callable[[float, float, float], float]  # of the height at a place, the way's length, the return point's height


class InTheWay(StrEnum):
    ZONE = "zone"
    OBSTACLE = "obstacle"
    GROUND = "ground"
    UNKNOWN_GROUND = "unknown_ground"


@dataclass(frozen=True, eq=False)
class Places:
    """Along a flight: position (n, 2) lon, lat [deg], height_m (n,) above its take-off, and to which waypoint it is on its way (n,)."""

    position: FloatArray
    height_m: FloatArray
    waypoint: IntArray

    @classmethod
    def along(cls, position: FloatArray, height_m: FloatArray, waypoint: Sequence[int]) -> "Places":
        """Each waypoint, and points between two of them at most LOOKED_AT_EVERY_M apart; heights in between change evenly."""
        at, high, number = [position[:1]], [height_m[:1]], [np.array(waypoint[:1], dtype=np.int64)]
        for k, length_m in enumerate(distance_m(position[:-1], position[1:]).tolist()):
            share = np.linspace(0.0, 1.0, max(1, math.ceil(length_m / LOOKED_AT_EVERY_M)) + 1)[1:]
            at.append(position[k] + share[:, None] * (position[k + 1] - position[k]))
            high.append(height_m[k] + share * (height_m[k + 1] - height_m[k]))
            number.append(np.full(len(share), waypoint[k + 1], dtype=np.int64))
        return cls(np.concatenate(at), np.concatenate(high), np.concatenate(number))

    def __len__(self) -> int:
        return len(self.height_m)

    def only(self, rows: BoolArray) -> "Places":
        return Places(self.position[rows], self.height_m[rows], self.waypoint[rows])

    def nearest_of(self, return_points: Sequence[LonLat]) -> IntArray:
        """The number of the return point that each place is nearest to, (n,); of two as near the first."""
        metres = [distance_m(self.position, np.broadcast_to(np.array(return_point), self.position.shape)) for return_point in return_points]
        nearest: IntArray = np.stack(metres).argmin(axis=0)
        return nearest


@dataclass(frozen=True)
class ReturnPoint:
    """Where it flies to: where it took off, or a rally point and its height above the take-off."""

    position: LonLat
    height_m: float = 0.0
    is_rally: bool = False


@dataclass(frozen=True)
class RtlObstruction:
    """From the one waypoint to the other (on the way to the first already) something is in the way home.

    `level_m`: how high above the take-off it would fly, at its lowest. `zone` is a row of the zones. `to_end`: up to the flight's end.
    """

    kind: InTheWay
    first: int
    last: int
    to_end: bool
    level_m: float
    is_rally: bool
    zone: int | None = None


class RtlPaths:
    """From places to one return point. What the ground and obstacles ask for is looked up once, for any level.

    `home_amsl_m` and the heights of the ground are None where flat ground is assumed; heights are then above it.
    """

    def __init__(
        self,
        places: Places,
        return_point: ReturnPoint,
        *,
        around: Surroundings,
        home_amsl_m: float | None,
        clearance_m: float,
    ) -> None:
        self.places, self.return_point, self.zones, self.margins = places, return_point, around.zones, around.margins
        self._base_m = 0.0 if home_amsl_m is None else home_amsl_m
        self._knows_sea = home_amsl_m is not None and around.ground_heights_m is not None
        known = around.ground_heights_m if self._knows_sea else None
        goal = np.broadcast_to(np.array(return_point.position, dtype=np.float64), places.position.shape)
        self.away_m = distance_m(places.position, goal)
        self._grounds(known)
        tops_m = tops_below(places.position, goal, around.spans, known, 0.0) - self._base_m
        own_m = places.height_m - self._under_m
        self._over_ground_m = self._highest_m + np.minimum(clearance_m, np.maximum(own_m, 0.0)) - ROUNDING_M
        self._over_tops_m = tops_m + clearance_m - ROUNDING_M
        self._is_unknown = np.isnan(self._highest_m) | (tops_m == np.inf)
        self._beside_zones = [row for row in range(len(places)) if len(around.zones) and self._zones_of(row, math.nan)]

    def _grounds(self, known: GroundHeights | None) -> None:
        """Under each place, under the return point, and the highest and lowest under the way, above the take-off."""
        counts = [max(1, math.ceil(length_m / SAMPLE_SPACING_M)) + 1 for length_m in self.away_m.tolist()]
        goal = np.array(self.return_point.position, dtype=np.float64)
        samples = np.concatenate([
            place + np.linspace(0.0, 1.0, count)[:, None] * (goal - place)
            for place, count in zip(self.places.position, counts, strict=True)
        ])  # fmt: skip
        ground_m = np.zeros(len(samples)) if known is None else known(samples) - self._base_m
        starts = np.cumsum([0, *counts[:-1]])
        self._highest_m, self._lowest_m = np.maximum.reduceat(ground_m, starts), np.minimum.reduceat(ground_m, starts)
        self._under_m, self._under_return_point_m = ground_m[starts], float(ground_m[-1])

    def lowest_safe_m(self) -> float:
        """That clears the ground and obstacles from every place; -inf where nothing asks for any height."""
        return float(np.max(np.maximum(self._over_ground_m, self._over_tops_m), initial=-np.inf))

    def levels_m(self, level: Level) -> FloatArray:
        rows = zip(self.places.height_m.tolist(), self.away_m.tolist(), strict=True)
        return np.array([level(height_m, away_m, self.return_point.height_m) for height_m, away_m in rows])

    def most_agl_m(self, levels_m: FloatArray) -> float:
        """How high above the ground it would come anywhere."""
        return float(np.max(levels_m - self._lowest_m, initial=-np.inf))

    def obstructions(self, levels_m: FloatArray) -> list[RtlObstruction]:
        """By kind and zone, from the first place on at which there is any."""
        found: list[tuple[InTheWay, int | None, BoolArray]] = [
            (InTheWay.UNKNOWN_GROUND, None, self._is_unknown),
            (InTheWay.GROUND, None, ~self._is_unknown & (levels_m < self._over_ground_m)),
            (InTheWay.OBSTACLE, None, ~self._is_unknown & (levels_m < self._over_tops_m)),
            *((InTheWay.ZONE, zone, meets) for zone, meets in self._zones_met(levels_m).items()),
        ]
        return [self._obstruction(kind, zone, meets, levels_m) for kind, zone, meets in found if meets.any()]

    def _obstruction(self, kind: InTheWay, zone: int | None, meets: BoolArray, levels_m: FloatArray) -> RtlObstruction:
        rows = np.flatnonzero(meets)
        first, last = int(self.places.waypoint[rows[0]]), int(self.places.waypoint[rows[-1]])
        to_end = bool(rows[-1] == len(levels_m) - 1)
        return RtlObstruction(kind, first, last, to_end, float(levels_m[rows].min()), self.return_point.is_rally, zone)

    def _zones_met(self, levels_m: FloatArray) -> dict[int, BoolArray]:
        """By zone: from which places."""
        met: dict[int, BoolArray] = {}
        for row in self._beside_zones:
            for zone in self._zones_of(row, levels_m[row]):
                met.setdefault(zone, np.zeros(len(levels_m), dtype=bool))[row] = True
        return met

    def _zones_of(self, row: int, level_m: float) -> set[int]:
        """NaN for a level that may be any."""
        position = np.stack([self.places.position[row]] * 3 + [np.array(self.return_point.position, dtype=np.float64)] * 2)
        own_m = float(self.places.height_m[row])
        # On the way it is between its least and its greatest height above ground, wherever that is.
        grounds_m = [self._under_m[row], self._under_m[row], self._highest_m[row], self._lowest_m[row], self._under_return_point_m]
        relative_m = np.array([own_m, level_m, level_m, level_m, level_m])
        flown = FlownRoute(position, relative_m - grounds_m, relative_m + self._base_m if self._knows_sea else None, lands=True)
        return {breach.zone for breach in breaches(flown, self.zones, self.margins) if breach.leg != TAKE_OFF}
