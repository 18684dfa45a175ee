"""Two ArduCopters fly one mission at the same time, and keep the distance that was planned."""

import math
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import pytest
from django.conf import settings

from inspection.geodesy.wgs84 import short_distance_m
from inspection.models import Asset
from missions.models import CommandKind, CommandState, Mission, MissionState, Uav
from missions.services import create_mission, plan_mission
from missions.services.approval.approval import approve_mission
from missions.services.commands.commands import queue_command
from missions.services.commands.dispatch import dispatch_mission
from planning.request import EndAction
from telemetry.alerting.detectors.converging import CODE
from telemetry.models import Alert
from tests.accounts.users import a_user
from tests.missions import worlds
from tests.missions.flights import approved
from tests.missions.worlds import UAV_AT
from tests.telemetry.gateway.commands.test_commands import ended
from tests.telemetry.gateway.station import gateway_at_work, port_of, unsigned_uav
from tests.telemetry.scenarios.flights import FLIGHT_S, wait_until_ready
from tests.telemetry.scenarios.vehicle import ScenarioVehicle
from tests.telemetry.watch.program import watch_program

pytestmark = [pytest.mark.django_db(transaction=True), pytest.mark.long]
LOOK_S = 0.05
CROSSING_SPEED, CONFLICT_SPEED = 4.0, 2.0
REPORTED_BEFORE_S = 12.0  # of the 20 s that the alert looks ahead; the watch looks each second, which is 2 s of the UAVs
PASSED_S = 8.0
APART_DEG = 0.004  # of longitude, as the plan has them


def is_apart(one: ScenarioVehicle, other: ScenarioVehicle) -> bool:
    rules = settings.SEPARATION_RULES
    aside_m = short_distance_m(*one.place, *other.place)
    return aside_m >= rules.lateral_m or abs(one.height_m - other.height_m) >= rules.vertical_m


@pytest.fixture
def uavs(uav) -> list[Uav]:
    return [uav, unsigned_uav(8, is_simulated=True)]


@pytest.fixture
def crossing(uavs, region) -> Mission:
    """The routes cross, and are kept apart by their heights: both start at once."""
    mission, _approval = approved(a_user(), uavs, region.towers[4:6])
    assert set(mission.routes.values_list("departs_s", flat=True)) == {0.0}
    return mission


def alone(uav: Uav, tower: Asset, east_deg: float) -> Mission:
    """A mission of one UAV, approved."""
    author = a_user()
    at = worlds.uav((UAV_AT.lon + east_deg, UAV_AT.lat), name=uav.name, end_action=EndAction.RETURN)
    request = worlds.request(tower, uavs=(replace(at, uav=uav.pk),))
    draft = create_mission(organisation=author.organisation, author=author, name=f"To {tower.pk}", request=request)
    mission = plan_mission(mission=draft, actor=author)
    approve_mission(mission=mission, actor=author)
    mission.refresh_from_db()
    return mission


@contextmanager
def two_ready(missions: Sequence[Mission], new_vehicle, log_dir: Path, *, speed: float) -> Iterator[list[ScenarioVehicle]]:
    """At their places, with their routes on board."""
    with gateway_at_work(log_dir) as gateway:
        port = port_of(gateway)
        vehicles = [new_vehicle(port, speed=speed), new_vehicle(port, system=8, at=(UAV_AT.lon + APART_DEG, UAV_AT.lat), speed=speed)]
        for vehicle in vehicles:
            wait_until_ready(vehicle)
        for mission in missions:
            for upload in dispatch_mission(mission=mission, actor=mission.author):
                assert ended(upload).state == CommandState.APPLIED, upload.outcome
        yield vehicles


def start(uav: Uav, mission: Mission) -> None:
    """Whatever its slot is by our clock, which the vehicles' is faster than."""
    parameters = {"flight": 1, "out_of_slot": True}
    command = queue_command(
        uav=uav, kind=CommandKind.START, actor=None, mission=mission, approval=mission.approvals.get(), parameters=parameters
    )
    assert ended(command).state == CommandState.APPLIED, command.outcome


def fly_apart(mission: Mission, vehicles: list[ScenarioVehicle]) -> None:
    """To the end of both routes."""
    until_s, flew_together = time.monotonic() + FLIGHT_S, False
    while mission.routes.filter(flights_flown=1).count() < len(vehicles):
        assert time.monotonic() < until_s, "not flown to its end"
        if all(vehicle.is_armed for vehicle in vehicles):
            flew_together = True
            assert is_apart(*vehicles)
        time.sleep(LOOK_S)
    mission.refresh_from_db()
    assert flew_together and mission.state == MissionState.COMPLETED


def test_two_uavs_of_one_mission_are_flown_to_its_end_apart(uavs, region, new_vehicle, tmp_path):
    mission, _approval = approved(a_user(), uavs, region.towers[:2])
    with two_ready([mission], new_vehicle, tmp_path, speed=5.0) as vehicles:
        for uav in uavs:
            start(uav, mission)
        fly_apart(mission, vehicles)


def test_routes_that_cross_in_layers_alarm_nobody(uavs, crossing, new_vehicle, tmp_path):
    with two_ready([crossing], new_vehicle, tmp_path, speed=CROSSING_SPEED) as vehicles, watch_program(tmp_path, name="watch"):
        for uav in uavs:
            start(uav, crossing)
        fly_apart(crossing, vehicles)
    assert not Alert.objects.filter(code=CODE, level="critical").exists()


def test_two_missions_begun_together_that_meet_are_told_in_time(uavs, region, new_vehicle, tmp_path):
    """Each is planned alone, so nothing keeps them apart: the one is on its way back while the other comes out, at the same height."""
    missions = [
        alone(uav, tower, east_deg)
        for uav, tower, east_deg in zip(uavs, (region.towers[5], region.towers[4]), (0.0, APART_DEG), strict=True)
    ]
    with two_ready(missions, new_vehicle, tmp_path, speed=CONFLICT_SPEED) as vehicles, watch_program(tmp_path, name="watch"):
        for uav, mission in zip(uavs, missions, strict=True):
            start(uav, mission)
        began_s, reported_s, nearest_s, nearest_m = time.monotonic(), None, 0.0, math.inf
        while reported_s is None or time.monotonic() < nearest_s + PASSED_S:
            assert time.monotonic() < began_s + FLIGHT_S, "they did not meet"
            apart_m = math.hypot(short_distance_m(*vehicles[0].place, *vehicles[1].place), vehicles[0].height_m - vehicles[1].height_m)
            if apart_m < nearest_m:
                nearest_m, nearest_s = apart_m, time.monotonic()
            if reported_s is None and Alert.objects.filter(code=CODE, uav__in=uavs).exists():
                reported_s = time.monotonic()
            time.sleep(LOOK_S)
    assert nearest_m < settings.SEPARATION_RULES.vertical_m  # they did meet
    assert (nearest_s - reported_s) * CONFLICT_SPEED >= REPORTED_BEFORE_S
    assert Alert.objects.filter(code=CODE, uav__in=uavs, level="critical").exists()  # from 12 s before on
