"""Two ArduCopters fly one mission at the same time, and keep the distance that was planned."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from django.conf import settings

from inspection.geodesy.wgs84 import short_distance_m
from missions.models import CommandKind, CommandState, Mission, MissionState, Uav
from missions.services.commands import queue_command
from missions.services.dispatch import dispatch_mission
from telemetry.models import Alert
from tests.missions.flights import approved
from tests.missions.worlds import UAV_AT
from tests.telemetry.gateway.station import gateway_at_work, port_of, unsigned_uav
from tests.telemetry.gateway.test_commands import ended
from tests.telemetry.scenarios.flights import FLIGHT_S, wait_until_ready
from tests.telemetry.scenarios.vehicle import ScenarioVehicle
from tests.telemetry.watch.program import watch_program
from tests.workspace.people import somebody

pytestmark = [pytest.mark.django_db(transaction=True), pytest.mark.long]
LOOK_S = 0.05
CROSSING_PACE = 4.0
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
    """The routes cross, and are kept apart by the times at which they start."""
    return approved(somebody(), uavs, region.towers[4:6])[0]


@contextmanager
def two_ready(mission: Mission, new_vehicle, log_dir: Path, *, speed: float) -> Iterator[list[ScenarioVehicle]]:
    """At their places, with their routes on board."""
    with gateway_at_work(log_dir) as gateway:
        port = port_of(gateway)
        vehicles = [new_vehicle(port, speed=speed), new_vehicle(port, system=8, at=(UAV_AT.lon + APART_DEG, UAV_AT.lat), speed=speed)]
        for vehicle in vehicles:
            wait_until_ready(vehicle)
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


def fly_apart(mission: Mission, vehicles: list[ScenarioVehicle], starts: Iterator[None]) -> None:
    """To the end of both routes."""
    until_s, flew_together = time.monotonic() + FLIGHT_S, False
    while mission.routes.filter(flights_flown=1).count() < len(vehicles):
        assert time.monotonic() < until_s, "not flown to its end"
        next(starts, None)
        if all(vehicle.is_armed for vehicle in vehicles):
            flew_together = True
            assert is_apart(*vehicles)
        time.sleep(LOOK_S)
    mission.refresh_from_db()
    assert flew_together and mission.state == MissionState.COMPLETED


def test_two_uavs_of_one_mission_are_flown_to_its_end_apart(uavs, region, new_vehicle, tmp_path):
    mission, _approval = approved(somebody(), uavs, region.towers[:2])
    with two_ready(mission, new_vehicle, tmp_path, speed=5.0) as vehicles:
        for uav in uavs:
            start(uav, mission)
        fly_apart(mission, vehicles, iter(()))


def test_routes_that_cross_are_flown_apart_at_their_times(uavs, crossing, new_vehicle, tmp_path):
    delays_s = dict(crossing.routes.values_list("mission_uav__uav", "departs_s"))
    earlier, later = sorted(uavs, key=lambda uav: delays_s[uav.pk])

    def when_it_is_time() -> Iterator[None]:
        began_s = time.monotonic()
        while (time.monotonic() - began_s) * CROSSING_PACE < delays_s[later.pk] - delays_s[earlier.pk]:
            yield
        start(later, crossing)

    with two_ready(crossing, new_vehicle, tmp_path, speed=CROSSING_PACE) as vehicles, watch_program(tmp_path, name="watch"):
        start(earlier, crossing)
        fly_apart(crossing, vehicles, when_it_is_time())
    assert not Alert.objects.filter(code="converging", level="critical").exists()
