"""What messages tell, in degrees, metres and seconds; and nothing of what they cannot know."""

from math import nan, pi

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.decoding.measurement import LinkQuality, Measurement
from mavlink.decoding.report import FlownState, MeasurementDecoder, StatusText, TextCollector, is_vehicle

NOT_REPORTED = FlownState()


def position(**changed):
    reported = {
        "lat": 553_000_000,
        "lon": 101_000_000,
        "alt": 30_500,
        "relative_alt": 20_250,
        "vx": 100,
        "vy": -250,
        "vz": 5,
        "hdg": 27_512,
    }
    return mavlink.MAVLink_global_position_int_message(1_000, **(reported | changed))


def measured(*messages, at_s=0.0, flown=NOT_REPORTED, **changed) -> Measurement:
    reporter = MeasurementDecoder()
    for message in messages:
        reporter.receive(message, 0.0)
    return reporter.measurement(position(**changed), flown, at_s)


def test_a_position_alone():
    assert measured(flown=FlownState("AUTO", True, False, 3, 98.5)) == Measurement(
        longitude_deg=10.1, latitude_deg=55.3, altitude_amsl_m=30.5, altitude_relative_m=20.25, velocity_north_mps=1.0,
        velocity_east_mps=-2.5, velocity_down_mps=0.05, heading_deg=275.12, mode="AUTO", is_armed=True, is_in_air=False, mission_item=3,
        link_quality_percent=98.5,
    )  # fmt: skip


@pytest.mark.parametrize(
    "changed", [{"lat": 0, "lon": 0}, {"lat": 900_000_001}, {"lat": -(2**31)}, {"lon": 1_800_000_001}, {"lon": 2**31 - 1}]
)
def test_no_place(changed):
    reported = measured(**changed)
    assert (reported.longitude_deg, reported.latitude_deg, reported.altitude_amsl_m) == (None, None, None)
    assert reported.altitude_relative_m == 20.25


def test_the_gulf_of_guinea_is_a_place_for_who_has_a_fix():
    fix = mavlink.MAVLink_gps_raw_int_message(0, 3, 0, 0, 0, 90, 65_535, 0, 0, 14)
    reported = measured(fix, lat=0, lon=0)
    assert (reported.longitude_deg, reported.latitude_deg, reported.gps_fix, reported.hdop, reported.satellites) == (0.0, 0.0, 3, 0.9, 14)


def test_attitude_and_heading():
    attitude = mavlink.MAVLink_attitude_message(0, pi / 6, -pi / 12, -pi / 2, 0, 0, 0)
    reported = measured(attitude, hdg=65_535)
    assert (reported.roll_deg, reported.pitch_deg, reported.heading_deg) == (pytest.approx(30), pytest.approx(-15), pytest.approx(270))
    assert measured(attitude).heading_deg == 275.12
    assert measured(mavlink.MAVLink_attitude_message(0, nan, nan, nan, 0, 0, 0), hdg=65_535).roll_deg is None


def test_what_was_not_told_for_long_is_not_known():
    hud = mavlink.MAVLink_vfr_hud_message(7.5, 0, 0, 0, 0, 0)
    assert measured(hud, at_s=10.0).airspeed_mps == 7.5
    assert measured(hud, at_s=10.1).airspeed_mps is None
    assert measured(mavlink.MAVLink_vfr_hud_message(nan, 0, 0, 0, 0, 0)).airspeed_mps is None


def battery(cells, current=1_550, remaining=73, number=0):
    return mavlink.MAVLink_battery_status_message(number, 0, 0, 0, cells + [65_535] * (10 - len(cells)), current, 0, 0, remaining)


def test_batteries():
    status = mavlink.MAVLink_sys_status_message(0, 0, 0, 0, 11_900, 900, 80, 0, 0, 0, 0, 0, 0)
    unknown = mavlink.MAVLink_sys_status_message(0, 0, 0, 0, 65_535, -1, -1, 0, 0, 0, 0, 0, 0)
    reported = measured(status)
    assert (reported.battery_v, reported.battery_a, reported.battery_percent) == (11.9, 9.0, 80.0)
    reported = measured(battery([4_000, 4_100, 4_050]), status)
    assert (reported.battery_v, reported.battery_a, reported.battery_percent) == (12.15, 15.5, 73.0)
    assert measured(battery([65_534, 10_000])).battery_v == pytest.approx(75.534)
    assert measured(battery([4_000], number=1)).battery_v is None
    reported = measured(unknown)
    assert (reported.battery_v, reported.battery_a, reported.battery_percent) == (None, None, None)
    assert measured(battery([], -1, -1), status).battery_v == 11.9, "what one does not know the other may"


