"""Missions for a live benchmark, in a database of their own: lines of towers side by side, a UAV along each, ten UAVs a mission."""

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from uuid import UUID

import numpy as np
from django.contrib.gis.geos import Point
from django.db import connection

from inspection.models import Asset
from inspection.services import import_terrain
from mavlink.approved_route import route_from_json
from missions.models import Mission, MissionState, Uav
from missions.services import TargetRequest, create_mission, plan_mission
from missions.services.approval.approval import approve_mission
from planning.request import EndAction
from telemetry.models import UavLink
from tests.inspection import ground
from tests.inspection.importers.terrain.tiffs import write_geotiff
from tests.missions import worlds
from tests.workspace.live.proxied_site import environment_of
from workspace.models import Organisation, User

UAVS_A_MISSION = 10
FIRST_SYSTEM = 2
MAX_UAVS = 250
WEST_DEG, SOUTH_DEG = 10.0, 55.0
LINE_EVERY_DEG, MISSION_EVERY_DEG = 0.06, 0.02  # lines of a mission lie in a row, rows one above the other
TOWER_EVERY_DEG, TOWERS = 0.004, 12
SPEED_MPS = 6.4  # a ten-millionth degree eastwards each millisecond
TARGETS = (2, 4, 6)  # towers that each UAV looks at
GROUND_M = 100.0
OF_A_RUN = (
    "telemetry_telemetryrecord", "telemetry_positionestimate", "telemetry_uavwatch", "telemetry_uavlink", "telemetry_alertnote",
    "telemetry_alert",
)  # fmt: skip


@dataclass(frozen=True)
class Line:
    """What a UAV flies along, to the east: heights above take-off [m] by longitude [deg], as approved."""

    uav_id: int
    system: int
    lon: float
    lat: float
    heights_m: tuple[tuple[float, ...], tuple[float, ...]]
    approval: UUID
    sha256: str  # of its flight, as it is read back from the UAV


@contextmanager
def own_database() -> Iterator[None]:
    """For this process and those that it starts."""
    before = os.environ.get("DATABASE_URL")
    name = connection.settings_dict["NAME"]
    connection.creation.create_test_db(verbosity=0, autoclobber=True, serialize=False)
    os.environ["DATABASE_URL"] = environment_of(Path("/"))["DATABASE_URL"]
    try:
        yield
    finally:
        connection.creation.destroy_test_db(name, verbosity=0)
        if before is None:
            del os.environ["DATABASE_URL"]
        else:
            os.environ["DATABASE_URL"] = before


def make_site(uavs: int) -> tuple[User, list[Line]]:
    """As many approved missions as the UAVs need, none of them under way."""
    organisation = Organisation.objects.get_or_create(name="Live pages' benchmark")[0]
    user = User.objects.create_user("live-benchmark", organisation=organisation)
    missions = -(-uavs // UAVS_A_MISSION)
    _make_ground(missions)
    lines: list[Line] = []
    for row in range(missions):
        lines += _make_mission(row, user)
    return user, lines[:uavs]


def _make_ground(missions: int) -> None:
    rows, columns = missions * 20 + 40, round(UAVS_A_MISSION * LINE_EVERY_DEG * 1_000) + 40
    north = SOUTH_DEG + missions * MISSION_EVERY_DEG + 0.02
    with TemporaryDirectory() as folder:
        heights = np.full((rows, columns), GROUND_M, dtype="f4")
        import_terrain(path=write_geotiff(Path(folder) / "ground.tif", heights, srid=9707, origin=(WEST_DEG - 0.02, north)))
    for row in range(missions):
        for column in range(UAVS_A_MISSION):
            worlds.power_line([ground.tower(place) for place in _towers(row, column)], voltages_v=[110_000])
    worlds.rebuild()


def _towers(row: int, column: int) -> list[tuple[float, float]]:
    west = WEST_DEG + column * LINE_EVERY_DEG
    return [(west + number * TOWER_EVERY_DEG, SOUTH_DEG + row * MISSION_EVERY_DEG) for number in range(TOWERS)]


def _make_mission(row: int, user: User) -> list[Line]:
    uavs, targets = [], []
    for column in range(UAVS_A_MISSION):
        towers = _towers(row, column)
        system = FIRST_SYSTEM + row * UAVS_A_MISSION + column
        uav = Uav.objects.create(
            organisation=user.organisation, name=f"UAV {system:03}", location=Point(*towers[0], srid=4326), mavlink_system_id=system,
            allows_unsigned=True, is_simulated=True, cruise_speed_mps=SPEED_MPS,
        )  # fmt: skip
        asked = worlds.uav(towers[0], name=uav.name, end_action=EndAction.HOVER, uav=uav.pk, most_targets=len(TARGETS))
        uavs.append((uav, replace(asked, cruise_speed_mps=SPEED_MPS)))
        targets += [_target(towers[number]) for number in TARGETS]
    request = worlds.request(*targets, uavs=tuple(asked for _, asked in uavs))
    draft = create_mission(organisation=user.organisation, author=user, name=f"Row {row + 1}", request=request)
    mission = plan_mission(mission=draft, actor=user)
    approval = approve_mission(mission=mission, actor=user)
    approved = {route["uav"]: route for route in approval.document["routes"]}
    routes = {uav_id: route_from_json(route["route"]) for uav_id, route in approved.items()}
    if len(routes) < UAVS_A_MISSION:
        raise SystemExit(f"row {row}: only {len(routes)} UAVs fly")
    return [
        Line(
            uav_id=uav.pk,
            system=uav.mavlink_system_id,
            lon=asked.position.lon,
            lat=asked.position.lat,
            heights_m=(
                tuple(waypoint.position.lon for waypoint in routes[uav.pk].waypoints),
                tuple(waypoint.altitude_relative_m for waypoint in routes[uav.pk].waypoints),
            ),
            approval=approval.pk,
            sha256=approved[uav.pk]["flights"][0]["content_sha256"],
        )
        for uav, asked in uavs
    ]


def _target(place: tuple[float, float]) -> TargetRequest:
    return TargetRequest(Asset.objects.get(kind="tower", centre=Point(*place, srid=4326)).pk)


def put_under_way(lines: Sequence[Line]) -> None:
    """Their missions, and no others: nothing is left of an earlier run."""
    with connection.cursor() as cursor:
        cursor.execute(f"TRUNCATE {', '.join(OF_A_RUN)} CASCADE")  # names of tables, all from here
    Mission.objects.update(state=MissionState.APPROVED, started_at=None, ended_at=None)
    Mission.objects.filter(routes__mission_uav__uav__in=[line.uav_id for line in lines]).update(state=MissionState.ACTIVE)
    UavLink.objects.bulk_create(
        UavLink(uav_id=line.uav_id, autopilot="px4", loaded_approval=line.approval, loaded_flight=1, loaded_sha256=line.sha256)
        for line in lines
    )
