"""What an ArduCopter does by itself in flight, with its battery low, without GPS, in wind, after a reboot: it is seen and told."""

import math
import time

import pytest

from missions.models import Mission, MissionState
from telemetry.models import Alert, TelemetryRecord, UavLink, UavWatch
from telemetry.selectors.alert_words import alert_words
from tests.telemetry.gateway.station import gateway_at_work, port_of, wait_for
from tests.telemetry.scenarios.flights import FLIGHT_S, from_home_m, lands, take_off, wait_until_ready
from tests.telemetry.watch.program import watch_program

pytestmark = [pytest.mark.django_db(transaction=True), pytest.mark.long]
WATCHED_SPEED = 5.0  # at which alerts have time to open before the vehicle is down
SETTLED_S = 3.0  # in which an end that was seen is stored
FAR_M = 100.0  # more than a UAV may be away from where it was planned to stand
RETURNS = {"BATT_MONITOR": 4.0, "BATT_LOW_VOLT": 11.0, "BATT_LOW_TIMER": 3.0, "BATT_FS_LOW_ACT": 2.0}


def wait_until_watched(uav) -> None:
    wait_for(lambda: UavWatch.objects.filter(uav=uav).exclude(holder="").exists(), "that the watch has it")


def words_of(code: str, uav) -> str:
    alert = wait_for(lambda: Alert.objects.filter(code=code, uav=uav).order_by("-pk").first(), f"an alert {code}")
    return str(alert_words(alert.message, alert.values))


def test_a_battery_that_is_low_by_its_voltage_raises_an_alert_and_its_return_is_told(uav, mission, new_vehicle, tmp_path):
    with gateway_at_work(tmp_path) as gateway, watch_program(tmp_path, name="watch"):
        vehicle = new_vehicle(port_of(gateway), parameters=RETURNS, speed=WATCHED_SPEED)
        take_off(vehicle, uav, mission)
        wait_until_watched(uav)
        vehicle.set("SIM_BATT_VOLTAGE", 10.8)
        wait_for(lambda: UavLink.objects.filter(uav=uav, battery_state="low").exists(), "its battery is low")
        assert "low" in words_of("battery-short", uav)
        assert "Battery" in words_of("mode-changed", uav)
        lands(vehicle)


def test_a_landing_without_gps_is_told(uav, mission, new_vehicle, tmp_path):
    with gateway_at_work(tmp_path) as gateway, watch_program(tmp_path, name="watch"):
        vehicle = new_vehicle(port_of(gateway), speed=WATCHED_SPEED)
        take_off(vehicle, uav, mission)
        wait_until_watched(uav)
        wait_for(lambda: from_home_m(vehicle) > FAR_M, "that it is on its way", patience_s=FLIGHT_S)
        vehicle.set("SIM_GPS_DISABLE", 1.0)
        wait_for(lambda: UavLink.objects.filter(uav=uav, mode="LAND").exists(), "it lands")
        assert "LAND" in words_of("mode-changed", uav).upper()
        wait_for(lambda: Alert.objects.filter(code="gps", uav=uav).exists(), "an alert of GPS")
        wait_for(lambda: not vehicle.is_armed, "that it is down", patience_s=FLIGHT_S)
        assert "is on the ground" in words_of("down-off-plan", uav)
        wait_for(lambda: Mission.objects.filter(pk=mission.pk, state=MissionState.FAILED).exists(), "its mission has failed")


def test_a_mission_is_flown_in_wind_and_a_copter_without_airspeed_measures_none(uav, mission, new_vehicle, tmp_path):
    with gateway_at_work(tmp_path) as gateway:
        vehicle = new_vehicle(port_of(gateway))
        wait_until_ready(vehicle)
        vehicle.set("SIM_WIND_DIR", 270.0)
        vehicle.set("SIM_WIND_SPD", 7.0)
        take_off(vehicle, uav, mission)
        wait_for(lambda: mission.routes.get().flights_flown == 1, "the flight's end", patience_s=FLIGHT_S)
    mission.refresh_from_db()
    assert mission.state == MissionState.COMPLETED
    for north, east in TelemetryRecord.objects.filter(uav=uav).values_list("wind_north_mps", "wind_east_mps").distinct():
        assert north is None or math.hypot(north, east) > 0.0, "no calm that nobody measured"


@pytest.mark.parametrize("cause", ["reboot", "lose_power"])
def test_a_reboot_in_flight_is_no_end_of_the_flight(cause, uav, mission, new_vehicle, tmp_path):
    with gateway_at_work(tmp_path) as gateway, watch_program(tmp_path, name="watch"):
        vehicle = new_vehicle(port_of(gateway), speed=WATCHED_SPEED)
        take_off(vehicle, uav, mission)
        wait_until_watched(uav)
        getattr(vehicle, cause)()
        wait_until_ready(vehicle)
        wait_for(lambda: UavLink.objects.filter(uav=uav, is_in_air=False, is_armed=False).exists(), "that it stands")
        time.sleep(SETTLED_S)
    mission.refresh_from_db()
    assert (mission.state, mission.routes.get().flights_flown) == (MissionState.ACTIVE, 0)
