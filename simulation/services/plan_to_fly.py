"""The present plan of a mission for simulation: its routes with the items that UAVs would receive, and their surroundings."""

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from django.conf import settings
from django.utils.translation import gettext as _

from inspection.geodesy import LonLat
from inspection.models import AssetKind
from inspection.network.spans import Spans, spans_of
from inspection.selectors import NoGraph
from inspection.selectors.planning import PlanningGround, heights_at
from mavlink.approved_route import FrozenRoute, NotARoute, route_from_json, route_to_json
from mavlink.mission_items import CannotBeFlown, flight_loads
from mavlink.vehicle_plan import FlightLoad, load_from_json, load_to_json
from missions.models import Approval, Mission, MissionUav
from missions.selectors.zones import departure_s
from missions.services.approval.document import frozen_route
from missions.services.commands.refused import RefusalReason, Refused, refuse
from planning.energy.conditions import Conditions, conditions_from_json
from planning.energy.performance import performance_from_json
from planning.trajectory.heights import asset_height_m
from simulation.assessment.flown import FloatArray
from simulation.assessment.judging import AssessmentSurroundings
from simulation.assessment.obstacles import Standing
from simulation.rehearsing.flying import RouteToFly
from simulation.rehearsing.ground import Heights, ground_content
from simulation.services.fleet import StandIn, stand_in_of


def content_of(
    routes: Sequence[RouteToFly],
    airframes: Sequence[str],
    batteries_wh: Sequence[float | None],
    departs_s: float | None,
    turnaround_s: float,
) -> str:
    """Return the SHA-256 of the routes, their items, airframes, departure and turnaround time."""
    parts: list[dict[str, Any]] = [
        {
            "uav": route.uav,
            "route": route_to_json(route.route),
            "items": [load_to_json(FlightLoad(items))["mission"] for items in route.items],
            **({"rally": [load_to_json(FlightLoad((), rally=rally))["rally"] for rally in route.rally]} if any(route.rally) else {}),
            "reserve_percent": route.reserve_percent,
            "limit_mps": route.limit_mps,
            "airframe": airframe,
            "battery_wh": battery_wh,
        }
        for route, airframe, battery_wh in zip(routes, airframes, batteries_wh, strict=True)
    ]
    between = {"turnaround_s": turnaround_s} if any(len(route.items) > 1 for route in routes) else {}
    text = json.dumps({"departs_s": departs_s, "routes": parts, **between}, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()


@dataclass(frozen=True, eq=False)
class PlanToFly:
    """departs_s: Unix seconds, None for any time. content_sha256 is the hash of all of it."""

    routes: tuple[RouteToFly, ...]
    stand_ins: tuple[StandIn, ...]
    conditions: Conditions
    departs_s: float | None
    content_sha256: str
    inspected: tuple[tuple[LonLat, float], ...] = ()  # towers that are targets, and their assumed height [m]


def plan_to_fly(mission: Mission) -> PlanToFly:
    """Return the plan of a mission loaded by selectors.mission_of_organisation.

    Raises Refused without a plan, or for one that cannot be flown. Approved routes are read from the approval's document, as for UAVs;
    others are made from the stored plan in the same way.
    """
    flown = [route for route in mission.routes.all() if route.geometry is not None]
    if not flown:
        raise refuse("not_planned", _("There is no plan to rehearse. Plan the mission first."))
    approved = _approved_routes(mission)
    routes, stand_ins, reasons = [], [], []
    for route in flown:
        uav = route.mission_uav
        try:
            frozen, loads = approved[uav.sequence] if uav.sequence in approved else _made(frozen_route(route, mission))
        except (CannotBeFlown, NotARoute) as error:
            values = {"uav": uav.name, "why": str(error)}
            reasons.append(RefusalReason("cannot_be_flown", _("%(uav)s cannot be given its route: %(why)s") % values, uav.sequence))
            continue
        routes.append(_to_fly(uav, frozen, loads, route.energy_wh, route.duration_s))
        stand_ins.append(stand_in_of(uav))
    if reasons:
        raise Refused(reasons)
    departs_s = departure_s(mission)
    content = content_of(
        routes,
        [one.airframe for one in stand_ins],
        [one.battery_wh for one in stand_ins],
        departs_s,
        turnaround_s=settings.FLIGHT_RULES.turnaround_s,
    )
    conditions = conditions_from_json(mission.conditions or None)
    return PlanToFly(tuple(routes), tuple(stand_ins), conditions, departs_s, content, _inspected(mission))


def _inspected(mission: Mission) -> tuple[tuple[LonLat, float], ...]:
    towers = [target.asset for target in mission.targets.all() if target.asset is not None and target.asset.kind == AssetKind.TOWER]
    return tuple(
        (
            LonLat(*tower.centre.coords[:2]),
            asset_height_m(kind=tower.kind, subtype=tower.subtype, tagged_m=tower.height_m, voltage_v=tower.max_voltage_v),
        )
        for tower in towers
    )


def _made(route: FrozenRoute) -> tuple[FrozenRoute, tuple[FlightLoad, ...]]:
    return route, flight_loads(route)


def _approved_routes(mission: Mission) -> dict[int, tuple[FrozenRoute, tuple[FlightLoad, ...]]]:
    """Return the approved routes by UAV place. Those for a companion computer, which have no items, get them from their route."""
    document = Approval.objects.filter(mission=mission, revoked_at=None).values_list("document", flat=True).first()
    found = {}
    for stored in [] if document is None else document["routes"]:
        route = route_from_json(stored["route"])
        items: list[dict[str, Any] | None] = [flight["items"] for flight in stored["flights"]]
        made = None if any(one is None for one in items) else tuple(load_from_json(one) for one in items if one is not None)
        found[stored["place"]] = (route, made) if made is not None else _made(route)
    return found


def _to_fly(uav: MissionUav, route: FrozenRoute, loads: tuple[FlightLoad, ...], planned_wh: float | None, planned_s: float) -> RouteToFly:
    performance = performance_from_json(uav.performance or None)
    return RouteToFly(
        uav=uav.sequence,
        name=uav.name,
        route=route,
        items=tuple(load.mission for load in loads),
        reserve_percent=performance.reserve_percent,
        planned_wh=planned_wh,
        planned_s=planned_s,
        rally=tuple(load.rally for load in loads),
        limit_mps=performance.max_airspeed_mps or route.cruise_speed_mps,
    )


SAME_DEG = 1e-6
BESIDE_DEG = 0.01  # about a kilometre beside the waypoints: flights that deviate more have failed before
NO_PLACES = np.zeros((0, 2))
NOTHING_STANDS = Standing(NO_PLACES, NO_PLACES, np.zeros(0), np.zeros(0))


def surroundings_of(plan: PlanToFly, ground: PlanningGround) -> AssessmentSurroundings:
    terrain = heights_at(ground.dataset_version)
    return AssessmentSurroundings(ground.table, _standing(plan, ground, terrain), _flat if terrain is None else terrain, plan.departs_s)


def ground_of_plan(plan: PlanToFly, ground: PlanningGround) -> str:
    """Return the hash of the surroundings of a plan's routes; see rehearsing/ground.py."""
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
    tops_m = spans.tops_m(near, _flat if terrain is None else terrain)
    for side, (places, heights_m) in enumerate(((start, spans.start_height_m[near]), (end, spans.end_height_m[near]))):
        tops_m[:, side] += _as_planned(places, heights_m, plan) - heights_m
    return Standing(start, end, tops_m[:, 0], tops_m[:, 1])


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
