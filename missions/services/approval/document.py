"""The document that an approval freezes: the routes, what they were checked against, and the items sent to UAVs.

It is written in a canonical form, whose SHA-256 names it. Everything sent to a UAV is read from it.
"""

import hashlib
import json
from dataclasses import replace
from typing import Any

import numpy as np
from django.conf import settings
from django.contrib.gis.db.models.functions import AsGeoJSON
from django.utils.translation import gettext as _

from inspection.geodesy import LonLat
from inspection.models import Asset
from inspection.selectors import ground_revision, terrain_dataset_version
from inspection.selectors.zone_table import zone_table
from inspection.zones.reach import ZoneTable
from mavlink.approved_route import (
    FrozenRoute,
    FrozenWaypoint,
    NotARoute,
    TakeOff,
    flight_to_json,
    photo_clearances_m,
    route_to_json,
)
from mavlink.fence import fence_of, rally_items
from mavlink.legs import with_points_between
from mavlink.mission_items import CannotBeFlown, flight_loads
from mavlink.vehicle_plan import FlightLoad, MissionItem, load_to_json
from missions.models import LinkKind, Mission, Route, Waypoint
from missions.selectors.zones import departure_s, zone_margins
from missions.services.approval.fence import rally_points, zones_beside
from missions.services.commands.refused import RefusalReason, Refused
from missions.services.stored_routes import speeds_of_targets
from planning.clearance.nearby_zones import zones_near
from planning.energy.conditions import conditions_from_json, conditions_to_json
from planning.request import EndAction, lost_link_from_json, lost_link_to_json, moment_to_json
from planning.task import task_from_json
from planning.trajectory.leg_speeds import inspection_speeds
from planning.trajectory.waypoints import WaypointKind
from planning.views.photo_flight import SPEED_MPS

COORDINATE_DIGITS = 7  # about a centimetre
VERSION = 1


def approved_targets(mission: Mission) -> list[dict[str, Any]]:
    """Return the targets as approved; `geometry` is GeoJSON of the whole asset: a bridge's outline, a line's course."""
    targets = list(mission.targets.all())
    assets = {target.asset_id for target in targets if target.asset_id is not None}
    shapes = Asset.objects.filter(pk__in=assets).annotate(shape=AsGeoJSON("geometry", precision=COORDINATE_DIGITS))
    known: dict[int | None, tuple[str | None, Any]] = {
        key: (kind, json.loads(shape)) for key, kind, shape in shapes.values_list("pk", "kind", "shape")
    }
    found = []
    for target in targets:
        kind, geometry = known.get(target.asset_id, (None, None))
        found.append(
            {
                "id": target.pk,
                "sequence": target.sequence,
                "asset": target.asset_id,
                "label": target.label,
                "position": None if target.position is None else list(target.position.coords),
                "stretch": [list(end) for end in target.stretch.coords] if target.stretch else None,
                "task": target.task,
                "kind": kind,
                "geometry": geometry,
            }
        )
    return found


