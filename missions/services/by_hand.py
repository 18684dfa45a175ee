"""A route changed by hand: waypoints moved, put in, taken out, flown higher or at another speed; checked like any other, and taken back."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from django.conf import settings
from django.contrib.gis.geos import LineString, Point
from django.db import transaction
from django.db.models import Q
from django.utils.translation import gettext as _

from inspection.geodesy import LonLat, distance_m, path_length_m
from inspection.graph.network import Network
from inspection.graph.spans import spans_of
from inspection.models import Asset, AssetKind
from inspection.selectors import ground_heights_m, has_terrain
from inspection.selectors.planning import planning_read
from missions.flight_plan.clearance import TAKE_OFF
from missions.flight_plan.heights import asset_height_m, with_heights
from missions.flight_plan.leg_speeds import speeds_out_of_range
from missions.flight_plan.obstacles import too_low
from missions.flight_plan.power import NoHeadway
from missions.flight_plan.route_points import line_of, with_short_legs
from missions.flight_plan.sorties import lengths_of_sorties, timing_of_route, wh_of_sorties
from missions.flight_plan.tall_clearance import legs_too_near, spans_too_near
from missions.flight_plan.timing import Timing
from missions.flight_plan.waypoints import RoutePoint, RoutePoints, WaypointKind, Waypoints
from missions.leg_selectors import LegFlyer, speed_words, too_low_text
from missions.models import EndAction, Mission, Route, Waypoint
from missions.routing.terminals import tallest_support_m
from missions.services.last_look import flown_route
from missions.services.missions import check_lost_link, lock_mission, note, request_of_mission
from missions.services.plan_json import PlannedRoute
from missions.services.requests import InvalidRequest, PlanRequest, task_from_json
from missions.services.still_apart import separation_of_stored
from missions.zone_selectors import MetZone, zones_met
from workspace.models import User

MOVED_M = 0.1  # less is rounding
HIGHER_M = 0.05
MOST_WAYPOINTS = 5_000
LONGEST_M = 1_000_000.0
SAME_SPEED_MPS = 0.005
MOST_STEPS = 5  # that can be taken back


@dataclass(frozen=True)
class HandPoint:
    """A waypoint as it is wished. `was` is its place in the route until now; None: it is put in.

    speed_mps: over ground on the leg that leads here; None: the UAV's own.
    """

    position: LonLat
    agl_m: float
    was: int | None = None
    speed_mps: float | None = None


def change_route(*, mission: Mission, actor: User, uav: int, points: Sequence[HandPoint], expected_revision: int | None = None) -> Mission:
    """Fly the route of one UAV, by its place in the mission, over these points. Its targets stay, and their order.

    Raises InvalidRequest with what is wrong by its place (a point too low or too high, a leg that meets a zone, a speed that the wind does
    not leave, a battery that does not do), MissionChanged or MissionFrozen. Nothing is kept then.
    """
    with transaction.atomic():
        locked, route = _locked_route(mission, uav, expected_revision)
        until_now = list(route.waypoints.select_related("asset", "target"))
        _refuse(_shape_faults(points, until_now))
        if len(route.before_hand) == MOST_STEPS:  # the route as planned is forgotten, and with it what was proven of it
            locked.plan_quality = {name: value for name, value in (locked.plan_quality or {}).items() if name != "planned"}
        route.before_hand = [*route.before_hand, [_step_row(waypoint) for waypoint in until_now]][-MOST_STEPS:]
        by_hand = {_place(point.position, point.agl_m) for point in points if _is_by_hand(point, until_now)}
        _fly(locked, route, uav, _route_points(points, until_now), by_hand)
        note(locked, actor, "by-hand", before=None, after={"revision": locked.revision, "uav": route.mission_uav.name})
    return locked


def take_back_change(*, mission: Mission, actor: User, uav: int, expected_revision: int | None = None) -> Mission:
    """The route as it was before it was changed by hand last, checked against what holds now. Raises as change_route."""
    with transaction.atomic():
        locked, route = _locked_route(mission, uav, expected_revision)
        if not route.before_hand:
            raise InvalidRequest({"uav": _("No change by hand of this route can be taken back.")})
        *route.before_hand, rows = route.before_hand
        points = _step_points(rows)
        by_hand = {_place(point.position, point.agl_m) for point, row in zip(points, rows, strict=True) if row["is_by_hand"]}
        _fly(locked, route, uav, RoutePoints.of(points), by_hand)
        note(locked, actor, "by-hand-undone", before=None, after={"revision": locked.revision, "uav": route.mission_uav.name})
    return locked


def _locked_route(mission: Mission, uav: int, expected_revision: int | None) -> tuple[Mission, Route]:
    locked = lock_mission(mission_id=mission.pk, expected_revision=expected_revision)
    route = locked.routes.select_related("mission_uav").filter(mission_uav__sequence=uav, geometry__isnull=False).first()
    if route is None:
        raise InvalidRequest({"uav": _("This UAV flies no route.")})
    if route.charging:
        raise InvalidRequest({"uav": _("A route with stops to charge cannot be changed by hand.")})
    return locked, route


def _fly(locked: Mission, route: Route, uav: int, wished: RoutePoints, by_hand: set[tuple[float, float, float]]) -> None:
    """Checks the points, stores them as the route, and what follows from it on the mission. by_hand: which of them a person changed."""
    _refuse(_obstacle_faults(wished))
    request = request_of_mission(mission=locked)
    flown = _flown(request, uav, wished, route.departs_s)
    assert flown.waypoints is not None  # noqa: S101 - just drawn
    leads_to = _leads_to(wished, flown.waypoints.points)
    _refuse(_speed_faults(flown, leads_to, request, uav))
    _refuse(_wire_faults(flown))
    _refuse(_zone_faults(flown, leads_to, locked))
    _refuse(_reach_faults(flown, request, uav))
    _store(locked, route, flown, by_hand)
    locked.total_length_m = round(sum(own.length_m for own in locked.routes.all()), 3)
    locked.longest_route_m = max(own.length_m for own in locked.routes.all())
    counted = [own.energy_wh for own in locked.routes.all() if own.energy_wh is not None]
    locked.total_energy_wh = round(sum(counted), 2) if counted else None
    locked.separation = separation_of_stored(locked)
    check_lost_link(mission=locked)
    locked.plan_quality = _quality(locked)
    locked.revision += 1
    locked.save()


def _quality(mission: Mission) -> dict[str, Any]:
    """Nothing is proven of a plan that a hand has changed; once every change is taken back, what was proven before is."""
    quality = mission.plan_quality or {}
    planned = quality.get("planned", quality)
    by_hand = Q(waypoints__is_by_hand=True) | ~Q(before_hand=[])  # of what was only taken out nothing is left to see
    if not mission.routes.filter(by_hand).exists():
        return dict(planned)
    return planned | {"is_proven": False, "gap": None, "method": "by hand", "planned": planned}


def _step_row(waypoint: Waypoint) -> dict[str, Any]:
    """A waypoint as it is kept to be taken back to; its target by its place in the mission, which a copy shares."""
    return {
        "position": list(waypoint.position.coords),
        "agl_m": waypoint.altitude_agl_m,
        "kind": waypoint.kind,
        "asset": waypoint.asset_id,
        "target": None if waypoint.target is None else waypoint.target.sequence,
        "task": waypoint.task,
        "speed_mps": waypoint.speed_mps,
        "is_by_hand": waypoint.is_by_hand,
    }


def _step_points(rows: Sequence[dict[str, Any]]) -> list[RoutePoint]:
    there = set(Asset.objects.filter(pk__in={row["asset"] for row in rows} - {None}).values_list("pk", flat=True))
    return [
        RoutePoint(
            LonLat(*row["position"]),
            WaypointKind(row["kind"]),
            row["agl_m"],
            row["asset"] if row["asset"] in there else None,
            row["target"],
            task_from_json(row["task"]),
            row["speed_mps"],
        )
        for row in rows
    ]


def _refuse(faults: dict[str, str]) -> None:
    if faults:
        raise InvalidRequest(faults)


def _shape_faults(points: Sequence[HandPoint], until_now: Sequence[Waypoint]) -> dict[str, str]:
    """What is wrong with the list itself, and with the heights in it."""
    if len(points) > MOST_WAYPOINTS:
        return {"waypoints": _("At most %(limit)s waypoints.") % {"limit": MOST_WAYPOINTS}}
    kept = [point.was for point in points if point.was is not None]
    if any(not 0 <= was < len(until_now) for was in kept) or any(right <= left for left, right in pairwise(kept)):
        return {"waypoints": _("The waypoints are not in the order of the route.")}
    fixed = [number for number, waypoint in enumerate(until_now) if waypoint.kind != WaypointKind.PASS]
    if not set(fixed) <= set(kept) or points[0].was != 0 or points[-1].was != len(until_now) - 1:
        return {"waypoints": _("Start, end and targets stay on the route. Take a target out of the mission instead.")}
    if path_length_m(np.array([point.position for point in points])) > LONGEST_M:
        return {"waypoints": _("A route is at most %(limit)s km long.") % {"limit": f"{LONGEST_M / 1_000:.0f}"}}
    faults: dict[str, str] = {}
    flight, network = settings.FLIGHT_RULES, planning_read().ground().network()
    for number, point in enumerate(points):
        waypoint = None if point.was is None else until_now[point.was]
        if waypoint is not None and waypoint.kind != WaypointKind.PASS and _apart_m(point, waypoint) > MOVED_M:
            faults[f"waypoints.{number}.position"] = _("Start, end and targets stay where they are.")
        low_m = _least_agl_m(waypoint, network, is_moved=waypoint is None or _apart_m(point, waypoint) > MOVED_M)
        if not low_m - HIGHER_M <= point.agl_m <= flight.max_agl_m + HIGHER_M:
            limits = {"low": f"{low_m:.0f}", "high": f"{flight.max_agl_m:.0f}"}
            faults[f"waypoints.{number}.altitude_agl_m"] = _("Between %(low)s and %(high)s m above ground here.") % limits
        if point.speed_mps is not None and waypoint is not None and waypoint.kind in {WaypointKind.START, WaypointKind.BASE}:
            faults[f"waypoints.{number}.speed_mps"] = _("No leg leads here.")
    return faults


def _obstacle_faults(points: RoutePoints) -> dict[str, str]:
    """Where waypoints and legs as they are wished, straight from one to the next, pass something tall too low."""
    flight, ground = settings.FLIGHT_RULES, ground_heights_m if has_terrain() else None
    under_m = np.full(len(points), np.nan) if ground is None else ground(points.position)
    amsl_m = None if np.isnan(under_m).any() else points.agl_m + under_m
    waypoints, spans = Waypoints(points, amsl_m, points.agl_m), spans_of(planning_read().ground().network())
    low = too_low(waypoints, spans, ground, flight)
    if low is None:
        return {}
    near = legs_too_near(waypoints, spans, ground, flight)  # rounded to centimetres a planned route may seem too low, but is not too near
    stands = np.append((points.position[:-1] == points.position[1:]).all(axis=1), False)  # straight up or down to the next one
    faults: dict[str, str] = {}
    for place, is_leg, agl_m, span in zip(low.place.tolist(), low.is_leg.tolist(), low.agl_m.tolist(), low.span.tolist(), strict=True):
        legs = [place] if is_leg else [leg for leg in (place - 1, place) if stands[leg]]
        if any((leg, span) in near for leg in legs):
            faults.setdefault(f"legs.{place}" if is_leg else f"waypoints.{place}.altitude_agl_m", too_low_text(agl_m))
    return faults


def _wire_faults(flown: PlannedRoute) -> dict[str, str]:
    """The last look at the route as it is drawn over the ground."""
    assert flown.waypoints is not None  # noqa: S101 - just drawn
    ground = None if flown.is_flat else ground_heights_m
    near = spans_too_near(flown.waypoints, spans_of(planning_read().ground().network()), ground, settings.FLIGHT_RULES)
    return {"waypoints": _("The route passes a mast or wires too near.")} if near else {}


def _least_agl_m(waypoint: Waypoint | None, network: Network, *, is_moved: bool) -> float:
    """How low a point may be: with clearance above what is there, and where that is not known as high as between targets."""
    flight = settings.FLIGHT_RULES
    if waypoint is None or is_moved:
        return flight.transit_agl_m
    if waypoint.asset is not None:
        asset = waypoint.asset
        height_m = asset_height_m(kind=asset.kind, subtype=asset.subtype, tagged_m=asset.height_m, voltage_v=asset.max_voltage_v)
        if waypoint.target is not None and waypoint.target.stretch is not None:
            course = [LonLat(*vertex) for vertex in waypoint.target.stretch.coords]
            height_m = max(height_m, tallest_support_m(network, asset.pk, course))
        elif asset.kind in {AssetKind.TOWER, AssetKind.BRIDGE}:  # by its line's voltage it may be taken to be taller
            height_m = float(np.fmax.reduce(network.node_height_m[network.node_asset == asset.pk], initial=height_m))
        least_m = height_m + flight.clearance_m
        return least_m if waypoint.target_id is not None else max(least_m, flight.transit_agl_m)
    return min(waypoint.altitude_agl_m, flight.transit_agl_m)


def _apart_m(point: HandPoint, waypoint: Waypoint) -> float:
    return float(distance_m(np.array([point.position]), np.array([waypoint.position.coords]))[0])


def _route_points(points: Sequence[HandPoint], until_now: Sequence[Waypoint]) -> RoutePoints:
    """A point that was moved passes nothing."""
    drawn = []
    for point in points:
        waypoint = None if point.was is None else until_now[point.was]
        if waypoint is None or (waypoint.kind == WaypointKind.PASS and _apart_m(point, waypoint) > MOVED_M):
            drawn.append(RoutePoint(point.position, WaypointKind.PASS, point.agl_m, speed_mps=point.speed_mps))
            continue
        target = None if waypoint.target is None else waypoint.target.sequence
        at = LonLat(*waypoint.position.coords)
        task = task_from_json(waypoint.task)
        drawn.append(RoutePoint(at, WaypointKind(waypoint.kind), point.agl_m, waypoint.asset_id, target, task, point.speed_mps))
    return RoutePoints.of(drawn)


def _flown(request: PlanRequest, uav: int, points: RoutePoints, departs_s: float) -> PlannedRoute:
    flight, action = settings.FLIGHT_RULES, request.end_action(uav)
    points, length_m = with_short_legs(points, flight.longest_leg_m)
    waypoints, is_flat = with_heights(points, ground_heights_m if has_terrain() else None, flight)
    clock = _clock(waypoints, request, uav)
    return PlannedRoute(
        waypoints=waypoints, line=line_of(waypoints.points), length_m=length_m, duration_s=clock.total_s, end_action=action,
        is_flat=is_flat, departs_s=departs_s,
        timing=clock,
    )  # fmt: skip


def _clock(waypoints: Waypoints, request: PlanRequest, uav: int) -> Timing:
    asked = request.uavs[uav]
    try:
        return timing_of_route(
            waypoints,
            cruise_speed_mps=asked.cruise_speed_mps,
            performance=asked.performance,
            conditions=request.conditions,
            lands=request.end_action(uav) is not EndAction.HOVER,
            rules=settings.FLIGHT_RULES,
        )
    except NoHeadway as error:
        raise InvalidRequest({"waypoints": _("The wind is too strong for %(uav)s on a leg.") % {"uav": asked.name}}) from error


def _leads_to(wished: RoutePoints, flown: RoutePoints) -> list[int]:
    """For each point that is flown the wished one that its leg leads to: where a leg is divided, its parts lead to one."""
    leads_to, number = [], 0
    for position, agl_m in zip(flown.position, flown.agl_m.tolist(), strict=True):
        leads_to.append(number)
        if number < len(wished) - 1 and agl_m == wished.agl_m[number] and (position == wished.position[number]).all():
            number += 1
    return leads_to


def _speed_faults(flown: PlannedRoute, leads_to: Sequence[int], request: PlanRequest, uav: int) -> dict[str, str]:
    assert flown.waypoints is not None  # noqa: S101 - just drawn
    asked = request.uavs[uav]
    flyer = LegFlyer(asked.name, asked.cruise_speed_mps, asked.performance, request.conditions)
    found = speeds_out_of_range(
        flown.waypoints, cruise_speed_mps=asked.cruise_speed_mps, performance=asked.performance, conditions=request.conditions
    )
    return {f"waypoints.{leads_to[place]}.speed_mps": speed_words(found[place], flyer) for place in sorted(found, reverse=True)}


def _zone_faults(flown: PlannedRoute, leads_to: Sequence[int], mission: Mission) -> dict[str, str]:
    (met,) = zones_met([flown_route(flown, mission.departs_at)])
    last = len(leads_to) - 1

    def leg(meeting: MetZone) -> int:
        return max(leads_to[min(leg_of(meeting) + 1, last)] - 1, 0)

    return {f"legs.{leg(meeting)}": _("This leg meets %(zone)s.") % {"zone": meeting.name} for meeting in reversed(met)}


def leg_of(meeting: MetZone) -> int:
    """The leg's number, the column up to the first waypoint counting as part of the first."""
    return max(meeting.breach.leg, TAKE_OFF + 1)


