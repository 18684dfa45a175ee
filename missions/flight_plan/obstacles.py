"""Tall things beside a route that leads to none of them: legs rise over what stands under them."""

from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from inspection.geodesy.local_frame import LocalFrame
from inspection.graph.flyable import node_heights_m
from inspection.graph.network import Network
from missions.flight_plan.rules import FlightRules
from missions.flight_plan.waypoints import FloatArray, RoutePoints

BESIDE_M = 25.0  # arms of a tower, and what a UAV strays
SLACK_M = 0.5
NEAR_DEG = 0.005


@dataclass(frozen=True, eq=False)
class TallThings:
    """position (k, 2), lon lat [deg]; least_agl_m (k,): how high each is to be flown over, all above transit height."""

    position: FloatArray
    least_agl_m: FloatArray


_made: WeakKeyDictionary[Network, tuple[FlightRules, TallThings]] = WeakKeyDictionary()


def tall_things(network: Network, rules: FlightRules) -> TallThings:
    """Nodes that stick out above what is cleared at transit height and can be flown over at all; made once per network."""
    made = _made.get(network)
    if made is None or made[0] != rules:
        least_m = node_heights_m(network, slice(None)) + rules.clearance_m
        tall = (least_m > rules.transit_agl_m) & (least_m <= rules.max_agl_m)
        made = _made[network] = rules, TallThings(network.position[tall], least_m[tall])
    return made[1]


def legs_too_low(points: RoutePoints, things: TallThings) -> list[tuple[int, float, float]]:
    """Legs that pass beside a tall thing too low, in their order: leg, where on it as a share, and the height above ground to have."""
    if not len(things.position) or len(points) < 2:
        return []
    low, high = points.position.min(axis=0) - NEAR_DEG, points.position.max(axis=0) + NEAR_DEG
    near = np.flatnonzero(((things.position >= low) & (things.position <= high)).all(axis=1))
    if not len(near):
        return []
    frame = LocalFrame.around(*points.position.mean(axis=0).tolist())
    line, things_m = frame.to_metres(points.position), frame.to_metres(things.position[near])
    start, along = line[:-1], np.diff(line, axis=0)
    squared = (along**2).sum(axis=1)
    found = []
    for thing, least_m in zip(things_m, things.least_agl_m[near].tolist(), strict=True):
        share = np.clip(((thing - start) * along).sum(axis=1) / np.where(squared > 0, squared, 1.0), 0.0, 1.0)
        gap_m = np.hypot(*(start + share[:, None] * along - thing).T)
        flown_m = points.agl_m[:-1] + share * np.diff(points.agl_m)
        too_low: NDArray[np.bool_] = (gap_m <= BESIDE_M) & (flown_m < least_m - SLACK_M) & (share > 0.0) & (share < 1.0)
        found += [(leg, float(share[leg]), least_m) for leg in np.flatnonzero(too_low).tolist()]
    return sorted(found)


def rising_over(points: RoutePoints, things: TallThings) -> RoutePoints:
    """The points, and one more over each tall thing beside a leg, high enough; between two of one target it belongs to the target."""
    low = legs_too_low(points, things)
    if not low:
        return points
    legs, shares = np.array([leg for leg, _, _ in low], dtype=np.int64), np.array([share for _, share, _ in low])
    risen = points.with_points_between(legs, shares)
    agl_m = risen.agl_m.copy()
    agl_m[legs + 1 + np.arange(len(legs))] = [least_m for _, _, least_m in low]
    return RoutePoints(risen.position, agl_m, risen.kind, risen.asset, risen.target, risen.task, risen.speed_mps)
