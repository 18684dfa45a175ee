"""What an autopilot changes is no difference; whatever else is otherwise is one, and is named."""

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.autopilot_type import AutopilotType
from mavlink.mission_sync.compare import ReadbackMatch, are_identical, differences, found, mix_of
from mavlink.mission_sync.wire import OnboardItem, OnboardList, onboard_item
from mavlink.vehicle_plan import MissionItem, MissionType
from operation.reasons import Reason
from tests.telemetry.vehicles.ardupilot import ArduPilot
from tests.telemetry.vehicles.loads import AUTOPILOT_TYPES, load, mission, polygon, rally, waypoint
from tests.telemetry.vehicles.vehicle import item_of

PX4, ARDUPILOT = AutopilotType.PX4, AutopilotType.ARDUPILOT
altitudes = st.floats(-500, 9_000, width=32)


@st.composite
def sent_items(draw: st.DrawFn) -> MissionItem:
    """As `mavlink.mission_items` writes them."""
    command = draw(st.sampled_from([16, 22, 21, 20, 178, 93, 195, 197, 2000]))
    seconds = float(draw(st.integers(0, 3_600)))
    if command in (16, 22, 21, 195):
        parameters = {16: (seconds, 0.0, 0.0, math.nan), 195: (0.0,) * 4}.get(command, (0.0, 0.0, 0.0, math.nan))
        return MissionItem(
            command,
            mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT,
            parameters,
            draw(st.integers(-1_800_000_000, 1_800_000_000)),
            draw(st.integers(-900_000_000, 900_000_000)),
            round(draw(altitudes), 2),
        )
    values = {
        178: (1.0, draw(st.floats(0.1, 30)), -1.0, 0.0),
        93: (seconds, -1.0, -1.0, -1.0),
        2000: (0.0, draw(st.floats(0, 60)), 5.0, 0.0),
    }
    return MissionItem(command, mavlink.MAV_FRAME_MISSION, values.get(command, (0.0,) * 4))


def through(
    autopilot_type: AutopilotType, items: list[MissionItem] | tuple[MissionItem, ...], kind: MissionType = MissionType.MISSION
) -> OnboardList:
    """As the vehicle gives back what it was given, over the wire both times."""
    frames = mavlink.MAVLink(None)
    vehicle = AUTOPILOT_TYPES[autopilot_type.value]()
    held = []
    for number, item in enumerate(items):
        sent = mavlink.MAVLink_mission_item_int_message(
            7, 1, number, item.frame, item.command, 0, 1, *item.parameters, item.latitude_e7, item.longitude_e7, item.altitude_m, kind
        )
        taken = item_of(mavlink.MAVLink(None).parse_char(sent.pack(frames)))
        held.append(onboard_item(mavlink.MAVLink(None).parse_char(vehicle._as_read(taken, number, kind).pack(frames))))
    return tuple(held)


@given(st.lists(sent_items(), max_size=8))
def test_what_the_vehicles_make_of_an_approved_list_is_no_difference(items: list[MissionItem]):
    for autopilot_type in (PX4, ARDUPILOT):
        assert differences(items, through(autopilot_type, items), autopilot_type) == ()


@pytest.mark.parametrize("autopilot_type", [PX4, ARDUPILOT])
def test_fence_and_rally_points_come_back_the_same(autopilot_type: AutopilotType):
    assert differences(polygon(0, 5), through(autopilot_type, polygon(0, 5), MissionType.FENCE), autopilot_type) == ()
    assert differences(rally(), through(autopilot_type, rally(), MissionType.RALLY), autopilot_type) == ()


CHANGES = [
    ("command", lambda item: replace(item, command=17)),
    ("longitude", lambda item: replace(item, longitude_e7=item.longitude_e7 + 1)),
    ("latitude", lambda item: replace(item, latitude_e7=item.latitude_e7 - 1)),
    ("altitude", lambda item: replace(item, altitude_m=item.altitude_m + 0.01)),
    ("altitude", lambda item: replace(item, altitude_m=item.altitude_m - 0.03)),
    ("altitude", lambda item: replace(item, altitude_m=-item.altitude_m)),
    ("altitude", lambda item: replace(item, altitude_m=math.nan)),
    ("frame", lambda item: replace(item, frame=mavlink.MAV_FRAME_GLOBAL_INT)),
    ("frame", lambda item: replace(item, frame=mavlink.MAV_FRAME_GLOBAL_TERRAIN_ALT_INT)),
    ("parameter 1", lambda item: replace(item, parameters=(item.parameters[0] + 1.0, *item.parameters[1:]))),
    ("parameter 2", lambda item: replace(item, parameters=(item.parameters[0], 2.0, *item.parameters[2:]))),
]


@pytest.mark.parametrize(("field", "change"), CHANGES)
@pytest.mark.parametrize("autopilot_type", [PX4, ARDUPILOT])
@given(place=st.integers(0, 9))
def test_anything_else_is_a_difference_named_by_its_item(autopilot_type: AutopilotType, field: str, change, place: int):
    items = [waypoint(number, altitude_m=30.0 + number) for number in range(10)]
    held = list(through(autopilot_type, items))
    held[place] = OnboardItem(change(held[place].item))
    (difference,) = differences(items, tuple(held), autopilot_type)
    assert (difference.item, difference.field) == (place, field)