def _reach_faults(flown: PlannedRoute, request: PlanRequest, uav: int) -> dict[str, str]:
    asked = request.uavs[uav]
    longest_m = max(lengths_of_sorties(flown.waypoints)) if flown.waypoints else 0.0
    if asked.max_range_m is not None and longest_m > asked.max_range_m:
        values = {"length": f"{longest_m / 1_000:.1f}", "range": f"{asked.max_range_m / 1_000:.1f}", "uav": asked.name}
        return {"waypoints": _("This is %(length)s km; the range of %(uav)s is %(range)s km.") % values}
    usable_wh = asked.performance.usable_wh
    most_wh = max(wh_of_sorties(flown.timing), default=0.0) if flown.timing else 0.0
    if usable_wh is None or most_wh <= usable_wh:
        return {}
    missing = {"missing": f"{most_wh - usable_wh:.1f}", "uav": asked.name}
    return {"waypoints": _("The battery of %(uav)s lacks %(missing)s Wh for this.") % missing}


def _store(mission: Mission, route: Route, flown: PlannedRoute, by_hand: set[tuple[float, float, float]]) -> None:
    assert flown.waypoints is not None and flown.timing is not None and flown.line is not None  # noqa: S101 - just drawn
    targets: dict[int, int] = dict(mission.targets.values_list("sequence", "pk"))
    clock = flown.timing
    route.geometry = LineString(flown.line.tolist(), srid=4326)
    route.length_m, route.duration_s = round(flown.length_m, 3), round(flown.duration_s, 1)
    route.energy_wh = None if clock.total_wh is None else round(clock.total_wh, 2)
    route.battery_percent = None if clock.end_percent is None else round(clock.end_percent, 1)
    route.save()
    route.waypoints.all().delete()
    Waypoint.objects.bulk_create(
        (
            Waypoint(
                route=route,
                sequence=number,
                kind=waypoint.point.kind,
                position=Point(*waypoint.point.position, srid=4326),
                asset_id=waypoint.point.asset,
                target_id=None if waypoint.point.target is None else targets[waypoint.point.target],
                task=_task(waypoint.point),
                altitude_agl_m=round(waypoint.point.agl_m, 2),
                altitude_amsl_m=None if waypoint.amsl_m is None else round(waypoint.amsl_m, 2),
                altitude_relative_m=round(waypoint.relative_m, 2),
                arrival_s=round(float(clock.arrival_s[number]) + route.departs_s, 1),
                used_wh=None if clock.used_wh is None else round(float(clock.used_wh[number]), 2),
                battery_left_percent=None if clock.battery_left_percent is None else round(float(clock.battery_left_percent[number]), 1),
                speed_mps=waypoint.point.speed_mps,
                is_by_hand=waypoint.point.speed_mps is not None or _place(waypoint.point.position, waypoint.point.agl_m) in by_hand,
            )
            for number, waypoint in enumerate(flown.waypoints)
        ),
        batch_size=1_000,
    )


def _task(point: RoutePoint) -> dict[str, Any] | None:
    return None if point.task is None else {"kind": point.task.kind.value, "hold_s": point.task.hold_s}


def _is_by_hand(point: HandPoint, until_now: Sequence[Waypoint]) -> bool:
    if point.was is None:
        return True
    waypoint = until_now[point.was]
    is_elsewhere = _apart_m(point, waypoint) > MOVED_M or abs(point.agl_m - waypoint.altitude_agl_m) > HIGHER_M
    return waypoint.is_by_hand or is_elsewhere or not _is_same_speed(point.speed_mps, waypoint.speed_mps)


def _is_same_speed(one_mps: float | None, other_mps: float | None) -> bool:
    if one_mps is None or other_mps is None:
        return one_mps is other_mps
    return abs(one_mps - other_mps) < SAME_SPEED_MPS


def _place(position: LonLat, agl_m: float) -> tuple[float, float, float]:
    return round(position.lon, 9), round(position.lat, 9), round(agl_m, 2)
