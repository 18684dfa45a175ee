"""Two ArduCopters fly one mission at the same time, and keep the distance that was planned."""

import time

import pytest
from django.conf import settings

from inspection.geodesy.wgs84 import short_distance_m
from missions.models import CommandState, MissionState
from missions.services.dispatch import dispatch_mission
from tests.missions.flights import approved
from tests.missions.worlds import UAV_AT
from tests.sitl.firmware import Firmware
from tests.sitl.flights import FLIGHT_S, wait_until_ready
from tests.telemetry.gateway.station import gateway_at_work, port_of, unsigned_uav
from tests.telemetry.gateway.test_commands import begin, ended
from tests.workspace.people import somebody

pytestmark = pytest.mark.django_db(transaction=True)
LOOK_S = 0.05
APART_DEG = 0.004  # of longitude, as the plan has them


def is_apart(one: Firmware, other: Firmware) -> bool:
    rules = settings.SEPARATION_RULES
    aside_m = short_distance_m(*one.place, *other.place)
    return aside_m >= rules.lateral_m or abs(one.height_m - other.height_m) >= rules.vertical_m


def test_two_uavs_of_one_mission_are_flown_to_its_end_apart(uav, region, firmware, tmp_path):
    uavs = [uav, unsigned_uav(8, is_simulated=True)]
    mission, approval = approved(somebody(), uavs, region.towers[:2])
    with gateway_at_work(tmp_path) as gateway:
        port = port_of(gateway)
        vehicles = [firmware(port), firmware(port, system=8, at=(UAV_AT.lon + APART_DEG, UAV_AT.lat))]
        for vehicle in vehicles:
            wait_until_ready(vehicle)
        for upload in dispatch_mission(mission=mission, actor=mission.author):
            assert ended(upload).state == CommandState.APPLIED, upload.outcome
        for one in uavs:
            start = ended(begin(one, mission, approval))
            assert start.state == CommandState.APPLIED, start.outcome
        until_s, flew_together = time.monotonic() + FLIGHT_S, False
        while mission.routes.filter(flights_flown=1).count() < len(uavs):
            assert time.monotonic() < until_s, "not flown to its end"
            if all(vehicle.is_armed for vehicle in vehicles):
                flew_together = True
                assert is_apart(*vehicles)
            time.sleep(LOOK_S)
    mission.refresh_from_db()
    assert flew_together and mission.state == MissionState.COMPLETED
