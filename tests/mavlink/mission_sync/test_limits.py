"""What a vehicle's limits mean for a mission."""

import math

import numpy as np
import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from inspection.geodesy import LonLat, path_length_m
from mavlink.autopilot_type import AutopilotType
from mavlink.legs import with_points_between
from mavlink.mission_sync.limits import count_warnings, leg_warnings, too_many
from mavlink.vehicle_plan import FlightLoad, MissionItem
from tests.telemetry.vehicles.loads import load, mission, polygon

START = LonLat(9.8, 55.4)


def legs(*east_m: float) -> FlightLoad:
    """A take-off and waypoints eastwards, 60 m up, with a speed in between, and a landing at the last."""
    degree_m = path_length_m(np.array([(9.8, 55.4), (9.801, 55.4)])) * 1_000
    places = [round((9.8 + metres / degree_m) * 1e7) for metres in east_m]

    def item(command: int, longitude_e7: int, altitude_m: float = 60.0) -> MissionItem:
        return MissionItem(
            command, mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT, (0.0, 0.0, 0.0, math.nan), longitude_e7, 554_000_000, altitude_m
        )

    speed = MissionItem(mavlink.MAV_CMD_DO_CHANGE_SPEED, mavlink.MAV_FRAME_MISSION, (1.0, 5.0, -1.0, 0.0))
    flown = [item(mavlink.MAV_CMD_NAV_WAYPOINT, place) for place in places[1:]]
    return FlightLoad((item(mavlink.MAV_CMD_NAV_TAKEOFF, places[0]), speed, *flown, item(mavlink.MAV_CMD_NAV_LAND, places[-1], 0.0)))


def test_legs_and_a_start_beyond_px4s_limits_are_told():
    warnings = leg_warnings(legs(0, 500, 3_500), {"MIS_DIST_1WP": 900.0, "MIS_DIST_WPS": 900.0}, LonLat(9.82, 55.4))
    assert [(warning.code, warning.item) for warning in warnings] == [("far-first-waypoint", 0), ("long-leg", 3)]
    assert "2990 m" in str(warnings[1].reason)


def test_legs_are_measured_on_px4s_sphere():
    """Of one degree northwards at the equator it makes 111,195 m; on the ellipsoid it is 110,574 m."""
    items = [
        MissionItem(command, mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT, (0.0, 0.0, 0.0, math.nan), 0, latitude_e7, 60.0)
        for command, latitude_e7 in ((mavlink.MAV_CMD_NAV_TAKEOFF, 0), (mavlink.MAV_CMD_NAV_WAYPOINT, 10_000_000))
    ]
    load = FlightLoad(tuple(items))
    assert leg_warnings(load, {"MIS_DIST_WPS": 111_196.0}, None) == ()
    (reported,) = leg_warnings(load, {"MIS_DIST_WPS": 110_700.0}, None)
    assert "111195 m" in str(reported.reason)
    assert leg_warnings(with_points_between(load, 900.0), {"MIS_DIST_WPS": 900.0}, None) == ()


@pytest.mark.parametrize("parameters", [{}, {"MIS_DIST_1WP": 0.0, "MIS_DIST_WPS": -1.0}])
def test_vehicle_without_limits_is_not_warned_of(parameters: dict[str, float]):
    assert leg_warnings(legs(0, 5_000), parameters, START) == ()


def test_list_that_is_too_long_for_its_flavour_is_told():
    assert too_many(load(649), AutopilotType.ARDUPILOT) is None
    reported = too_many(load(650), AutopilotType.ARDUPILOT)
    assert reported is not None
    assert reported.code == "too-many-items"
    assert too_many(FlightLoad(mission(650)), AutopilotType.PX4) is None


def test_list_that_is_too_long_for_most_boards_is_warned_of():
    whole = load(501, fence=polygon(0, 65))
    assert [str(warning.reason).split()[1] for warning in count_warnings(whole, AutopilotType.PX4)] == ["mission", "fence"]
    assert count_warnings(load(500, fence=polygon(0, 64)), AutopilotType.PX4) == ()
