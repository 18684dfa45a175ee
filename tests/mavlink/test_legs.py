"""Points that are put in on legs: none is too long afterwards, and the vehicle flies the same lines."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.legs import FLOWN, leg_length_m, with_points_between
from mavlink.vehicle_plan import FlightLoad, MissionItem

E7_M = 111_320.0 / 1e7
ROUNDING_M = 0.012  # half of 1e-7 degrees in both directions and half a centimetre in height
EQUATOR_M, FLATTENING = 6_378_137.0, 1 / 298.257223563


def item(command: int, longitude_e7: int, latitude_e7: int, altitude_m: float) -> MissionItem:
    frame = mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT
    return MissionItem(command, frame, (0.0, 0.0, 0.0, math.nan), longitude_e7, latitude_e7, altitude_m)


SPEED = MissionItem(mavlink.MAV_CMD_DO_CHANGE_SPEED, mavlink.MAV_FRAME_MISSION, (1.0, 5.0, -1.0, 0.0))


@st.composite
def flights(draw: st.DrawFn) -> FlightLoad:
    """A take-off, waypoints in every direction up to some kilometres away, speeds in between, and a landing under the last."""
    lon, lat = draw(st.integers(-1_790_000_000, 1_790_000_000)), draw(st.integers(-700_000_000, 700_000_000))
    aside = st.integers(-400_000, 400_000)
    height = st.floats(1, 120).map(lambda height_m: round(height_m, 2))
    places = draw(st.lists(st.tuples(aside, aside, height), min_size=1, max_size=4))
    items = [item(mavlink.MAV_CMD_NAV_TAKEOFF, lon, lat, draw(height)), SPEED]
    for east, north, height_m in places:
        items.append(item(mavlink.MAV_CMD_NAV_WAYPOINT, lon + east, lat + north, height_m))
        items += [SPEED] * draw(st.integers(0, 1))
    east, north, _ = places[-1]
    return FlightLoad((*items, item(mavlink.MAV_CMD_NAV_LAND, lon + east, lat + north, 0.0)))


def flown(load: FlightLoad) -> list[MissionItem]:
    return [one for one in load.mission if one.command in FLOWN]


def local_length_m(left: MissionItem, right: MissionItem) -> float:
    """By the ellipsoid's radii of curvature half-way: another way than the one that is tested."""
    latitude = math.radians((left.latitude_e7 + right.latitude_e7) / 2e7)
    eccentric = FLATTENING * (2 - FLATTENING)
    bend = 1 - eccentric * math.sin(latitude) ** 2
    north_m = math.radians((right.latitude_e7 - left.latitude_e7) / 1e7) * EQUATOR_M * (1 - eccentric) / bend**1.5
    east_m = math.radians((right.longitude_e7 - left.longitude_e7) / 1e7) * EQUATOR_M * math.cos(latitude) / math.sqrt(bend)
    return math.hypot(north_m, east_m)


def on_the_chart(one: MissionItem) -> np.ndarray:
    """Longitude, latitude and height in metres at most: what is straight on the chart is straight here."""
    return np.array([one.longitude_e7 * E7_M, one.latitude_e7 * E7_M, one.altitude_m])


def off_line_m(point: np.ndarray, start: np.ndarray, end: np.ndarray) -> float:
    along = end - start
    share = np.clip(np.dot(point - start, along) / np.dot(along, along), 0.0, 1.0)
    return float(np.linalg.norm(point - (start + share * along)))


@given(load=flights(), most_m=st.floats(50, 5_000))
def test_no_leg_is_longer_than_wished(load: FlightLoad, most_m: float):
    divided = with_points_between(load, most_m)
    assert all(local_length_m(left, right) <= most_m + 0.01 for left, right in pairwise(flown(divided)))


@given(load=flights(), most_m=st.floats(50, 5_000))
def test_the_same_lines_are_flown_at_the_same_heights(load: FlightLoad, most_m: float):
    divided = with_points_between(load, most_m)
    rest = iter(divided.mission)
    own = [next(one for one in rest if one == old) for old in load.mission]
    assert own == list(load.mission), "all items are there, in their order"
    kept = iter(flown(load))
    start, end = next(kept), next(kept)
    done = 0.0
    for point in flown(divided)[1:]:
        if point == end:
            start, end, done = end, next(kept, end), 0.0
            continue
        assert point.command == mavlink.MAV_CMD_NAV_WAYPOINT
        assert point.parameters[:3] == (0.0, 0.0, 0.0), "nothing is waited for"
        assert off_line_m(on_the_chart(point), on_the_chart(start), on_the_chart(end)) <= ROUNDING_M
        gone = float(np.linalg.norm(on_the_chart(point) - on_the_chart(start)))
        assert gone > done, "one after the other"
        done = gone


@given(load=flights(), most_m=st.floats(50, 5_000))
def test_what_is_divided_is_not_divided_again(load: FlightLoad, most_m: float):
    divided = with_points_between(load, most_m)
    assert with_points_between(divided, most_m) == divided
    assert (divided.content_sha256 == load.content_sha256) == (divided == load)


def test_points_are_on_the_way_before_a_landing_that_is_elsewhere():
    load = FlightLoad((
        item(mavlink.MAV_CMD_NAV_TAKEOFF, 98_000_000, 554_000_000, 60.0),
        item(mavlink.MAV_CMD_NAV_LAND, 98_400_000, 554_000_000, 0.0),
    ))  # fmt: skip
    assert [one.altitude_m for one in with_points_between(load, 900.0).mission] == [60.0, 60.0, 60.0, 0.0]


@pytest.mark.parametrize("most_m", [0.0, -1.0, 0.5, math.nan])
def test_legs_of_nothing_are_refused(most_m: float):
    with pytest.raises(ValueError, match="most_m"):
        with_points_between(FlightLoad(()), most_m)


def test_equal_parts_of_a_leg_on_the_chart_are_not_equal_on_the_ground():
    left = item(mavlink.MAV_CMD_NAV_TAKEOFF, 0, 690_000_000, 60.0)
    right = item(mavlink.MAV_CMD_NAV_WAYPOINT, 2_000_000, 690_360_000, 60.0)
    most_m = leg_length_m(left, right) / 10
    divided = flown(with_points_between(FlightLoad((left, right)), most_m))
    assert len(divided) == 12, "one part more than ten"
    assert all(leg_length_m(one, other) <= most_m for one, other in pairwise(divided))
