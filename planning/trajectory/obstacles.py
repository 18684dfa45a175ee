"""Towers, wires, bridges beside and under a route: where a leg passes one too low, the UAV rises over it and comes down behind it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from inspection.geodesy import distance_m
from inspection.network.spans import Spans
from inspection.terrain.profile import heights_over
from planning.rules import FlightRules
from planning.trajectory.beside_spans import legs_beside, points_beside, stretches_too_low
from planning.trajectory.heights import GroundModel
from planning.trajectory.sloped_rises import ProfilePoint, with_slopes
from planning.trajectory.waypoints import END, NONE, PASS, FloatArray, IntArray, RoutePoints, Waypoints

HAIR = 1e-9  # of a leg
HIGHER_M = 0.05  # above the limit, by rounding and between the places at which ground is looked at
ABOVE_ALL_M = 1e5  # the top of what stands on ground that is not known


@dataclass(frozen=True, eq=False)
class TooLow:
    """Stretches of legs that are to be flown higher, in their order, (k,): from and to as shares of the leg, and the level to have.

    place is that of the leg's start; or, where it is no leg, of a waypoint that is itself to stand higher. Levels count as the waypoints'
    own: above the sea where that is known, else above flat ground. agl_m is the level above the lowest ground there; span what stands
    there, by its number. Both heights are inf where nobody knows how high that stands, as the ground under it is not known.
    """

    place: IntArray
    is_leg: NDArray[np.bool_]
    begin: FloatArray
    until: FloatArray
    level_m: FloatArray
    agl_m: FloatArray
    span: IntArray

    def __len__(self) -> int:
        return len(self.place)

    def where(self, chosen: NDArray[np.bool_]) -> "TooLow":
        return TooLow(*(values[chosen] for values in vars(self).values()))


def too_low(waypoints: Waypoints, spans: Spans, ground: GroundModel | None, rules: FlightRules) -> TooLow | None:
    """Where waypoints and legs come within BESIDE_M, across the ground, of something and not by the clearance over it; None for nowhere.

    ground is asked only where the waypoints have heights above the sea. What is inspected, and the wires at it, do not count
    while it is inspected.
    """
    if not len(spans) or len(waypoints) < 2:
        return None
    points = waypoints.points
    known = None if waypoints.amsl_m is None else ground
    level_m = points.agl_m if waypoints.amsl_m is None or known is None else waypoints.amsl_m
    own, asset = _inspected(points)
    on_flat_m = rules.clearance_m if known is None else np.inf
    leg, leg_span = legs_beside(points.position, level_m, own, asset, on_flat_m, spans)
    point, point_span = points_beside(points.position, level_m, own, asset, on_flat_m, spans)
    if not len(leg) and not len(point):
        return None
    span = np.concatenate([leg_span, point_span])
    place = np.concatenate([leg, point])
    tops_m = np.column_stack([spans.start_height_m[span], spans.end_height_m[span]])
    if known is not None:
        tops_m = np.nan_to_num(spans.tops_m(span, known.heights_m), nan=ABOVE_ALL_M)
    least_m = np.ascontiguousarray(tops_m + rules.clearance_m)
    is_leg = np.arange(len(place)) < len(leg)
    row, begin, until, needed_m = stretches_too_low(points.position, level_m, place, is_leg, span, least_m, spans)
    if not len(row):
        return None
    agl_m = needed_m.copy()
    if known is not None:
        profile = known.profile(_on_leg(points, place[row], begin), _on_leg(points, place[row], until))
        _least_m, highest_m = heights_over(profile, needed_m, needed_m)
        agl_m = np.where(np.isnan(highest_m), needed_m - (level_m - points.agl_m)[place[row]], highest_m)
    is_unknown = needed_m >= ABOVE_ALL_M
    needed_m[is_unknown] = agl_m[is_unknown] = np.inf
    order = np.lexsort((begin, ~is_leg[row], place[row]))
    return TooLow(place[row][order], is_leg[row][order], begin[order], until[order], needed_m[order], agl_m[order], span[row][order])


def rising_over(waypoints: Waypoints, spans: Spans, ground: GroundModel | None, rules: FlightRules) -> tuple[Waypoints, tuple[int, ...]]:
    """The waypoints, with a climb before, a level stretch over and a descent behind whatever they would pass too low.

    Also the numbers of the spans over which a UAV would have to rise above the limit, or nobody knows how high: such a route is not to
    be flown.
    """
    low = too_low(waypoints, spans, ground, rules)
    if low is None:
        return waypoints, ()
    blocked = tuple(np.unique(low.span[low.agl_m > rules.max_agl_m + HAIR]).tolist())
    known = low.where(np.isfinite(low.level_m))
    risen = _risen(waypoints, known, ground, rules.max_agl_m)
    if ground is not None and not blocked and highest_agl_m(risen, ground) > rules.max_agl_m + HIGHER_M:
        risen = _risen(waypoints, known, ground, rules.max_agl_m, with_slopes_beside=False)  # the ground falls more steeply than a slope
    return risen, blocked


def highest_agl_m(waypoints: Waypoints, ground: GroundModel) -> float:
    """The greatest height over the ground anywhere on the legs; that of the waypoints where the ground is not known."""
    position, level_m = waypoints.points.position, waypoints.amsl_m
    highest_m = float(waypoints.points.agl_m.max())
    if level_m is None or len(waypoints) < 2:
        return highest_m
    _least_m, most_m = heights_over(ground.profile(position[:-1], position[1:]), level_m[:-1], level_m[1:])
    return max(highest_m, float(np.nan_to_num(most_m, nan=-np.inf).max()))


def _inspected(points: RoutePoints) -> tuple[IntArray, IntArray]:
    """The target that is being done at each point, and its asset, NONE for none; the end over the last target still belongs to it."""
    own = points.target.copy()
    if points.kind[-1] == END and (points.position[-1] == points.position[-2]).all() and points.agl_m[-1] == points.agl_m[-2]:
        own[-1] = own[-2]
    of_target = np.full(int(own.max()) + 2, NONE, dtype=np.int64)  # the last for NONE
    is_own = points.target != NONE
    np.maximum.at(of_target, points.target[is_own], points.asset[is_own])
    return own, of_target[own]


def _on_leg(points: RoutePoints, place: IntArray, share: FloatArray) -> FloatArray:
    end = np.minimum(place + 1, len(points) - 1)
    at: FloatArray = points.position[place] + share[:, None] * (points.position[end] - points.position[place])
    return at


def _risen(
    waypoints: Waypoints, low: TooLow, ground: GroundModel | None, max_agl_m: float, *, with_slopes_beside: bool = True
) -> Waypoints:
    points = waypoints.points
    is_known = waypoints.amsl_m is not None
    plain_m = points.agl_m if waypoints.amsl_m is None else waypoints.amsl_m
    level_m = plain_m.copy()  # of the waypoints themselves: what reaches one of them lifts it
    np.maximum.at(level_m, low.place[~low.is_leg | (low.begin <= HAIR)], low.level_m[~low.is_leg | (low.begin <= HAIR)])
    to_end = low.is_leg & (low.until >= 1.0 - HAIR)
    np.maximum.at(level_m, low.place[to_end] + 1, low.level_m[to_end])
    lifted = np.flatnonzero(level_m > plain_m)
    changed = np.unique(np.concatenate([low.place[low.is_leg], lifted, lifted - 1]))
    legs: list[int] = []
    shares: list[float] = []
    levels_m: list[float] = []
    for leg in changed[(changed >= 0) & (changed < len(points) - 1)].tolist():
        if (points.position[leg] == points.position[leg + 1]).all():
            continue  # straight up or down all the same
        rows = np.flatnonzero(low.is_leg & (low.place == leg))
        ends_m = float(level_m[leg]), float(level_m[leg + 1])
        for share, own_m in _profile(plain_m[leg], plain_m[leg + 1], ends_m, low.begin[rows], low.until[rows], low.level_m[rows]):
            legs.append(leg)
            shares.append(share)
            levels_m.append(own_m)
    if with_slopes_beside:
        legs, shares, levels_m = _with_slopes(points, level_m, plain_m - points.agl_m + max_agl_m, legs, shares, levels_m)
    place = np.array(legs, dtype=np.int64)
    flown = points.with_points_between(place, np.array(shares, dtype=np.float64))
    new = place + 1 + np.arange(len(place))
    is_end = np.array(shares) >= 1.0 - HAIR
    flown.position[new[is_end]] = points.position[place[is_end] + 1]  # not a hair beside it
    is_new = np.zeros(len(flown), dtype=bool)
    is_new[new] = True
    flown_m, ground_m = np.empty(len(flown)), np.zeros(len(flown))
    flown_m[new], flown_m[~is_new] = levels_m, level_m
    if is_known:
        ground_m[~is_new] = (waypoints.amsl_m - points.agl_m) if waypoints.amsl_m is not None else 0.0
        reported_m = np.full(len(new), np.nan) if ground is None else ground.heights_m(flown.position[new])
        ground_m[new] = np.where(np.isnan(reported_m), ground_m[~is_new][place], reported_m)
    agl_m = flown_m - ground_m
    risen = flown.at_heights(agl_m)
    if waypoints.amsl_m is None:
        return Waypoints(risen, None, agl_m)
    return Waypoints(risen, flown_m, flown_m - (waypoints.amsl_m[0] - waypoints.relative_m[0]))


def _with_slopes(
    points: RoutePoints, level_m: FloatArray, most_m: FloatArray, legs: list[int], shares: list[float], levels_m: list[float]
) -> tuple[list[int], list[float], list[float]]:
    """Legs, shares and levels of the points to be put in, with small steps as slopes, and level_m of the route's own changed to fit.

    What is done at a place is done at its level; only points that are passed are lifted, and none above most_m.
    """
    length_m = distance_m(points.position[:-1], points.position[1:])
    along_m = np.concatenate([[0.0], np.cumsum(length_m)])
    is_fixed = (points.kind != PASS) | (points.target != NONE)
    is_fixed[list(points.task)] = True
    own = [
        ProfilePoint(float(along_m[place]), float(level_m[place]), place, 0.0, True, bool(is_fixed[place]), float(most_m[place]))
        for place in range(len(points))
    ]
    put_in = [
        ProfilePoint(float(along_m[leg + 1] if share >= 1.0 - HAIR else along_m[leg] + share * length_m[leg]), level, leg, share, False)
        for leg, share, level in zip(legs, shares, levels_m, strict=True)
    ]
    profile = with_slopes(sorted([*own, *put_in], key=lambda point: (point.leg, not point.is_own)))
    for place, point in enumerate(point for point in profile if point.is_own):
        level_m[place] = point.level_m
    new = [point for point in profile if not point.is_own]
    return [point.leg for point in new], [point.share for point in new], [point.level_m for point in new]


def _profile(
    start_m: float, end_m: float, lifted_m: tuple[float, float], begin: FloatArray, until: FloatArray, level_m: FloatArray
) -> list[tuple[float, float]]:
    """Where a leg between two levels has to bend so that it is nowhere lower than each level from its begin until its end: share, level.

    It goes straight up or down where the stretches begin and end, and at its own ends where these are lifted higher than it is there.
    """
    marks = np.unique(np.concatenate([[0.0, 1.0], begin, until]))
    bends: list[tuple[float, float]] = []
    for share in marks.tolist():
        plain_m = start_m + share * (end_m - start_m)
        touches = (begin <= share) & (until >= share)
        is_point = begin == until
        before_m = float(level_m[touches & ((begin < share) | is_point)].max(initial=plain_m))
        after_m = float(level_m[touches & ((until > share) | is_point)].max(initial=plain_m))
        if share == 0.0:
            bends += [(share, after_m)] if after_m < lifted_m[0] else []
        elif share == 1.0:
            bends += [(share, before_m)] if before_m < lifted_m[1] else []
        elif before_m != after_m:
            bends += [(share, before_m), (share, after_m)]
        elif before_m > plain_m and not (touches & (begin < share) & (until > share) & (level_m == before_m)).any():
            bends.append((share, before_m))
    return bends
