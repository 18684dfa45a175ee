"""Faults and figures of a manually edited route: the same checks while it is dragged and before it is saved."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from django.conf import settings
from django.utils.translation import gettext as _
from numpy.typing import NDArray

from inspection.models import AssetKind
from inspection.network.build.network import Network
from inspection.network.spans import spans_of
from inspection.selectors.planning import DatasetVersion, planning_read
from missions.models import Mission
from missions.reason_texts import fault_texts
from missions.selectors.legs import LegFlyer, speed_words, too_low_text
from missions.selectors.planning_context import terrain_under
from missions.selectors.zones import MetZone, zones_met
from missions.services.manual_edits.points import HIGHER_M, EditedPoint, are_by_hand, are_moved, list_faults, route_points
from missions.services.manual_edits.stored_route import KeptWaypoint, kept_route
from planning.checks.zones import flown_route
from planning.clearance.obstacle_clearance import legs_too_near, spans_too_near
from planning.clearance.zone_clearance import TAKE_OFF
from planning.connection_points import tallest_support_m
from planning.energy.power import NoHeadway
from planning.plan import PlannedRoute
from planning.request import EndAction, InvalidRequest, PlanRequest
from planning.trajectory.heights import GroundModel, asset_height_m, with_heights
from planning.trajectory.leg_speeds import ground_speeds, speeds_out_of_range
from planning.trajectory.obstacles import too_low
from planning.trajectory.route_points import line_of, with_short_legs
from planning.trajectory.sorties import lengths_of_sorties, timing_of_route, wh_of_sorties
from planning.trajectory.timing import Timing
from planning.trajectory.waypoints import RoutePoints, WaypointKind, Waypoints
from workspace.locale_negotiation import number_text


@dataclass(frozen=True, eq=False)
class ManualEditContext:
    """Map data of a check. terrain: None without a terrain model."""

    network: Network
    terrain: GroundModel | None
    dataset_version: DatasetVersion


def manual_edit_context() -> ManualEditContext:
    """Return the current context. Raises NoGraph."""
    ground = planning_read().ground()
    return ManualEditContext(ground.network(), terrain_under(ground.dataset_version), ground.dataset_version)


@dataclass(frozen=True)
class FlownEditedPoint:
    """Figures at a requested point: seconds after the departure, remaining battery, and the speed over ground on the leg to it."""

    arrival_s: float
    battery_left_percent: float | None
    speed_mps: float | None


@dataclass(frozen=True)
class ManualEditCheck:
    """Check of an edited route. faults: all faults by their place; without `flown` the route can neither be drawn nor flown.

    points: for each requested point.
    """

    faults: dict[str, str]
    flown: PlannedRoute | None = None
    points: tuple[FlownEditedPoint, ...] = field(default=())


def check_manual_edit(*, mission: Mission, uav: int, points: Sequence[EditedPoint]) -> ManualEditCheck:
    """Return faults of these points and figures of flying them, storing nothing. Raises InvalidRequest if the UAV has no route."""
    ground = manual_edit_context()
    route = kept_route(mission, uav, ground.dataset_version)
    if route is None:
        raise InvalidRequest({"uav": _("This UAV flies no route.")})
    faults = list_faults(points, route.waypoints)
    if faults:
        return ManualEditCheck(faults)
    wished = route_points(points, route.waypoints)
    faults = obstacle_faults(wished, ground) | point_faults(points, route.waypoints, ground)
    try:
        by_hand = np.array(are_by_hand(points, route.waypoints), dtype=np.bool_)
        flown = flown_manual_edit(route.request, uav, wished, by_hand, route.departs_s, ground)
    except InvalidRequest as error:
        return ManualEditCheck(fault_texts(error) | faults)
    for found in faults_as_flown(flown, wished, mission, route.request, uav, ground):
        faults = found | faults
    return ManualEditCheck(faults, flown, _points_flown(flown, wished, route.request, uav))


def _points_flown(flown: PlannedRoute, wished: RoutePoints, request: PlanRequest, uav: int) -> tuple[FlownEditedPoint, ...]:
    assert flown.waypoints is not None and flown.timing is not None  # noqa: S101 - the call above sets them
    asked, clock = request.uavs[uav], flown.timing
    speeds_mps = ground_speeds(
        flown.waypoints, cruise_speed_mps=asked.cruise_speed_mps, performance=asked.performance, conditions=request.conditions
    )
    leads_to = _leads_to(wished, flown.waypoints.points)
    last = {number: place for place, number in enumerate(leads_to)}
    slowest: dict[int, float] = {}
    for number, speed_mps in zip(leads_to, speeds_mps, strict=True):
        if speed_mps is not None:
            slowest[number] = min(speed_mps, slowest.get(number, speed_mps))
    left = clock.battery_left_percent
    return tuple(
        FlownEditedPoint(
            float(clock.arrival_s[last[number]]) + flown.departs_s,
            None if left is None else float(left[last[number]]),
            slowest.get(number),
        )
        for number in range(len(wished))
    )


def point_faults(points: Sequence[EditedPoint], until_now: Sequence[KeptWaypoint], ground: ManualEditContext) -> dict[str, str]:
    """Return the faults of single points: their positions, heights and speeds."""
    faults: dict[str, str] = {}
    flight, network = settings.FLIGHT_RULES, ground.network
    heights_m = _node_heights_m(network, {waypoint.asset.key for waypoint in until_now if waypoint.asset is not None})
    for number, (point, is_moved) in enumerate(zip(points, are_moved(points, until_now), strict=True)):
        waypoint = None if point.was is None else until_now[point.was]
        if waypoint is not None and waypoint.kind != WaypointKind.PASS and is_moved:
            faults[f"waypoints.{number}.position"] = _("Start, end and targets stay where they are.")
        low_m = flight.transit_agl_m if waypoint is None or is_moved else _least_agl_m(waypoint, network, heights_m)
        if not low_m - HIGHER_M <= point.agl_m <= flight.max_agl_m + HIGHER_M:
            limits = {"low": number_text(low_m), "high": number_text(flight.max_agl_m)}
            faults[f"waypoints.{number}.altitude_agl_m"] = _("Between %(low)s and %(high)s m above ground here.") % limits
        if point.speed_mps is not None and waypoint is not None and waypoint.kind in {WaypointKind.START, WaypointKind.BASE}:
            faults[f"waypoints.{number}.speed_mps"] = _("No leg leads here.")
    return faults


def obstacle_faults(points: RoutePoints, ground: ManualEditContext) -> dict[str, str]:
    """Return the faults of points and straight legs, as requested, that pass an obstacle too low."""
    flight = settings.FLIGHT_RULES
    under_m = np.full(len(points), np.nan) if ground.terrain is None else ground.terrain.heights_m(points.position)
    amsl_m = None if np.isnan(under_m).any() else points.agl_m + under_m
    waypoints, spans = Waypoints(points, amsl_m, points.agl_m), spans_of(ground.network)
    low = too_low(waypoints, spans, ground.terrain, flight)
    if low is None:
        return {}
    near = legs_too_near(
        waypoints, spans, None if ground.terrain is None else ground.terrain.heights_m, flight
    )  # rounded to centimetres a planned route may appear too low, but not too near
    stands = np.append((points.position[:-1] == points.position[1:]).all(axis=1), False)  # vertical to the next point
    faults: dict[str, str] = {}
    for place, is_leg, agl_m, span in zip(low.place.tolist(), low.is_leg.tolist(), low.agl_m.tolist(), low.span.tolist(), strict=True):
        legs = [place] if is_leg else [leg for leg in (place - 1, place) if stands[leg]]
        if any((leg, span) in near for leg in legs):
            faults.setdefault(f"legs.{place}" if is_leg else f"waypoints.{place}.altitude_agl_m", too_low_text(agl_m))
    return faults


def _wire_faults(flown: PlannedRoute, ground: ManualEditContext) -> dict[str, str]:
    """Return the faults of the final check against wires, of the route as drawn over the terrain."""
    assert flown.waypoints is not None  # noqa: S101 - set by the drawing
    heights = None if flown.is_flat or ground.terrain is None else ground.terrain.heights_m
    near = spans_too_near(flown.waypoints, spans_of(ground.network), heights, settings.FLIGHT_RULES)
    return {"waypoints": _("The route passes a mast, wires or a bridge too near.")} if near else {}


def _least_agl_m(waypoint: KeptWaypoint, network: Network, node_heights_m: Mapping[int, float]) -> float:
    """Return the minimum height of a kept waypoint [m AGL]: clearance above its asset, or the transit height where that is unknown."""
    flight, asset = settings.FLIGHT_RULES, waypoint.asset
    if asset is None:
        return min(waypoint.altitude_agl_m, flight.transit_agl_m)
    height_m = asset_height_m(kind=asset.kind, subtype=asset.subtype, tagged_m=asset.height_m, voltage_v=asset.max_voltage_v)
    if waypoint.stretch is not None:
        height_m = max(height_m, tallest_support_m(network, asset.key, waypoint.stretch))
    elif asset.kind in {AssetKind.TOWER, AssetKind.BRIDGE}:  # its line's voltage may imply a taller one
        height_m = max(height_m, node_heights_m.get(asset.key, height_m))
    least_m = height_m + flight.clearance_m
    return least_m if waypoint.target is not None else max(least_m, flight.transit_agl_m)


def _node_heights_m(network: Network, assets: Collection[int]) -> dict[int, float]:
    """Return the greatest known height of each asset's nodes."""
    nodes = np.flatnonzero(np.isin(network.node_asset, np.array(sorted(assets), dtype=np.int64)) & ~np.isnan(network.node_height_m))
    found: dict[int, float] = {}
    for asset, height_m in zip(network.node_asset[nodes].tolist(), network.node_height_m[nodes].tolist(), strict=True):
        found[asset] = max(height_m, found.get(asset, height_m))
    return found


