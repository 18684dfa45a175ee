"""Why no route visits a target: the zone, distance or range that prevents it, and which UAV could serve it."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import shapely
from shapely.geometry import LineString
from shapely.ops import nearest_points

from inspection.geodesy import LonLat, distance_m, path_length_m
from inspection.network.build.obstacles import NO_ZONE
from inspection.network.route_index import node_tree
from inspection.network.zones.zone_index import widen
from missions.models import UavState
from missions.selectors.fleet import uavs_of_organisation
from missions.selectors.planning_context import planning_context, read_targets, stored_bases
from missions.services.planning.planner import make_plan
from operation.reasons import Reason
from planning.airspace import Airspace, airspace_on, zone_at, zone_choice
from planning.assignment.options import may_do
from planning.assignment.refusals import groundings, target_height_m
from planning.assignment.routing_input import needs_flight_costs, visits_of_targets
from planning.connection_points import TargetPaths, Terminal, paths_between
from planning.context import ResolvedTarget
from planning.explain import route
from planning.explain.barriers import barriers_of
from planning.problem import Objective, Problem, UavStart
from planning.request import EndAction, PlanRequest, TargetRequest, UavRequest
from planning.solver.reach import needed_range_m
from planning.trajectory.heights import is_above_limit
from workspace.models import Organisation
from workspace.reason_texts import reason_text, why_text

MAX_SPARE = 8  # UAVs of the fleet, the nearest first, that are tried as alternatives
MIN_STRETCH_M = 50.0  # shorter parts of a line outside its zones are ignored


def _airspace(request: PlanRequest, *, is_by_length: bool) -> Airspace:
    """Return the airspace with the zones that can be in force while the request is flown. Raises InvalidRequest or NoGraph."""
    ground, targets, deleted = read_targets(request)
    context = planning_context(request, ground, targets, deleted)
    chosen = zone_choice(context.zones, request.departs_at, context.rules.flight).widest
    return airspace_on(context, chosen, is_by_length=is_by_length)


def explain_route(*, request: PlanRequest, routes: Sequence[Sequence[int]], uav: int, is_by_length: bool = False) -> dict[str, Any]:
    """Explain a UAV's route. routes: for each UAV of the request its targets in order; is_by_length: the plan uses the shortest paths.

    Raises InvalidRequest or NoGraph.
    """
    return route.explain_route(_airspace(request, is_by_length=is_by_length), request, routes, uav)


def explain_unreached_target(*, request: PlanRequest, target: int, organisation: Organisation) -> dict[str, Any]:
    """Explain an unassigned target, by its place in the request. Raises InvalidRequest or NoGraph."""
    airspace = _airspace(request, is_by_length=True)  # a target beyond reach on the shortest paths is so on all
    found = [one for one in airspace.context.targets if one.target == target]
    reported: dict[str, Any] = {
        "target": target,
        "reason": "asset_gone",
        "message": "",
        "zones": [],
        "stretches": [],
        "network_m": None,
        "access_limit_m": airspace.access.access_leg_m,
        "height_m": None,
        "needed_height_m": None,
        "height_limit_m": airspace.flight.max_agl_m,
        "tied_to": request.targets[target].uav or None,
        "sensor": request.targets[target].sensor,
        "uavs": [],
    }
    if not found:
        return reported
    (place,) = found
    height_m = target_height_m(place, airspace)
    network_m = _network_m(place, airspace)
    reported |= {"height_m": height_m, "needed_height_m": height_m + airspace.flight.clearance_m}
    reported |= {"network_m": network_m if np.isfinite(network_m) else None}
    if is_above_limit(height_m, airspace.flight):
        return reported | {"reason": "above_height_limit"}
    zones = _zones_at(place, airspace)
    if zones:
        return reported | {"reason": "inside_zone", "zones": zones, "stretches": _stretches_outside(place, airspace)}
    asked = [*request.uavs, *_spare_uavs(request, place, organisation)]
    on_the_ground = groundings(asked, airspace)
    grounded = [number in on_the_ground for number in range(len(asked))]
    fleet = replace(request, uavs=tuple(asked), bases=stored_bases(organisation))  # another UAV may land at a base
    ways, needed_m = _needs(fleet, place, airspace)
    uavs = [
        {
            "name": uav.name,
            "uav_id": uav.uav,
            "is_in_mission": number < len(request.uavs),
            "is_grounded": grounded[number],
            "is_allowed": may_do(uav, request.targets[target]),
            "most_targets": uav.most_targets,
            "needed_m": float(needed_m[number]) if np.isfinite(needed_m[number]) and not grounded[number] else None,
            "max_range_m": uav.max_range_m,
            "is_enough": bool(
                np.isfinite(needed_m[number])
                and not grounded[number]
                and may_do(uav, request.targets[target])
                and needed_m[number] <= (uav.max_range_m or np.inf)
            ),
        }
        for number, uav in enumerate(asked)
    ]
    reason = _reason(request.targets[target], place, [uav for uav in uavs if uav["is_in_mission"]], ways, airspace)
    alone = _refused_alone(request, target) if reason == "not_with_the_others" and needs_flight_costs(request) else None
    if alone is not None:
        return reported | {"reason": alone["reason"], "message": why_text(alone["why"], alone["message"]), "uavs": uavs}
    if reason == "no_path":
        starts = [uav.position for number, uav in enumerate(request.uavs) if not grounded[number]]
        return reported | _barred(place, starts, airspace) | {"uavs": uavs}
    return reported | {"reason": reason, "uavs": uavs}


def _barred(place: ResolvedTarget, starts: Sequence[LonLat], airspace: Airspace) -> dict[str, Any]:
    """Return what bars every path, as in a plan; near the place also the zones around it."""
    barrier = barriers_of([place], starts, airspace).get(place.target)
    why = (Reason("no_path"), *([] if barrier is None else [barrier.why]))
    zone = None if barrier is None else barrier.zone
    zones = [] if barrier is not None and zone is None else _zones_around(place, airspace)
    if zone is not None and zone.id is not None:
        zones = [{"id": zone.id, "name": zone.name}]
    return {"reason": "no_path", "message": " ".join(reason_text(reason) for reason in why), "zones": zones}


def _refused_alone(request: PlanRequest, target: int) -> dict[str, Any] | None:
    """Return why the mission's UAVs cannot serve the target alone in this wind and with these batteries; None if they can."""
    refused = make_plan(request=replace(request, targets=(request.targets[target],), locks=()))["unassigned"]
    return refused[0] if refused else None


