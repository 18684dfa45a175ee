"""Reads of missions and UAVs, always within one organisation."""

from uuid import UUID

import numpy as np
from django.contrib.gis.db.models import Extent
from django.db.models import Count, Max, Prefetch, Q, QuerySet

from inspection.models import Asset
from inspection.selectors import UNREAD_OF_A_LINE, ground_heights_m, ground_revision, zones_in_force
from missions.flight_plan.clearance import legs_that_meet
from missions.models import InspectionTarget, Mission, MissionState, MissionUav, Route, Uav, Waypoint
from workspace.models import AuditEntry, Organisation

TERRAIN_CHANGED_M = 1.0  # less is another sampling of the same ground
SKETCH_TOLERANCE_DEG = 0.0005  # about 50 m: less than a pixel of the list's drawing


def uavs_of_organisation(organisation: Organisation, *, text: str = "") -> QuerySet[Uav]:
    uavs = Uav.objects.filter(organisation=organisation)
    return uavs.filter(Q(name__icontains=text) | Q(base_name__icontains=text)) if text else uavs


def missions_of_organisation(organisation: Organisation, *, text: str = "", state: str = "", deleted: bool = False) -> QuerySet[Mission]:
    """Missions with what the list shows of each: counts, duration and routes."""
    missions = Mission.objects.filter(organisation=organisation, deleted_at__isnull=not deleted)
    if text:
        missions = missions.filter(Q(name__icontains=text) | Q(author__username__icontains=text))
    if state:
        missions = missions.filter(state=state)
    return (
        missions.select_related("author")
        .annotate(
            target_count=Count("targets", distinct=True),
            unassigned_count=Count("targets", filter=~Q(targets__unassigned_reason=""), distinct=True),
            uav_count=Count("mission_uavs", distinct=True),
            duration_s=Max("routes__duration_s"),
        )
        .prefetch_related("routes")
    )


def mission_of_organisation(organisation: Organisation, mission_id: UUID, *, deleted: bool = False) -> Mission:
    """One mission with all that belongs to it. Raises Mission.DoesNotExist also for another organisation's mission."""
    routes = Route.objects.select_related("mission_uav").prefetch_related(Prefetch("waypoints", Waypoint.objects.order_by("sequence")))
    unread = {"geometry", "tags", "node_osm_ids", "parts"} | UNREAD_OF_A_LINE
    targets = InspectionTarget.objects.select_related("asset__line").defer(*(f"asset__{name}" for name in unread))
    return (
        Mission.objects.filter(organisation=organisation, deleted_at__isnull=not deleted)
        .select_related("author", "organisation")
        .prefetch_related("mission_uavs", Prefetch("targets", targets), Prefetch("routes", routes))
        .get(pk=mission_id)
    )


def history_of_mission(mission: Mission) -> QuerySet[AuditEntry]:
    return AuditEntry.objects.filter(organisation=mission.organisation, subject_type="mission", subject_id=str(mission.pk)).select_related(
        "actor"
    )


def is_stale(mission: Mission, revision: int) -> bool:
    """Whether assets, zones or terrain have changed since the mission was planned; `revision` is the ground's now."""
    return mission.state != MissionState.DRAFT and mission.ground_revision != revision


def stale_reason(mission: Mission) -> str:
    """What the change of the ground means for the mission, the worst first; empty if the ground is as it was."""
    if not is_stale(mission, ground_revision()):
        return ""
    zones = zones_in_force()
    for route in mission.routes.all():
        if route.geometry is None:
            continue
        met = legs_that_meet(np.array(route.geometry.coords), list(zones.polygons))
        if met:
            return f"A zone changed since this was planned. {zones.names[met[0][1]]} touches the route of {route.mission_uav.name}."
    vanished = [target.label for target in mission.targets.all() if target.asset is not None and target.asset.vanished_at is not None]
    if vanished:
        return f"An asset changed since this was planned. {vanished[0]} is no longer in the data."
    if Asset.objects.filter(vanished_at__isnull=False, pk__in=_passed_assets(mission)).exists():
        return "An asset changed since this was planned. A route passes something that is no longer in the data."
    if reason := _terrain_reason(mission):
        return reason
    return "The ground has changed since this was planned. No zone in force touches the routes."


def _terrain_reason(mission: Mission) -> str:
    """Whether the ground under the waypoints is another one than the routes were planned over; its height then is AMSL less AGL."""
    waypoints = [(route, waypoint) for route in mission.routes.all() for waypoint in route.waypoints.all()]
    if not waypoints:
        return ""
    now_m = ground_heights_m(np.array([waypoint.position.coords for _, waypoint in waypoints]))
    then_m = np.array([
        np.nan if waypoint.altitude_amsl_m is None else waypoint.altitude_amsl_m - waypoint.altitude_agl_m for _, waypoint in waypoints
    ])  # fmt: skip
    off_m = np.abs(now_m - then_m)
    if (off_m > TERRAIN_CHANGED_M).any():
        worst = int(np.nanargmax(off_m))
        name = waypoints[worst][0].mission_uav.name
        return f"The terrain changed since this was planned. Under the route of {name} it differs by up to {off_m[worst]:.0f} m."
    if (~np.isnan(then_m) & np.isnan(now_m)).any():
        return "The terrain changed since this was planned. Under a route it is no longer known."
    for route in mission.routes.all():
        under = [height for (own, _), height in zip(waypoints, now_m.tolist(), strict=True) if own is route]
        if under and not np.isnan(under).any() and route.waypoints.all()[0].altitude_amsl_m is None:
            return f"Terrain came in since this was planned: {route.mission_uav.name} flies as over flat ground."
    return ""


def _passed_assets(mission: Mission) -> set[int]:
    return {waypoint.asset_id for route in mission.routes.all() for waypoint in route.waypoints.all() if waypoint.asset_id is not None}


def mission_bounds(mission_id: UUID) -> tuple[float, float, float, float] | None:
    """West, south, east, north of what a mission's map shows first: targets and routes, or without routes the places where UAVs stand."""
    targets = InspectionTarget.objects.filter(mission=mission_id).order_by()
    of_targets = targets.aggregate(
        points=Extent("position"), stretches=Extent("stretch"), assets=Extent("asset__centre", filter=Q(position=None, stretch=None))
    )
    routes = Route.objects.filter(mission=mission_id).order_by().aggregate(extent=Extent("geometry"))["extent"]
    starts = None if routes else MissionUav.objects.filter(mission=mission_id).order_by().aggregate(extent=Extent("start"))["extent"]
    boxes = [box for box in (*of_targets.values(), routes, starts) if box]
    if not boxes:
        return None
    west, south, east, north = zip(*boxes, strict=True)
    return min(west), min(south), max(east), max(north)


def sketch(mission: Mission) -> list[list[list[float]]]:
    """The routes, simplified for a drawing the size of a stamp; an empty one for a UAV on the ground, which keeps its letter and colour."""
    return [_simplified(route) for route in mission.routes.all()]


def _simplified(route: Route) -> list[list[float]]:
    if route.geometry is None:
        return []
    line = route.geometry.simplify(SKETCH_TOLERANCE_DEG).coords
    return [[round(lon, 5), round(lat, 5)] for lon, lat in line] if len(line) > 1 else []