def content_sha256(document: Any) -> str:
    """Return the SHA-256 of the canonical form, which is the same before and after the database has stored the document."""
    text = json.dumps(_canonical(document), sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


def _canonical(value: Any) -> Any:
    """Return the value with whole floats as integers: the database keeps neither their notation nor the sign of zero."""
    if isinstance(value, dict):
        return {str(key): _canonical(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_canonical(entry) for entry in value]
    if isinstance(value, float) and value.is_integer():
        return int(value)
    return value


def approval_document(mission: Mission, *, longest_leg_m: float | None = None) -> dict[str, Any]:
    """Return the document of a planned mission, as loaded by selectors.mission_of_organisation.

    Raises Refused for routes that cannot be sent to a UAV. With `longest_leg_m` an autopilot's items get points on each longer leg.
    """
    flown = [route for route in mission.routes.all() if route.geometry is not None]
    return {
        "version": VERSION,
        "mission": {
            "id": str(mission.pk),
            "name": mission.name,
            "objective": mission.objective,
            "departs_at": moment_to_json(mission.departs_at),
            "planned_at": moment_to_json(mission.planned_at),
            "return_to_start": mission.return_to_start,
        },
        "ground": {
            "revision": ground_revision(),
            "graph_version": mission.graph_version,
            "terrain": list(terrain_dataset_version()),
            "flat_ground_assumed": mission.flat_ground_assumed,
        },
        "conditions": conditions_to_json(conditions_from_json(mission.conditions)),
        "charging_w": mission.charging_w,
        "lost_link": lost_link_to_json(lost_link_from_json(mission.lost_link)),
        "lost_link_check": mission.lost_link_check,
        "separation": mission.separation,
        "zones": _zones(flown),
        "targets": approved_targets(mission),
        "longest_leg_m": longest_leg_m,
        "routes": _routes(flown, mission, longest_leg_m),
    }


def frozen_route(route: Route, mission: Mission) -> FrozenRoute:
    """Return a stored route in plain values. Its first waypoint is above the take-off unless the route begins in the air."""
    waypoints = list(route.waypoints.all())
    first, uav = waypoints[0], route.mission_uav
    ground_m = None if first.altitude_amsl_m is None else round(first.altitude_amsl_m - first.altitude_agl_m, 2)
    take_off = TakeOff(LonLat(*first.position.coords[:2]), ground_m)
    if uav.home is not None:
        take_off = TakeOff(LonLat(*uav.home.coords[:2]), uav.home_amsl_m)
    sequence_of = {target.pk: target.sequence for target in mission.targets.all()}
    frozen = tuple(_waypoint(waypoint, sequence_of) for waypoint in waypoints)
    wished = inspection_speeds(
        [own.target for own in frozen], speeds_of_targets(mission), uav.cruise_speed_mps, begins_in_air=route.begun_by is not None
    )
    wished |= dict.fromkeys(photo_clearances_m(frozen), SPEED_MPS)
    frozen = tuple(own if own.speed_mps is not None else replace(own, speed_mps=wished.get(own.sequence)) for own in frozen)
    return FrozenRoute(
        uav=uav.name,
        take_off=take_off,
        cruise_speed_mps=uav.cruise_speed_mps,
        end_action=str(EndAction.RETURN if mission.return_to_start else EndAction(uav.end_action)),
        waypoints=frozen,
        charging_stops=tuple(stop["waypoint"] for stop in route.charging),
        departs_s=route.departs_s,
        begun_by=route.begun_by,
    )


def _waypoint(row: Waypoint, sequence_of: dict[int, int]) -> FrozenWaypoint:
    return FrozenWaypoint(
        sequence=row.sequence,
        position=LonLat(*row.position.coords[:2]),
        kind=WaypointKind(row.kind),
        altitude_agl_m=row.altitude_agl_m,
        altitude_relative_m=row.altitude_relative_m,
        altitude_amsl_m=row.altitude_amsl_m,
        task=task_from_json(row.task),
        target=None if row.target_id is None else sequence_of[row.target_id],
        speed_mps=row.speed_mps,
        arrival_s=row.arrival_s,
    )


def _routes(routes: list[Route], mission: Mission, longest_leg_m: float | None) -> list[dict[str, Any]]:
    found, reasons = [], []
    for route in routes:
        uav = route.mission_uav
        try:
            frozen = frozen_route(route, mission)
            fence = fence_of(zones_beside(route, departure_s(mission)), frozen)
            by_mavlink = uav.uav is None or uav.uav.link == LinkKind.MAVLINK
            rally = rally_items(rally_points(mission, uav.sequence))
            flights = _flights(frozen, _loads(frozen, fence.items, rally, longest_leg_m) if by_mavlink else None)
        except (CannotBeFlown, NotARoute) as error:
            values = {"uav": uav.name, "why": str(error)}
            reasons.append(RefusalReason("cannot_be_flown", _("%(uav)s cannot be given its route: %(why)s") % values, uav.sequence))
            continue
        found.append(
            {
                "place": uav.sequence,
                "uav": uav.uav_id,
                "name": uav.name,
                "is_simulated": uav.uav is not None and uav.uav.is_simulated,
                "figures": {
                    "max_range_m": uav.max_range_m, "cruise_speed_mps": uav.cruise_speed_mps, "performance": uav.performance,
                    "sorties": uav.sorties, "sensors": uav.sensors,
                },
                "length_m": route.length_m,
                "duration_s": route.duration_s,
                "energy_wh": route.energy_wh,
                "route": route_to_json(frozen),
                "flights": flights,
                "fence_left_out": [{"zone": zone.zone, "code": zone.code, "words": zone.words} for zone in fence.left_out],
            }
        )  # fmt: skip
    if reasons:
        raise Refused(reasons)
    return found


def _loads(
    route: FrozenRoute, fence: tuple[MissionItem, ...], rally: tuple[MissionItem, ...], longest_leg_m: float | None
) -> list[FlightLoad]:
    loads = flight_loads(route, fence=fence, rally=rally)
    return list(loads) if longest_leg_m is None else [with_points_between(load, longest_leg_m) for load in loads]


def _flights(route: FrozenRoute, own: list[FlightLoad] | None) -> list[dict[str, Any]]:
    """Return each flight with what it is flown from: items for an autopilot, the flight in plain values for a companion computer."""
    loads = [None] * len(route.flights) if own is None else own
    found = []
    for flight, load in zip(route.flights, loads, strict=True):
        content = flight_to_json(flight, route) if load is None else None
        found.append(
            {
                "number": flight.number + 1,
                "take_off": {"position": list(flight.take_off.position), "altitude_amsl_m": flight.take_off.altitude_amsl_m},
                "waypoints": [waypoint.sequence for waypoint in flight.waypoints],
                "items": None if load is None else load_to_json(load),
                "content": content,
                "content_sha256": content_sha256(content) if load is None else load.content_sha256,
            }
        )
    return found


def _zones(routes: list[Route]) -> list[dict[str, Any]]:
    """Return the zones beside or across the routes at any height and time, each with its limits."""
    table, margins = zone_table(), zone_margins()
    found: dict[int, dict[str, Any]] = {}
    for route in routes:
        positions = np.array([waypoint.position.coords[:2] for waypoint in route.waypoints.all()], dtype=np.float64).reshape(-1, 2)
        near, _facts = zones_near(table, positions, margins)
        found |= {int(key): _zone(near, row) for row, key in enumerate(near.ids)}
    return [found[key] for key in sorted(found)]


def _zone(table: ZoneTable, row: int) -> dict[str, Any]:
    limits = table.limits[row]
    return {
        "id": int(table.ids[row]),
        "name": table.names[row],
        "geometry_sha256": hashlib.sha256(table.wkb[row]).hexdigest(),
        "lower_limit_m": limits.lower_m,
        "lower_reference": limits.lower_reference,
        "upper_limit_m": limits.upper_m,
        "upper_reference": limits.upper_reference,
        "schedule": table.schedules[row],
        "margins": {"time_s": settings.ZONE_RULES.time_margin_s, "height_m": settings.ZONE_RULES.height_margin_m},
    }