def _reason(wished: TargetRequest, place: ResolvedTarget, uavs: list[dict[str, Any]], ways: TargetPaths, airspace: Airspace) -> str:
    if any(uav["is_enough"] for uav in uavs):
        return "not_with_the_others"
    uavs = [uav for uav in uavs if uav["is_allowed"]]
    if all(uav["is_grounded"] for uav in uavs) and (wished.uav or wished.sensor):
        return "not_allowed"
    if any(uav["needed_m"] is not None for uav in uavs):
        return "beyond_range"
    if not any(ways.entry_legs) and _network_m(place, airspace) > airspace.access.access_leg_m:
        return "too_far_from_network"
    return "no_path"


def _network_m(place: ResolvedTarget, airspace: Airspace) -> float:
    """Return the distance to the nearest node of the network from the nearer end [m]."""
    gaps_m = []
    for end in (place.course[0], place.course[-1]):
        for node in node_tree(airspace.graph).nearest(end, 1).tolist():
            gaps_m += distance_m(np.array([end]), airspace.graph.position[[node]]).tolist()
    return min(gaps_m, default=float("inf"))


def _zones_at(place: ResolvedTarget, airspace: Airspace) -> list[dict[str, Any]]:
    """Return the zones that contain the place or meet its course, clearance included."""
    shape = shapely.Point(place.course[0]) if len(place.course) == 1 else LineString(place.course)
    polygons = airspace.zones.polygons
    if not len(polygons):
        return []
    near = shapely.intersects(widen(polygons, airspace.access.zone_clearance_m), shape)
    return [_reported(zone, airspace) for zone in np.flatnonzero(near).tolist()]