@pytest.mark.parametrize(
    ("sent_m", "kept_m"),
    [(30.126, 30.12), (35.555, 35.55), (30.999, 30.99), (-12.129, -12.12), (25.019, 25.01)],
)
def test_ardupilots_centimetres_are_no_difference_but_px4_has_to_keep_them(sent_m: float, kept_m: float):
    """The figures that were seen."""
    (held,) = through(ARDUPILOT, [waypoint(0, altitude_m=sent_m)])
    assert held.item.altitude_m == pytest.approx(kept_m, abs=1e-5)
    assert differences([waypoint(0, altitude_m=sent_m)], (held,), ARDUPILOT) == ()
    assert [difference.field for difference in differences([waypoint(0, altitude_m=sent_m)], (held,), PX4)][:1] == ["altitude"]


def test_whole_seconds_of_ardupilot_are_no_difference_but_a_radius_that_it_forgets_is():
    item = replace(waypoint(0), parameters=(2.7, 0.0, 0.0, math.nan))
    assert differences([item], through(ARDUPILOT, [item]), ARDUPILOT) == ()
    with_radius = replace(item, parameters=(2.0, 4.5, 0.0, 90.0))
    assert [difference.field for difference in differences([with_radius], through(ARDUPILOT, [with_radius]), ARDUPILOT)] == [
        "parameter 2",
        "parameter 4",
    ]


def test_yaw_that_px4_keeps_in_radians_is_no_difference():
    item = replace(waypoint(0), parameters=(0.0, 0.0, 0.0, 123.4))
    assert differences([item], through(PX4, [item]), PX4) == ()


@pytest.mark.parametrize("autopilot_type", [PX4, ARDUPILOT])
@given(lost=st.integers(0, 11))
def test_missing_items_are_named(autopilot_type: AutopilotType, lost: int):
    items = mission(12)
    reported = differences(items, through(autopilot_type, items)[:lost], autopilot_type)
    assert [difference.item for difference in reported] == list(range(lost, 12))
    assert all(difference.held == "missing" for difference in reported)


@pytest.mark.parametrize("autopilot_type", [PX4, ARDUPILOT])
def test_items_too_many_are_named(autopilot_type: AutopilotType):
    items = mission(12)
    reported = differences(items[:10], through(autopilot_type, items), autopilot_type)
    assert [(difference.item, difference.wanted) for difference in reported] == [(10, "nothing"), (11, "nothing")]


def test_item_at_which_the_vehicle_would_stop_is_a_difference():
    items = [waypoint(0)]
    held = (replace(through(PX4, items)[0], goes_on=False),)
    difference = differences(items, held, PX4)[0]
    assert str(Reason("item_is_otherwise", difference.params)) == "item 0: going on afterwards is no instead of yes"


def test_lists_with_nan_are_identical_to_themselves():
    held = through(PX4, mission(12))
    assert are_identical(held, through(PX4, mission(12)))
    assert not are_identical(held, held[:-1])
    assert not are_identical(held, through(PX4, mission(12, east=1)))


def test_home_of_ardupilot_is_never_compared():
    vehicle = ArduPilot()
    vehicle.lists[MissionType.MISSION] += mission(5)
    held = tuple(vehicle.held(MissionType.MISSION))
    assert differences(mission(5), held[1:], ARDUPILOT) == ()
    assert differences(mission(5), held, ARDUPILOT) != ()


NEW, OLD = load(9).mission, load(7, east=500).mission


@pytest.mark.parametrize(
    ("held", "reported"),
    [
        (NEW, ReadbackMatch.APPROVED),
        ((), ReadbackMatch.NOTHING),
        (OLD, ReadbackMatch.KNOWN),
        (NEW[:3] + OLD[3:], ReadbackMatch.MIXED),
        (NEW[:5], ReadbackMatch.MIXED),
        (OLD[:5], ReadbackMatch.MIXED),
        (load(7, east=9_000).mission, ReadbackMatch.FOREIGN),
        (NEW[:3] + load(7, east=9_000).mission[3:], ReadbackMatch.FOREIGN),
    ],
)
@pytest.mark.parametrize("autopilot_type", [PX4, ARDUPILOT])
def test_list_is_told_from_what_was_approved(autopilot_type: AutopilotType, held: tuple[MissionItem, ...], reported: ReadbackMatch):
    assert found(through(autopilot_type, held), NEW, [OLD], autopilot_type) is reported


def test_mix_is_told_by_items():
    before = through(ARDUPILOT, OLD)
    held = (*through(ARDUPILOT, NEW[:3]), *before[3:5], *through(ARDUPILOT, load(7, east=9_000).mission[1:2]))
    mix = mix_of(held, NEW, before, ARDUPILOT)
    assert str(mix) == "6 items where 9 are approved: 0-2 are new, 3-4 are of the list before, 5 is of neither list"
    assert str(mix_of((), NEW, before, ARDUPILOT)) == "no items"
    assert "not approved" in str(mix_of(before, NEW, None, ARDUPILOT))
