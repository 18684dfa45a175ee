"""A stored route in plain values, against which an edit is checked several times a second while it is dragged."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple
from uuid import UUID

from inspection.geodesy import LonLat
from inspection.selectors.planning import DatasetVersion
from missions.models import Mission, Waypoint
from missions.services.missions import request_of_mission
from planning.request import PlanRequest
from planning.task import Task, task_from_json
from planning.trajectory.waypoints import WaypointKind

MAX_KEPT = 32  # routes in a process


class KeptAsset(NamedTuple):
    """The asset of a waypoint; height_m as tagged."""

    key: int
    kind: str
    subtype: str
    height_m: float | None
    max_voltage_v: int | None


@dataclass(frozen=True)
class KeptWaypoint:
    """A stored waypoint. target: its place in the mission; stretch: of the target, if any. speed_mps: over ground, if set manually."""

    position: LonLat
    altitude_agl_m: float
    kind: WaypointKind
    asset: KeptAsset | None
    target: int | None
    stretch: tuple[LonLat, ...] | None
    task: Task | None
    speed_mps: float | None
    is_by_hand: bool


@dataclass(frozen=True, eq=False)
class KeptRoute:
    """A stored route. request: of the whole mission with all its UAVs."""

    departs_s: float
    waypoints: tuple[KeptWaypoint, ...]
    request: PlanRequest


class _ChangedMeanwhile(Exception):
    """Raised when the rows that were read may be of another revision."""


def kept_route(mission: Mission, uav: int, dataset_version: DatasetVersion) -> KeptRoute | None:
    """Return the route of a UAV, by its place in the mission; None where it has none. Cached per revision and dataset version."""
    try:
        return _kept(mission.pk, mission.revision, uav, dataset_version)
    except _ChangedMeanwhile:
        return _read(mission, uav)


def kept_waypoints(rows: Iterable[Waypoint]) -> tuple[KeptWaypoint, ...]:
    """Return the waypoints in plain values. rows: with their assets and targets."""
    return tuple(
        KeptWaypoint(
            LonLat(*row.position.coords),
            row.altitude_agl_m,
            WaypointKind(row.kind),
            None
            if row.asset is None
            else KeptAsset(row.asset.pk, row.asset.kind, row.asset.subtype, row.asset.height_m, row.asset.max_voltage_v),
            None if row.target is None else row.target.sequence,
            None if row.target is None or row.target.stretch is None else tuple(LonLat(*vertex) for vertex in row.target.stretch.coords),
            task_from_json(row.task),
            row.speed_mps,
            row.is_by_hand,
        )
        for row in rows
    )


@lru_cache(maxsize=MAX_KEPT)
def _kept(mission_id: UUID, revision: int, uav: int, dataset_version: DatasetVersion) -> KeptRoute | None:
    mission = Mission.objects.get(pk=mission_id)
    found = _read(mission, uav)
    if Mission.objects.values_list("revision", flat=True).get(pk=mission_id) != revision or mission.revision != revision:
        raise _ChangedMeanwhile
    return found


def _read(mission: Mission, uav: int) -> KeptRoute | None:
    route = mission.routes.filter(mission_uav__sequence=uav, geometry__isnull=False).first()
    if route is None:
        return None
    rows = route.waypoints.select_related("asset", "target").defer("asset__geometry", "asset__centre", "asset__tags")
    return KeptRoute(route.departs_s, kept_waypoints(rows), request_of_mission(mission=mission))
