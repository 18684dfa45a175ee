"""Choice of launch sites, so that every target lies within reach of one, and of the site from which each target is flown.

It is a set cover: sites are added greedily by the metres that they cover, redundant ones are removed, and each is then moved to the
candidate nearest to its targets. Given sites are used before others are proposed.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from inspection.geodesy import LonLat
from inspection.geodesy.wgs84 import distance_m
from planning.problem import BoolArray, FloatArray

POINT_M = 1.0  # counted for a target that is a point


@dataclass(frozen=True)
class SiteChoice:
    """sites: chosen candidates by number, given ones first. site_of: of each target its place in `sites`; None: no candidate reaches it.

    nearest_m: from each target's farthest point to the candidate that comes nearest to it; inf without candidates.
    """

    sites: tuple[int, ...]
    site_of: tuple[int | None, ...]
    nearest_m: tuple[float, ...]


def choose_sites(targets: Sequence[Sequence[LonLat]], candidates: Sequence[LonLat], reach_m: float, given: int = 0) -> SiteChoice:
    """Return launch sites among the candidates, of which the first `given` are used where they suffice.

    A target, lon/lat of its points in order, is within reach of a site if all of its points are within reach_m [m].
    """
    if not (targets and candidates):
        return SiteChoice((), (None,) * len(targets), (np.inf,) * len(targets))
    farthest_m, mean_m = _distances_m(targets, candidates)
    length_m = np.array([_length_m(target) for target in targets])
    reaches = farthest_m <= reach_m
    chosen = _covering(reaches[:, :given], mean_m[:, :given], length_m)
    uncovered = np.flatnonzero(~np.asarray(reaches[:, chosen]).any(axis=1))
    proposed = _covering(reaches[uncovered], mean_m[uncovered], length_m[uncovered])
    chosen += _moved_closer(proposed, reaches[uncovered], mean_m[uncovered], length_m[uncovered])
    site_of = [_closest(chosen, reaches[target], mean_m[target]) for target in range(len(targets))]
    used = [place for place in range(len(chosen)) if place in site_of]  # a proposed site can take all that a given one had
    return SiteChoice(
        tuple(chosen[place] for place in used),
        tuple(None if place is None else used.index(place) for place in site_of),
        tuple(map(float, farthest_m.min(axis=1))),
    )


def _distances_m(targets: Sequence[Sequence[LonLat]], candidates: Sequence[LonLat]) -> tuple[FloatArray, FloatArray]:
    """Return the greatest and the mean distance from each candidate to the points of each target [m], (targets, candidates)."""
    at = np.asarray(candidates, dtype=np.float64)
    farthest_m, mean_m = np.empty((len(targets), len(at))), np.empty((len(targets), len(at)))
    for row, target in enumerate(targets):
        points = np.asarray(target, dtype=np.float64)
        between_m = distance_m(np.repeat(points, len(at), axis=0), np.tile(at, (len(points), 1))).reshape(len(points), len(at))
        farthest_m[row], mean_m[row] = between_m.max(axis=0), between_m.mean(axis=0)
    return farthest_m, mean_m


def _length_m(target: Sequence[LonLat]) -> float:
    points = np.asarray(target, dtype=np.float64)
    return max(POINT_M, float(distance_m(points[:-1], points[1:]).sum())) if len(points) > 1 else POINT_M


def _covering(reaches: BoolArray, mean_m: FloatArray, length_m: FloatArray) -> list[int]:
    """Return candidates that cover all targets which any of them covers, none of them redundant."""
    chosen: list[int] = []
    uncovered: BoolArray = np.any(reaches, axis=1)
    while uncovered.any():
        gain_m = (reaches & uncovered[:, None]).T @ length_m
        spread_m = np.where(reaches & uncovered[:, None], mean_m, 0.0).T @ length_m
        chosen.append(int(np.lexsort((spread_m, -np.round(gain_m, 3)))[0]))
        uncovered &= ~reaches[:, chosen[-1]]
    return _without_redundant(chosen, reaches, length_m)


def _without_redundant(chosen: list[int], reaches: BoolArray, length_m: FloatArray) -> list[int]:
    """Return the sites without those whose targets others cover, those that cover least removed first."""
    kept = list(chosen)
    for site in sorted(chosen, key=lambda site: float(length_m @ reaches[:, site])):
        others = [other for other in kept if other != site]
        if (reaches[:, others].any(axis=1) | ~reaches[:, site]).all():
            kept = others
    return kept


def _moved_closer(sites: list[int], reaches: BoolArray, mean_m: FloatArray, length_m: FloatArray) -> list[int]:
    """Return the sites, each moved to the candidate that is nearest to the targets flown from it among those that reach them all."""
    site_of = [_closest(sites, reaches[target], mean_m[target]) for target in range(len(reaches))]
    moved = []
    for place, site in enumerate(sites):
        own = np.array([place == of_target for of_target in site_of], dtype=bool)
        cost_m = np.where(reaches[own].all(axis=0), mean_m[own].T @ length_m[own], np.inf) if own.any() else np.array([np.inf])
        moved.append(int(np.argmin(cost_m)) if np.isfinite(cost_m).any() else site)
    return moved


def _closest(sites: Sequence[int], reaches: BoolArray, mean_m: FloatArray) -> int | None:
    """Return the place in `sites` of the one within reach that is nearest to the target on average."""
    within = [place for place, site in enumerate(sites) if reaches[site]]
    return min(within, key=lambda place: (float(mean_m[sites[place]]), place), default=None)
