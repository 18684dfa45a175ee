"""Launch sites: places where crews could launch, and the choice of sites so that every target lies within reach of one.

It is a set cover, solved by HiGHS: the fewest sites, each then moved to the candidate nearest to its targets. Given sites are used before
others are proposed.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import csr_array

from inspection.geodesy import LonLat
from inspection.geodesy.wgs84 import WGS84, distance_m
from inspection.network.spans import spans_of
from planning.airspace import Airspace, zone_at
from planning.problem import BoolArray, FloatArray
from planning.trajectory.beside_spans import points_beside
from planning.trajectory.waypoints import NONE

POINT_M = 1.0  # counted for a target that is a point
ASIDE_M = 40.0  # of a proposed site from the tower beside which it lies: farther than arms of towers and wires in the wind reach
MAX_COVER_S = 10.0
NEAREST = 50  # candidates that are looked at to name the nearest one to a target out of reach


@dataclass(frozen=True)
class SiteChoice:
    """sites: chosen candidates by number, given ones first. site_of: of each target its place in `sites`; None: no candidate reaches it.

    nearest_m: from each target's farthest point to the candidate that comes nearest to it; inf without candidates.
    """

    sites: tuple[int, ...]
    site_of: tuple[int | None, ...]
    nearest_m: tuple[float, ...]


def places_beside(courses: Sequence[Sequence[LonLat]], airspace: Airspace) -> list[LonLat]:
    """Return places to propose: on both sides of the ends of the targets, clear of towers, wires and tracks and outside zones."""
    aside = np.array([place for course in courses for place in _aside(course)])
    if not len(aside):
        return []
    columns = np.repeat(aside, 2, axis=0)  # up from the ground and down to it
    nothing = np.full(len(columns), NONE, dtype=np.int64)
    beside, _ = points_beside(columns, np.zeros(len(columns)), nothing, nothing, np.inf, spans_of(airspace.network))
    is_clear = np.ones(len(aside), dtype=bool)
    is_clear[beside // 2] = False
    places = dict.fromkeys(LonLat(*map(float, place)) for place in np.round(aside[is_clear], 7))
    return [place for place in places if zone_at(place, airspace) is None]


def _aside(course: Sequence[LonLat]) -> Iterator[tuple[float, float]]:
    """Yield places ASIDE_M from each end of a course, across its direction; of a point to the east, the west, the north and the south."""
    ends = [(course[0], course[1]), (course[-1], course[-2])] if len(course) > 1 else [(course[0], course[0])]
    for end, other in ends:
        azimuth_deg = WGS84.inv(*end, *other)[0] if end != other else 0.0
        sides = (90.0, 270.0) if end != other else (0.0, 90.0, 180.0, 270.0)
        for side_deg in sides:
            lon, lat, _ = WGS84.fwd(*end, azimuth_deg + side_deg, ASIDE_M)
            yield lon, lat


def choose_sites(
    targets: Sequence[Sequence[LonLat]],
    candidates: Sequence[LonLat],
    reach_m: float,
    given: int = 0,
    required: Sequence[int] = (),
    stop: Callable[[], bool] = bool,
) -> SiteChoice:
    """Return launch sites among the candidates, of which the first `given` are used where they suffice, and the required ones first.

    A target, lon/lat of its points in order, is within reach of a site if all of its points are within reach_m [m]. Once `stop` is true,
    the remaining targets have no site.
    """
    if not (targets and candidates):
        return SiteChoice((), (None,) * len(targets), (np.inf,) * len(targets))
    farthest_m, mean_m = _distances_m(targets, candidates, reach_m, stop)
    length_m = np.array([_length_m(target) for target in targets])
    reaches = farthest_m <= reach_m
    chosen = list(required)
    unreached = np.flatnonzero(~np.asarray(reaches[:, chosen]).any(axis=1))
    chosen += _covering(reaches[unreached, :given], length_m[unreached])
    uncovered = np.flatnonzero(~np.asarray(reaches[:, chosen]).any(axis=1))
    proposed = _covering(reaches[uncovered], length_m[uncovered])
    chosen += _moved_closer(proposed, reaches[uncovered], mean_m[uncovered], length_m[uncovered])
    site_of = [_closest(chosen, reaches[target], mean_m[target]) for target in range(len(targets))]
    used = [place for place in range(len(chosen)) if place in site_of]  # a proposed site can take all that a given one had
    return SiteChoice(
        tuple(chosen[place] for place in used),
        tuple(None if place is None else used.index(place) for place in site_of),
        tuple(map(float, farthest_m.min(axis=1))),
    )


def _distances_m(
    targets: Sequence[Sequence[LonLat]], candidates: Sequence[LonLat], reach_m: float, stop: Callable[[], bool]
) -> tuple[FloatArray, FloatArray]:
    """Return the greatest and the mean distance from each candidate to the points of each target [m], (targets, candidates).

    inf for candidates that do not reach the first point of the target, except for the nearest ones of a target that none reaches.
    """
    at = np.asarray(candidates, dtype=np.float64)
    farthest_m, mean_m = np.full((len(targets), len(at)), np.inf), np.full((len(targets), len(at)), np.inf)
    for row, target in enumerate(targets):
        if stop():
            break
        points = np.asarray(target, dtype=np.float64)
        first_m = distance_m(np.broadcast_to(points[0], at.shape), at)
        near = np.flatnonzero(first_m <= reach_m)
        near = near if len(near) else np.argsort(first_m)[:NEAREST]
        between_m = distance_m(np.repeat(points, len(near), axis=0), np.tile(at[near], (len(points), 1))).reshape(len(points), len(near))
        farthest_m[row, near], mean_m[row, near] = between_m.max(axis=0), between_m.mean(axis=0)
    return farthest_m, mean_m


def _length_m(target: Sequence[LonLat]) -> float:
    points = np.asarray(target, dtype=np.float64)
    return max(POINT_M, float(distance_m(points[:-1], points[1:]).sum())) if len(points) > 1 else POINT_M


def _covering(reaches: BoolArray, length_m: FloatArray) -> list[int]:
    """Return the fewest candidates, as far as they are found in time, that cover all targets which any candidate covers."""
    coverable = np.any(reaches, axis=1)
    if not coverable.any():
        return []
    found = milp(
        np.ones(reaches.shape[1]),
        integrality=np.ones(reaches.shape[1], dtype=np.int64),
        bounds=Bounds(0.0, 1.0),
        constraints=LinearConstraint(csr_array(reaches[coverable].astype(np.float64)), lb=1.0),
        options={"time_limit": MAX_COVER_S},
    )
    return _greedily(reaches, length_m) if found.x is None else np.flatnonzero(found.x > 0.5).tolist()


def _greedily(reaches: BoolArray, length_m: FloatArray) -> list[int]:
    """Return candidates that cover all targets which any of them covers, each the one that adds most metres."""
    chosen: list[int] = []
    uncovered: BoolArray = np.any(reaches, axis=1)
    while uncovered.any():
        chosen.append(int(np.argmax((reaches & uncovered[:, None]).T @ length_m)))
        uncovered &= ~reaches[:, chosen[-1]]
    return chosen


def _moved_closer(sites: list[int], reaches: BoolArray, mean_m: FloatArray, length_m: FloatArray) -> list[int]:
    """Return the sites, each moved to the candidate that is nearest to the targets flown from it among those that reach them all."""
    site_of = [_closest(sites, reaches[target], mean_m[target]) for target in range(len(reaches))]
    moved = []
    for place, site in enumerate(sites):
        own = np.array([place == of_target for of_target in site_of], dtype=bool)
        cost_m = (
            np.where(reaches[own].all(axis=0), np.where(reaches[own], mean_m[own], 0.0).T @ length_m[own], np.inf)
            if own.any()
            else np.array([np.inf])
        )
        moved.append(int(np.argmin(cost_m)) if np.isfinite(cost_m).any() else site)
    return moved


def _closest(sites: Sequence[int], reaches: BoolArray, mean_m: FloatArray) -> int | None:
    """Return the place in `sites` of the one within reach that is nearest to the target on average."""
    within = [place for place, site in enumerate(sites) if reaches[site]]
    return min(within, key=lambda place: (float(mean_m[sites[place]]), place), default=None)