def flown_manual_edit(
    request: PlanRequest, uav: int, points: RoutePoints, by_hand: NDArray[np.bool_], departs_s: float, ground: ManualEditContext
) -> PlannedRoute:
    """Return the route over these points. by_hand (n,): those that a user edited; a leg between them comes no lower than they are.

    Other points may lie higher than they have to because of the terrain: a leg between them may come lower by the tolerance, not below
    the transit height.
    """
    flight, action = settings.FLIGHT_RULES, request.end_action(uav)
    least_m = np.maximum(points.agl_m - flight.terrain_tolerance_m, np.minimum(points.agl_m, flight.transit_agl_m))
    floors_m = np.where(by_hand, points.agl_m, least_m)
    floors, _length_m = with_short_legs(points.at_heights(floors_m), flight.longest_leg_m)
    points, length_m = with_short_legs(points, flight.longest_leg_m)
    waypoints, is_flat = with_heights(points, ground.terrain, flight, floors.agl_m)
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


def faults_as_flown(
    flown: PlannedRoute, wished: RoutePoints, mission: Mission, request: PlanRequest, uav: int, ground: ManualEditContext
) -> Iterator[dict[str, str]]:
    """Yield the faults of a route as drawn, one kind after the other: speeds, wires, zones at their times, range and battery."""
    assert flown.waypoints is not None  # noqa: S101 - set by the drawing
    leads_to = _leads_to(wished, flown.waypoints.points)
    yield _speed_faults(flown, leads_to, request, uav)
    yield _wire_faults(flown, ground)
    yield _zone_faults(flown, leads_to, mission)
    yield _reach_faults(flown, request, uav)


