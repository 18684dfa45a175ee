"""What a rehearsal is held against: zones, terrain, towers and wires of the ground as it is now."""

import numpy as np

from inspection.graph.spans import Spans, spans_of
from inspection.selectors import NoGraph
from inspection.selectors.planning import PlanningGround, heights_at
from simulation.rehearsing.flying import RouteToFly
from simulation.rehearsing.ground import Heights
from simulation.verdict.flown import FloatArray
from simulation.verdict.judging import Surroundings
from simulation.verdict.obstacles import Standing

BESIDE_DEG = 0.01  # some kilometre beside the waypoints: flights that stray farther have failed by then
NO_PLACES = np.zeros((0, 2))
NOTHING_STANDS = Standing(NO_PLACES, NO_PLACES, np.zeros(0), np.zeros(0))


def surroundings_of(routes: tuple[RouteToFly, ...], ground: PlanningGround, departs_s: float | None) -> Surroundings:
    terrain = heights_at(ground.edition)
    return Surroundings(ground.table, _standing(routes, ground, terrain), _flat if terrain is None else terrain, departs_s)


def take_off_amsl_m(amsl_m: float | None) -> float:
    """Of a plan over assumed flat ground, heights count from 0."""
    return 0.0 if amsl_m is None else amsl_m


def _flat(positions: FloatArray) -> FloatArray:
    return np.zeros(len(positions))


def _standing(routes: tuple[RouteToFly, ...], ground: PlanningGround, terrain: Heights | None) -> Standing:
    """Near the routes, with tops above sea level; without a network nothing is known to stand."""
    try:
        spans = spans_of(ground.network())
    except NoGraph:
        return NOTHING_STANDS
    places = np.array([waypoint.position for route in routes for waypoint in route.route.waypoints])
    near = _near(spans, places)
    start, end = spans.start[near], spans.end[near]
    at_start, at_end = (_flat(start), _flat(end)) if terrain is None else (terrain(start), terrain(end))
    return Standing(start, end, at_start + spans.start_height_m[near], at_end + spans.end_height_m[near])


def _near(spans: Spans, places: FloatArray) -> np.ndarray[tuple[int, ...], np.dtype[np.intp]]:
    (west, south), (east, north) = places.min(axis=0) - BESIDE_DEG, places.max(axis=0) + BESIDE_DEG
    low, high = np.minimum(spans.start, spans.end), np.maximum(spans.start, spans.end)
    return np.flatnonzero((low[:, 0] <= east) & (high[:, 0] >= west) & (low[:, 1] <= north) & (high[:, 1] >= south))
