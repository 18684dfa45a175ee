"""Where on its planned route a UAV is, and from where on its way it can be given another one."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame

FloatArray = NDArray[np.float64]

NEAR_M = 40.0  # from a leg: a UAV on it; of several legs that near it is on the first
HEIGHT_ROUNDING_M = 0.5


@dataclass(frozen=True)
class PassedPoint:
    """A waypoint as far as it matters here: `target` is what is being done, `hold_s` how long the UAV stays, `arrival_s` when it comes."""

    position: LonLat
    agl_m: float
    arrival_s: float
    hold_s: float = 0.0
    target: int | None = None


@dataclass(frozen=True)
class PlaceOnRoute:
    """Between waypoint `ahead` - 1, of which `share` of the way to `ahead` is behind, and waypoint `ahead`; `away_m` beside it."""

    ahead: int
    share: float
    away_m: float
    position: LonLat  # on the leg

    def at_s(self, points: Sequence[PassedPoint]) -> float:
        """When it was planned to be here; of a stay none is left."""
        before, after = points[self.ahead - 1], points[self.ahead]
        leaves_s = min(before.arrival_s + before.hold_s, after.arrival_s)
        return leaves_s + self.share * (after.arrival_s - leaves_s)

    def between(self, before: float, after: float) -> float:
        """Of what changes evenly along the leg."""
        return before + self.share * (after - before)


def place_on_route(points: Sequence[PassedPoint], at: LonLat, *, first: int = 1) -> PlaceOnRoute:
    """The first leg near the position from the one that leads to waypoint `first` on, else the nearest; at least two points are needed.

    A route that comes back along the line on which it went out is told apart by `first`.
    """
    first = min(max(first, 1), len(points) - 1)
    frame = LocalFrame.around(at.lon, at.lat)
    places = frame.to_metres(np.array([point.position for point in points[first - 1 :]], dtype=np.float64))
    tail, along = places[:-1], np.diff(places, axis=0)
    squared = (along**2).sum(axis=1)
    share = np.clip(-(tail * along).sum(axis=1) / np.where(squared > 0, squared, 1.0), 0.0, 1.0)
    on_leg = tail + share[:, None] * along
    away_m = np.hypot(*on_leg.T)
    near = np.flatnonzero(away_m <= NEAR_M)
    leg = int(away_m.argmin())
    if len(near):  # the nearest of those that follow each other without a gap, from the first near one on
        run = near[: int(np.argmax(np.append(np.diff(near) > 1, True))) + 1]
        leg = int(run[away_m[run].argmin()])
    position = LonLat(*frame.to_degrees(on_leg[leg : leg + 1])[0].tolist())
    return PlaceOnRoute(first + leg, float(share[leg]), float(away_m[leg]), position)


def is_open(points: Sequence[PassedPoint], place: int, transit_agl_m: float) -> bool:
    """Whether another route may begin at a waypoint: not within a stretch, and not above the height at which routes begin.

    A route begins by a climb to that height. What is passed higher has something tall below it.
    """
    point = points[place]
    follows = points[place + 1] if place + 1 < len(points) else None
    goes_on = point.target is not None and follows is not None and follows.target == point.target
    return not goes_on and point.agl_m <= transit_agl_m + HEIGHT_ROUNDING_M


def where_to_leave(
    points: Sequence[PassedPoint], here: PlaceOnRoute, *, lead_s: float, transit_agl_m: float, before: int | None = None
) -> int | None:
    """The first open waypoint that the UAV does not reach within lead_s; with `before` one of those before that waypoint.

    None where there is none.
    """
    now_s, end = here.at_s(points), len(points) if before is None else before
    for place in range(here.ahead, end):
        if points[place].arrival_s - now_s >= lead_s and is_open(points, place, transit_agl_m):
            return place
    return None