def _leads_to(wished: RoutePoints, flown: RoutePoints) -> list[int]:
    """Return for each flown point the requested one at the end of its leg; the parts of a divided leg share one."""
    leads_to, number = [], 0
    for position, agl_m in zip(flown.position, flown.agl_m.tolist(), strict=True):
        leads_to.append(number)
        if number < len(wished) - 1 and agl_m == wished.agl_m[number] and (position == wished.position[number]).all():
            number += 1
    return leads_to


def _speed_faults(flown: PlannedRoute, leads_to: Sequence[int], request: PlanRequest, uav: int) -> dict[str, str]:
    assert flown.waypoints is not None  # noqa: S101 - set by the drawing
    asked = request.uavs[uav]
    flyer = LegFlyer(asked.name, asked.cruise_speed_mps, asked.performance, request.conditions)
    found = speeds_out_of_range(
        flown.waypoints, cruise_speed_mps=asked.cruise_speed_mps, performance=asked.performance, conditions=request.conditions
    )
    return {f"waypoints.{leads_to[place]}.speed_mps": speed_words(found[place], flyer) for place in sorted(found, reverse=True)}


def _zone_faults(flown: PlannedRoute, leads_to: Sequence[int], mission: Mission) -> dict[str, str]:
    (met,) = zones_met([flown_route(flown, mission.departs_at, settings.FLIGHT_RULES)])
    last = len(leads_to) - 1

    def leg(meeting: MetZone) -> int:
        return max(leads_to[min(leg_of(meeting) + 1, last)] - 1, 0)

    return {f"legs.{leg(meeting)}": _("This leg meets %(zone)s.") % {"zone": meeting.name} for meeting in reversed(met)}


def leg_of(meeting: MetZone) -> int:
    """Return the leg's number; the climb to the first waypoint counts as part of the first."""
    return max(meeting.breach.leg, TAKE_OFF + 1)


def _reach_faults(flown: PlannedRoute, request: PlanRequest, uav: int) -> dict[str, str]:
    asked = request.uavs[uav]
    longest_m = max(lengths_of_sorties(flown.waypoints)) if flown.waypoints else 0.0
    if asked.max_range_m is not None and longest_m > asked.max_range_m:
        values = {"length": number_text(longest_m / 1_000, 1), "range": number_text(asked.max_range_m / 1_000, 1), "uav": asked.name}
        return {"waypoints": _("This is %(length)s km; the range of %(uav)s is %(range)s km.") % values}
    usable_wh = asked.performance.usable_wh
    most_wh = max(wh_of_sorties(flown.timing), default=0.0) if flown.timing else 0.0
    if usable_wh is None or most_wh <= usable_wh:
        return {}
    missing = {"missing": number_text(most_wh - usable_wh, 1), "uav": asked.name}
    return {"waypoints": _("The battery of %(uav)s lacks %(missing)s Wh for this.") % missing}
