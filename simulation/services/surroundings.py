"""Surroundings for assessments: present zones, terrain, towers and wires."""

import numpy as np

from inspection.network.spans import Spans, spans_of
from inspection.selectors import NoGraph
from inspection.selectors.planning import PlanningGround, heights_at
from simulation.assessment.flown import FloatArray
from simulation.assessment.judging import AssessmentSurroundings
from simulation.assessment.obstacles import Standing
from simulation.rehearsing.ground import Heights
from simulation.rehearsing.ground_content import ground_content
from simulation.services.plan_to_fly import PlanToFly

SAME_DEG = 1e-6
BESIDE_DEG = 0.01  # about a kilometre beside the waypoints: flights that deviate more have failed before
NO_PLACES = np.zeros((0, 2))
NOTHING_STANDS = Standing(NO_PLACES, NO_PLACES, np.zeros(0), np.zeros(0))


def surroundings_of(plan: PlanToFly, ground: PlanningGround) -> AssessmentSurroundings:
    terrain = heights_at(ground.dataset_version)
    return AssessmentSurroundings(ground.table, _standing(plan, ground, terrain), _flat if terrain is None else terrain, plan.departs_s)


def ground_of_plan(plan: PlanToFly, ground: PlanningGround) -> str:
    """Return the hash of the surroundings of a plan's routes; see rehearsing/ground_content.py."""
    return ground_content([route.route for route in plan.routes], surroundings_of(plan, ground))


def _flat(positions: FloatArray) -> FloatArray:
    return np.zeros(len(positions))


def _standing(plan: PlanToFly, ground: PlanningGround, terrain: Heights | None) -> Standing:
    """Return obstacles near the routes, with tops AMSL; none without a network.

    The network assumes a large height for supports without one. Inspected ones are assumed to be as tall as in the plan.
    """
    try:
        spans = spans_of(ground.network())
    except NoGraph:
        return NOTHING_STANDS
    places = np.array([waypoint.position for route in plan.routes for waypoint in route.route.waypoints])
    near = _near(spans, places)
    start, end = spans.start[near], spans.end[near]
    at_start, at_end = (_flat(start), _flat(end)) if terrain is None else (terrain(start), terrain(end))
    start_m, end_m = _as_planned(start, spans.start_height_m[near], plan), _as_planned(end, spans.end_height_m[near], plan)
    return Standing(start, end, at_start + start_m, at_end + end_m)


def _as_planned(places: FloatArray, heights_m: FloatArray, plan: PlanToFly) -> FloatArray:
    """Return heights above ground (k,) of objects at places (k, 2)."""
    found = heights_m.copy()
    for position, height_m in plan.inspected:
        is_there = (np.abs(places - np.array(position)) <= SAME_DEG).all(axis=1)
        found[is_there] = np.minimum(found[is_there], height_m)
    return found


def _near(spans: Spans, places: FloatArray) -> np.ndarray[tuple[int, ...], np.dtype[np.intp]]:
    (west, south), (east, north) = places.min(axis=0) - BESIDE_DEG, places.max(axis=0) + BESIDE_DEG
    low, high = np.minimum(spans.start, spans.end), np.maximum(spans.start, spans.end)
    return np.flatnonzero((low[:, 0] <= east) & (high[:, 0] >= west) & (low[:, 1] <= north) & (high[:, 1] >= south))
