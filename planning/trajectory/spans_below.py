"""How high towers and wires stand beside straight ways that are flown at one level each: for all ways at once."""

import numpy as np
import shapely

from inspection.geodesy.local_frame import LocalFrame
from inspection.network.spans import Spans
from planning.clearance.obstacle_clearance import lines_between, spans_near
from planning.trajectory.heights import GroundHeights
from planning.trajectory.waypoints import FloatArray

BESIDE_M = 30.0  # across the ground: more than a route has, since nobody watches


def tops_below(start: FloatArray, end: FloatArray, spans: Spans, ground_heights_m: GroundHeights | None, passed_m: float) -> FloatArray:
    """The highest point of any span within BESIDE_M of each way from start to end, (n, 2) lon, lat [deg]; (n,), -inf for none.

    Above the sea; without ground_heights_m above flat ground, and what stands no higher than passed_m is left out. A wire counts as
    straight from top to top: it hangs lower. inf where the ground under one of its ends is not known.
    """
    highest_m = np.full(len(start), -np.inf)
    places = np.concatenate([start, end])
    near = spans_near(spans, places, 0.0 if ground_heights_m is not None else passed_m)
    if not len(near):
        return highest_m
    frame = LocalFrame.around(*places.mean(axis=0).tolist())
    here, there = frame.to_metres(start), frame.to_metres(end)
    feet = np.stack([frame.to_metres(spans.start[near]), frame.to_metres(spans.end[near])])
    tree = shapely.STRtree(lines_between(here, there))
    span, way = tree.query(lines_between(feet[0], feet[1]), predicate="dwithin", distance=BESIDE_M)
    if not len(way):
        return highest_m
    tops_m = np.stack([spans.start_height_m[near], spans.end_height_m[near]])
    if ground_heights_m is not None:
        used = np.unique(span)
        tops_m[:, used] = spans.tops_m(near[used], ground_heights_m).T
    to_start = tops_m[0] > tops_m[1]
    low, high = np.where(to_start[:, None], feet[::-1], feet)
    low_m, high_m = np.where(to_start, tops_m[::-1], tops_m)
    until = _last_share_beside(here[way], there[way], low[span], high[span])
    beside_m = low_m[span] + until * (high_m - low_m)[span]
    np.maximum.at(highest_m, way, np.where(np.isnan(beside_m), np.inf, beside_m))
    return highest_m


def _last_share_beside(here: FloatArray, there: FloatArray, low: FloatArray, high: FloatArray) -> FloatArray:
    """Up to which share of the line from low to high it is beside the way from here to there, (p, 2) [m] each; (p,).

    It is known to come beside it. Beside is what lies in the rectangle BESIDE_M around the way: a little more than within BESIDE_M of it.
    """
    length_m = np.hypot(*(there - here).T)
    along = np.divide(there - here, length_m[:, None], out=np.tile([1.0, 0.0], (len(here), 1)), where=length_m[:, None] > 0.0)
    across = np.column_stack([-along[:, 1], along[:, 0]])
    until = np.ones(len(here))
    for direction, least_m, most_m in ((along, -BESIDE_M, length_m + BESIDE_M), (across, -BESIDE_M, np.full(len(here), BESIDE_M))):
        from_m, by_m = ((low - here) * direction).sum(axis=1), ((high - low) * direction).sum(axis=1)
        room_m = np.where(by_m > 0.0, most_m - from_m, least_m - from_m)
        leaves = np.divide(room_m, by_m, out=np.ones(len(here)), where=by_m != 0.0)
        until = np.minimum(until, leaves)
    share: FloatArray = np.clip(until, 0.0, 1.0)
    return share
