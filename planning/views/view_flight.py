"""The order of photos, and the way from pose to pose outside of the keep-out."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.sparse.csgraph import floyd_warshall

from planning.problem import End, Objective, Problem, UavStart, Visit
from planning.solver.solver import solve
from planning.views.keep_out import KeepOut
from planning.views.solids import FloatArray, IntArray
from planning.views.visibility import Poses

ABOVE_TOP_M = 0.5  # by which a way leads over a column
NO_PHOTO = -1
CLIMB_FACTOR = 2.0  # a metre up or down takes as long as so many metres along
SAME_PLACE_M = 0.05


@dataclass(frozen=True, eq=False)
class ViewFlight:
    """Points that are flown one after another, straight from each to the next.

    position float64 (n, 3) [m]; photo (n,): the pose taken there, NO_PHOTO where the way only bends.
    """

    position: FloatArray
    photo: IntArray

    def __len__(self) -> int:
        return len(self.position)

    @property
    def length_m(self) -> float:
        return float(np.linalg.norm(np.diff(self.position, axis=0), axis=1).sum())


class NoWay(ValueError):
    """A pose that no way outside of the keep-out leads to."""


def view_flight(poses: Poses, keep_out: KeepOut, entry: FloatArray, end: FloatArray | None = None) -> ViewFlight:
    """Return the way from a place through all poses, in the order that is found to be short, and on to an end.

    Raises NoWay where a pose cannot be reached outside of the keep-out.
    """
    ends = [entry] if end is None else [entry, end]
    places = np.concatenate([np.array(ends), poses.position])
    cost, via = _ways(places, keep_out)
    nearest, before = floyd_warshall(cost, return_predecessors=True)
    if not np.isfinite(nearest).all() or keep_out.holds(places).any():
        raise NoWay
    order = _order(nearest, len(ends))
    stops = [0, *order, *range(1, len(ends))]
    points: list[FloatArray] = [places[0]]
    photos = [NO_PHOTO]
    for here, there in pairwise(stops):
        for one, other in _steps(before.astype(np.int64), here, there):
            for bend in (*via.get((one, other), ()), places[other]):
                points.append(bend)
                photos.append(NO_PHOTO)
        if there >= len(ends):
            photos[-1] = there - len(ends)
    flight = ViewFlight(np.array(points), np.array(photos, dtype=np.int64))
    if keep_out.meets(flight.position[:-1], flight.position[1:]).any():
        raise NoWay
    return flight


def _ways(places: FloatArray, keep_out: KeepOut) -> tuple[FloatArray, dict[tuple[int, int], tuple[FloatArray, ...]]]:
    """The cost of going straight, or else over what is between; and the bends of the latter."""
    count = len(places)
    one, other = np.triu_indices(count, 1)
    change = places[other] - places[one]
    along = np.linalg.norm(change[:, :2], axis=1) + CLIMB_FACTOR * np.abs(change[:, 2])
    cost = np.zeros((count, count))
    cost[one, other] = np.where(along < SAME_PLACE_M, 1e-6, along)
    met = np.flatnonzero(keep_out.meets(places[one], places[other]))
    one, other = one[met], other[met]
    levels_m = _levels_over(places[one], places[other], keep_out)
    via: dict[tuple[int, int], tuple[FloatArray, ...]] = {}
    for here, there, level_m in zip(one.tolist(), other.tolist(), levels_m.tolist(), strict=True):
        if level_m == np.inf:
            cost[here, there] = np.inf
            continue
        up, down = np.append(places[here, :2], level_m), np.append(places[there, :2], level_m)
        via[here, there], via[there, here] = (up, down), (down, up)
        climb_m = 2.0 * level_m - float(places[here, 2]) - float(places[there, 2])
        cost[here, there] = float(np.linalg.norm(up - down)) + CLIMB_FACTOR * climb_m
    return cost + cost.T, via


def _levels_over(start: FloatArray, end: FloatArray, keep_out: KeepOut) -> FloatArray:
    """The height [m] at which a way leads over all columns and ground between each two places, (n, 3); inf where that is too high."""
    limits = [keep_out.band.limits_between(*pair) for pair in zip(start[:, :2], end[:, :2], strict=True)]
    least_m, most_m = np.array(limits).reshape(-1, 2).T
    tops_m = keep_out.tops_between(start, end) + ABOVE_TOP_M
    levels_m = np.maximum(np.maximum(tops_m, least_m), np.maximum(start[:, 2], end[:, 2]))
    return np.where(levels_m <= most_m, levels_m, np.inf)


def _order(cost: FloatArray, ends: int) -> list[int]:
    """The poses in the order of the shortest route that is found, as places in the cost matrix."""
    poses = np.arange(ends, len(cost))
    if not len(poses):
        return []
    between = cost[np.ix_(poses, poses)]
    home = cost[poses, ends - 1][:, None]
    problem = Problem(
        uavs=(UavStart(end=End.OPEN if ends == 1 else End.RETURN),),
        visits=tuple(Visit(number) for number in range(len(poses))),
        target_count=len(poses),
        from_start_m=cost[0, poses][None, :],
        between_m=between,
        to_start_m=home,
        objective=Objective.TOTAL,
    )
    (route,) = solve(problem).routes
    return [ends + visit for visit in route]


def _steps(before: IntArray, here: int, there: int) -> list[tuple[int, int]]:
    """The direct ways of which the cheapest way between two places is made."""
    steps: list[tuple[int, int]] = []
    while there != here:
        previous = int(before[here, there])
        steps.append((previous, there))
        there = previous
    return steps[::-1]
