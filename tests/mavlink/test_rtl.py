"""How high an autopilot flies home, by the parameters that it was read with."""

import pytest

from mavlink.rtl import rtl_behaviour

FENCE = {"FENCE_ENABLE": 1.0, "FENCE_TYPE": 7.0, "FENCE_ALT_MAX": 25.0, "FENCE_MARGIN": 2.0}
COPTER = {"RTL_ALT": 3_000.0, "RTL_CLIMB_MIN": 0.0, "RTL_CONE_SLOPE": 3.0, "RTL_ALT_TYPE": 0.0}


def level_m(autopilot: str, parameters: dict[str, float], current_m: float, away_m: float, **return_point) -> float:
    own = rtl_behaviour(autopilot, parameters)
    assert own is not None
    return own.level_m(current_m, away_m, return_point.get("goal_m", 0.0))


@pytest.mark.parametrize(
    ("parameters", "current_m", "away_m", "expected_m"),
    [
        ({}, 10.0, 500.0, 30.0),
        ({}, 60.0, 500.0, 60.0),  # never down
        ({"RTL_ALT": 0.0}, 10.0, 500.0, 10.0),  # ArduPilot: as high as it is
        ({"RTL_CLIMB_MIN": 500.0}, 60.0, 500.0, 65.0),
        ({}, 10.0, 5.0, 15.0),  # the cone: three metres for each metre away
        ({"RTL_CONE_SLOPE": 0.0}, 10.0, 5.0, 30.0),
        (FENCE, 10.0, 500.0, 23.0),  # never above its own fence
        (FENCE, 40.0, 500.0, 40.0),  # nor down to it
        (FENCE | {"FENCE_ENABLE": 0.0}, 10.0, 500.0, 30.0),
        (FENCE | {"FENCE_ENABLE": 0.0, "FENCE_AUTOENABLE": 1.0}, 10.0, 500.0, 23.0),
        (FENCE | {"FENCE_TYPE": 6.0}, 10.0, 500.0, 30.0),  # round and polygon: none of heights
    ],
)
def test_a_copter_returns_at_its_height_or_its_own(parameters, current_m, away_m, expected_m):
    assert level_m("ardupilot", COPTER | parameters, current_m, away_m) == expected_m


def test_newer_ardupilots_count_metres():
    own = rtl_behaviour("ardupilot", {"RTL_ALT_M": 45.0, "RTL_CLIMB_MIN_M": 2.0})
    assert (own.parameter, own.height_m, own.climb_m, own.value_for(45.2)) == ("RTL_ALT_M", 45.0, 2.0, "46 m")


def test_a_value_is_told_as_it_is_to_be_set():
    assert rtl_behaviour("ardupilot", COPTER).value_for(45.2) == "4600 (46 m)"
    assert rtl_behaviour("px4", {"RTL_RETURN_ALT": 60.0}).value_for(45.2) == "46 m"


@pytest.mark.parametrize(
    ("parameters", "current_m", "away_m", "expected_m"),
    [
        ({}, 10.0, 500.0, 60.0),
        ({}, 80.0, 500.0, 80.0),
        ({}, 10.0, 9.0, 18.0),
        ({"RTL_MIN_DIST": 100.0}, 10.0, 50.0, 50.0),  # a cone of 45 degrees
        ({"RTL_MIN_DIST": 100.0}, 10.0, 11.0, 20.0),  # twice as high as it is near enough
        ({"RTL_MIN_DIST": 100.0, "RTL_CONE_ANG": 0.0}, 10.0, 5.0, 60.0),
        ({"RTL_MIN_DIST": 100.0, "RTL_CONE_ANG": 80.0}, 10.0, 90.0, 20.0),
    ],
)
def test_px4_returns_at_its_height_but_for_the_last_metres(parameters, current_m, away_m, expected_m):
    assert level_m("px4", {"RTL_RETURN_ALT": 60.0} | parameters, current_m, away_m) == pytest.approx(expected_m)


def test_a_rally_point_has_a_height_of_its_own():
    assert level_m("ardupilot", COPTER, 10.0, 500.0, goal_m=40.0) == 40.0
    assert level_m("ardupilot", COPTER, 10.0, 500.0, goal_m=20.0) == 30.0, "no lower than home"
    assert level_m("px4", {"RTL_RETURN_ALT": 60.0}, 10.0, 500.0, goal_m=5.0) == 65.0


@pytest.mark.parametrize(("autopilot", "parameters"), [("px4", {}), ("ardupilot", {"RTL_CLIMB_MIN": 0.0}), ("other", COPTER), ("", {})])
def test_without_its_height_nothing_is_known(autopilot, parameters):
    assert rtl_behaviour(autopilot, parameters) is None


@pytest.mark.parametrize(
    ("autopilot", "parameters", "bends_by"),
    [
        ("px4", {"RTL_RETURN_ALT": 60.0, "RTL_TYPE": 1.0}, "RTL_TYPE 1"),
        ("px4", {"RTL_RETURN_ALT": 60.0, "RTL_TYPE": 0.0, "GF_AVOID_NODES": 100.0}, "GF_AVOID_NODES 100"),
        ("ardupilot", COPTER | {"RTL_ALT_TYPE": 1.0}, "RTL_ALT_TYPE 1"),
        ("ardupilot", COPTER | {"OA_TYPE": 2.0}, "OA_TYPE 2"),
        ("ardupilot", COPTER | {"OA_TYPE": 0.0}, ""),
    ],
)
def test_what_makes_it_leave_the_straight_way_is_named(autopilot, parameters, bends_by):
    assert rtl_behaviour(autopilot, parameters).bends_by == bends_by


@pytest.mark.parametrize(
    ("autopilot", "parameters", "untold"),
    [
        ("px4", {"RTL_RETURN_ALT": 60.0}, "RTL_TYPE"),
        ("ardupilot", {"RTL_ALT": 3_000.0}, "RTL_ALT_TYPE"),
        ("ardupilot", COPTER, ""),
    ],
)
def test_whether_it_flies_straight_must_have_been_told(autopilot, parameters, untold):
    assert rtl_behaviour(autopilot, parameters).untold == untold


def test_rally_points_and_whether_home_counts_are_told_by_ardupilot_alone():
    reported = rtl_behaviour("ardupilot", COPTER | {"RALLY_INCL_HOME": 0.0, "RALLY_TOTAL": 3.0})
    assert (reported.shuns_home, reported.rally_points) == (True, 3)
    assert (rtl_behaviour("ardupilot", COPTER).shuns_home, rtl_behaviour("px4", {"RTL_RETURN_ALT": 60.0}).rally_points) == (False, None)