def _zones_around(place: ResolvedTarget, airspace: Airspace) -> list[dict[str, Any]]:
    """Return the zones within reach of the place, nearest first, that block the straight paths to it."""
    polygons = airspace.zones.polygons
    here = np.array([place.course[0]])
    found = []
    for zone in range(len(polygons)):
        nearest, _ = nearest_points(polygons[zone], shapely.Point(place.course[0]))
        away_m = float(distance_m(here, np.array([[nearest.x, nearest.y]]))[0])
        if away_m <= airspace.access.access_leg_m:
            found.append((away_m, zone))
    return [_reported(zone, airspace) for _, zone in sorted(found)[:3]]


def _reported(zone: int, airspace: Airspace) -> dict[str, Any]:
    """Return a zone's JSON. An obstacle that cannot be overflown counts as a zone without an id."""
    key = int(airspace.zones.ids[zone])
    return {"id": None if key == NO_ZONE else key, "name": airspace.zones.names[zone]}


def _stretches_outside(place: ResolvedTarget, airspace: Airspace) -> list[list[list[float]]]:
    """Return the parts of a line's course that are clear of every zone, as pairs of ends."""
    if not place.is_stretch or place.asset is None:
        return []
    barred = shapely.union_all(widen(airspace.zones.polygons, 1.5 * airspace.access.zone_clearance_m + 1.0))
    parts = shapely.get_parts(shapely.difference(LineString(place.course), barred))
    ends = [np.array(part.coords) for part in parts if part.geom_type == "LineString"]
    return [[line[0].tolist(), line[-1].tolist()] for line in ends if path_length_m(line) >= MIN_STRETCH_M]


def _spare_uavs(request: PlanRequest, place: ResolvedTarget, organisation: Organisation) -> list[UavRequest]:
    """Return UAVs of the fleet that are in service, not in the request, and within range in a straight line, nearest first."""
    taken = {uav.uav for uav in request.uavs if uav.uav is not None}
    found = []
    for uav in uavs_of_organisation(organisation).filter(state=UavState.ACTIVE).exclude(pk__in=taken):
        if uav.missing:
            continue
        at = LonLat(*uav.location.coords)
        away_m = float(distance_m(np.array([at]), np.array([place.course[0]]))[0])
        if uav.range_m is None or away_m <= uav.range_m:
            spare = UavRequest(uav.name, at, uav.range_m, uav.speed_mps, EndAction(uav.end_action), uav.pk, sensors=tuple(uav.sensors))
            found.append((away_m, spare))
    return [uav for _, uav in sorted(found, key=lambda item: item[0])[:MAX_SPARE]]


def _needs(fleet: PlanRequest, place: ResolvedTarget, airspace: Airspace) -> tuple[TargetPaths, np.ndarray]:
    """Return the least range with which each UAV could serve the place alone; inf where there is no path."""
    visits, courses = visits_of_targets([place])
    ways = paths_between(
        airspace.graph,
        airspace.leg_zones,
        starts=[Terminal(uav.position) for uav in fleet.uavs],
        entries=[Terminal(course[0], place.asset) for course in courses],
        exits=[Terminal(course[-1], place.asset) for course in courses],
        rules=airspace.access,
        bases=[Terminal(base.position) for base in fleet.bases if zone_at(base.position, airspace) is None],
    )
    problem = Problem(
        uavs=tuple(UavStart(uav.max_range_m, fleet.route_end(number)) for number, uav in enumerate(fleet.uavs)),
        visits=tuple(visits),
        target_count=1,
        from_start_m=ways.from_start_m,
        between_m=ways.between_m,
        to_start_m=ways.to_start_m,
        objective=Objective.TOTAL,
        to_base_m=np.broadcast_to(ways.to_base_m[:, None], (len(visits), len(fleet.uavs))),
    )
    return ways, needed_range_m(problem).min(axis=1)
