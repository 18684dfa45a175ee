"""The fewest photos that show enough of a surface: greedy cover, column generation for a bound, integer programme for the choice."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog
from scipy.sparse import csr_array, hstack, identity, vstack

from planning.views.solids import FloatArray, IntArray

BoolArray = NDArray[np.bool_]

PRICED = 100  # photos that are added to the linear programme at a time
MAX_ROUNDS = 30
RUINS, MAX_RUINED, NOISE, SEED = 800, 6, 0.7, 33
SAME = 1e-7


@dataclass(frozen=True)
class Cover:
    """chosen: rows of photos, in ascending order. bound: no choice of fewer photos shows enough."""

    chosen: IntArray
    bound: int


@dataclass(frozen=True, eq=False)
class _Photos:
    """What each photo shows, (photos, patches), twice."""

    shows: BoolArray
    sparse: csr_array

    @classmethod
    def of(cls, shows: BoolArray) -> "_Photos":
        return cls(shows, csr_array(shows.astype(np.float64)))


def fewest_photos(shows: BoolArray, area_m2: FloatArray, kind: IntArray, share: float) -> Cover:
    """Choose photos, shows (photos, patches), that show this share of the area that all of them show, and of that of each kind (patches,).

    The bound is that of the linear relaxation over all photos, found by column generation. The choice is a greedy cover, improved by ruin
    and recreate over the photos that the relaxation has looked at.
    """
    seen = shows.any(axis=0)
    if not seen.any():
        return Cover(np.zeros(0, dtype=np.int64), 0)
    kinds, number = np.unique(kind[seen], return_inverse=True)
    area = np.zeros((int(seen.sum()), len(kinds)))
    area[np.arange(len(area)), number] = area_m2[seen]
    needed = share * area.sum(axis=0)
    photos = _Photos.of(shows[:, seen])
    chosen = _greedy(photos, area, needed)
    pool, bound = _relaxed(photos, area, needed, chosen)
    if len(chosen) > bound:
        chosen = pool[_improved(_Photos.of(photos.shows[pool]), area, needed, np.searchsorted(pool, chosen), bound)]
    return Cover(np.sort(chosen), bound)


def _greedy(photos: _Photos, area: FloatArray, needed: FloatArray) -> IntArray:
    """Take what adds the most of what is still needed, then drop photos that are not needed any more."""
    missing, left = needed.copy(), area.copy()
    chosen: list[int] = []
    while (missing > SAME).any():
        gain = _gain(photos, left, missing, needed)
        best = int(gain.argmax())
        if gain[best] <= 0.0:
            break
        chosen.append(best)
        missing -= left[photos.shows[best]].sum(axis=0)
        left[photos.shows[best]] = 0.0
    return _without_spare(photos, area, needed, chosen)


def _gain(photos: _Photos, left: FloatArray, missing: FloatArray, needed: FloatArray) -> FloatArray:
    """What each photo adds of what is still needed, as a sum of shares of the kinds."""
    gain: FloatArray = np.minimum(photos.sparse @ left, missing.clip(min=0.0)) @ (1.0 / needed)
    return gain


def _without_spare(photos: _Photos, area: FloatArray, needed: FloatArray, chosen: list[int]) -> IntArray:
    """Drop photos that are not needed, the first ones first."""
    times = photos.shows[chosen].sum(axis=0)
    spare = area[times > 0].sum(axis=0) - needed + SAME
    kept = []
    for photo in chosen:
        own = photos.shows[photo]
        lost = area[own & (times == 1)].sum(axis=0)
        if (lost > spare).any():
            kept.append(photo)
            continue
        spare -= lost
        times -= own
    return np.array(kept, dtype=np.int64)


def _rows(shows: csr_array, area: FloatArray) -> csr_array:
    """A patch is shown only if a photo of it is taken; the shown area of each kind is enough. Columns: photos, patches."""
    photos, patches = shows.shape
    taken = hstack([-shows.T, identity(patches)])
    return csr_array(vstack([taken, hstack([csr_array((area.shape[1], photos)), csr_array(-area.T)])]))


def _relaxed(photos: _Photos, area: FloatArray, needed: FloatArray, start: IntArray) -> tuple[IntArray, int]:
    """Return the photos that the linear relaxation has looked at, and its bound over all photos, rounded up.

    At any time the value of the relaxation over a part of the photos, divided by the greatest price of a photo, is a bound for all
    (A. A. Farley, A note on bounding a class of linear programming problems, Operations Research 38, 1990).
    """
    pool = np.unique(np.concatenate([start, photos.shows.argmax(axis=0)]))
    bound = 0.0
    for _ in range(MAX_ROUNDS):
        first, group = _alike(photos.shows[pool], area)
        own_m2 = np.zeros((len(first), area.shape[1]))
        np.add.at(own_m2, group, area)
        found = linprog(  # type: ignore[call-overload]  # its stubs know no sparse matrices
            np.concatenate([np.ones(len(pool)), np.zeros(len(first))]),
            A_ub=_rows(csr_array(photos.shows[np.ix_(pool, first)].astype(np.float64)), own_m2),
            b_ub=np.concatenate([np.zeros(len(first)), -needed]),
            bounds=np.vstack([np.tile([0.0, np.inf], (len(pool), 1)), np.tile([0.0, 1.0], (len(first), 1))]),
            method="highs-ipm",  # of long bridges in half the time of the simplex method
        )
        if found.x is None:
            break
        of_group = -found.ineqlin.marginals[: len(first)] / own_m2.sum(axis=1)
        price = photos.sparse @ (of_group[group] * area.sum(axis=1))
        highest = float(price.max())
        bound = max(bound, found.fun / max(highest, 1.0))
        if highest <= 1.0 + 1e-4 or math.ceil(bound - 1e-4) >= math.ceil(found.fun - 1e-4):
            break
        pool = np.union1d(pool, np.argsort(-price)[:PRICED])
    return pool, math.ceil(bound - 1e-4)


def _alike(shows: BoolArray, area: FloatArray) -> tuple[IntArray, IntArray]:
    """Patches of one kind that the same photos show count as one: the first of each group, and the group of each patch.

    A price of the group is shared among its patches by area.
    """
    packed = np.ascontiguousarray(np.vstack([np.packbits(shows, axis=0), np.packbits(area > 0.0, axis=1).T]).T)
    _, first, group = np.unique(packed.view(f"V{packed.shape[1]}").ravel(), return_index=True, return_inverse=True)
    return first.astype(np.int64), np.asarray(group, dtype=np.int64).ravel()


def _improved(photos: _Photos, area: FloatArray, needed: FloatArray, start: IntArray, bound: int) -> IntArray:
    """Ruin and recreate: take some photos with much in common away, fill up greedily with noise; no more than at the start."""
    generator = np.random.default_rng(SEED)
    best = current = start
    common = np.asarray((photos.sparse @ photos.sparse.T).todense())
    for _ in range(RUINS):
        if len(best) <= bound:
            break
        centre = int(generator.integers(len(current)))
        alike = common[current[centre], current] * generator.uniform(0.5, 1.0, len(current))
        kept = np.delete(current, np.argsort(-alike)[: int(generator.integers(2, MAX_RUINED + 1))])
        left = np.where(np.asarray(photos.shows[kept].any(axis=0))[:, None], 0.0, area)
        missing = needed - (area.sum(axis=0) - left.sum(axis=0))
        filled = kept.tolist()
        while (missing > SAME).any() and len(filled) < len(current):
            gain = _gain(photos, left, missing, needed) * generator.uniform(NOISE, 1.0, len(photos.shows))
            taken = int(gain.argmax())
            filled.append(taken)
            missing -= left[photos.shows[taken]].sum(axis=0)
            left[photos.shows[taken]] = 0.0
        if (missing > SAME).any():
            continue
        current = _without_spare(photos, area, needed, filled)
        best = current if len(current) < len(best) else best
    return best