def test_wind_goes_where_the_air_moves():
    north_wind = mavlink.MAVLink_wind_message(0.0, 5.0, 0.0)
    assert measured(north_wind).wind_north_mps == pytest.approx(-5.0)
    px4 = mavlink.MAVLink_wind_cov_message(0, -5.0, 1.0, 0, 0, 0, 0, 0, 0)
    assert (measured(px4).wind_north_mps, measured(px4).wind_east_mps) == (-5.0, 1.0)
    assert measured(mavlink.MAVLink_wind_message(nan, 5.0, 0.0)).wind_north_mps is None


@pytest.mark.parametrize("from_deg", [0.0, -180.0, 180.0])
def test_wind_of_exactly_nothing_is_no_measured_calm(from_deg):
    """ArduCopter without an airspeed sensor or an estimate, in whatever wind: 4.6.0-dev says that it comes from -180 degrees."""
    assert measured(mavlink.MAVLink_wind_message(from_deg, 0.0, 0.0)).wind_north_mps is None
    assert measured(mavlink.MAVLink_wind_message(from_deg, 0.01, 0.0)).wind_north_mps == pytest.approx(0.0, abs=0.011)


def heartbeat(kind, autopilot):
    return mavlink.MAVLink_heartbeat_message(kind, autopilot, 0, 0, 0, 3)


def test_only_what_flies_is_a_vehicle():
    assert is_vehicle(heartbeat(mavlink.MAV_TYPE_QUADROTOR, mavlink.MAV_AUTOPILOT_PX4))
    assert is_vehicle(heartbeat(mavlink.MAV_TYPE_FIXED_WING, mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA))
    assert not is_vehicle(heartbeat(mavlink.MAV_TYPE_GCS, mavlink.MAV_AUTOPILOT_INVALID))
    assert not is_vehicle(heartbeat(mavlink.MAV_TYPE_GCS, mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA))
    assert not is_vehicle(heartbeat(mavlink.MAV_TYPE_CAMERA, mavlink.MAV_AUTOPILOT_INVALID))


def text(words, number=0, piece=0):
    return mavlink.MAVLink_statustext_message(4, words.encode(), number, piece)


def test_texts():
    collector = TextCollector()
    assert collector.receive(text("Armed\x07"), 1.0) == [StatusText(4, "Armed ", 1.0)]
    long = "x" * 50 + "y" * 50 + "end"
    assert collector.receive(text(long[:50], 7, 0), 1.0) == []
    assert collector.receive(text(long[100:], 7, 2), 1.1) == []
    assert collector.receive(text(long[50:100], 7, 1), 1.2) == [StatusText(4, long, 1.0)]
    assert collector.tick(100.0) == []


def test_a_text_that_lacks_a_piece_is_told_with_a_gap():
    collector = TextCollector()
    collector.receive(text("a" * 50, 7, 0), 1.0)
    collector.receive(text("end", 7, 2), 1.0)
    assert collector.tick(3.9) == []
    assert collector.tick(4.1) == [StatusText(4, "a" * 50 + "…end", 1.0)]


def test_unfinished_texts_are_bounded():
    collector, reported = TextCollector(), []
    for number in range(1, 1_000):
        reported += collector.receive(text("a" * 50, number % 65_536, 200), 1.0)
    assert len(reported) >= 990 and all(len(status.text) <= 500 for status in reported)


def test_link_quality_by_the_numbers_of_frames():
    quality = LinkQuality()
    assert quality.percent(0.0) is None
    for number in range(1_000):
        quality.count(1, number % 256)
    assert quality.percent(0.0) == 100.0
    for number in range(1_000, 3_000):
        if number % 4:
            quality.count(1, number % 256)
            quality.count(1, number % 256)  # a doubled one counts once
    assert quality.percent(0.0) == pytest.approx(75.0, abs=2)
    quality.receive_radio(mavlink.MAVLink_radio_status_message(127, 200, 0, 0, 0, 0, 0), 5.0)
    assert quality.percent(6.0) == 50.0
    assert quality.percent(16.0) == pytest.approx(75.0, abs=2)
