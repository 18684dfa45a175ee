"""What a vehicle would not fly by its own parameters is told before anything is sent to it."""

import pytest

from inspection.geodesy import LonLat
from mavlink.autopilot_type import AutopilotType
from mavlink.mission_sync import limits
from mavlink.vehicle_plan import MissionType
from missions.models import CommandState, Mission
from missions.serializers.commands import command_json
from missions.services.approval.approval import approve_mission
from missions.services.commands.dispatch import load_of
from telemetry.models import UavLink
from tests.accounts.users import a_user
from tests.missions.flights import ground, planned
from tests.missions.worlds import UAV_AT, world
from tests.telemetry.gateway.commands.test_commands import dispatch, ended, flyer, holds
from tests.telemetry.gateway.station import gateway_at_work, wait_for
from tests.telemetry.vehicles.px4 import Px4

UNTOLD = "The UAV has not told how far apart waypoints may be."

pytestmark = pytest.mark.django_db(transaction=True)
ASIDE = LonLat(UAV_AT.lon + 0.001, UAV_AT.lat)  # some 60 m
WIDE = {"MIS_DIST_1WP": 5_000.0, "MIS_DIST_WPS": 5_000.0}


@pytest.fixture
def plan(uav, own_folders, tmp_path) -> Mission:
    author = a_user()
    ground(tmp_path / "hill.tif", 100.0)
    return planned(author, [uav], world().towers[:2])


def approve(plan: Mission, **wishes: float) -> Mission:
    approve_mission(mission=plan, actor=plan.author, **wishes)
    plan.refresh_from_db()
    return plan


@pytest.mark.parametrize(
    ("narrow", "facts", "code", "words"),
    [
        ({"MIS_DIST_WPS": 50.0}, {}, "long-leg", ("MIS_DIST_WPS allows 50 m", "approve it again with points put in")),
        ({"MIS_DIST_1WP": 30.0}, {"at": ASIDE}, "far-first-waypoint", ("is 62 m away; MIS_DIST_1WP allows 30 m", "Bring the UAV")),
    ],
)
def test_a_mission_beyond_the_limits_is_not_sent(narrow, facts, code, words, uav, plan, tmp_path):
    mission = approve(plan)
    vehicle = Px4(parameters=WIDE | narrow)
    with gateway_at_work(tmp_path) as gateway, flyer(vehicle, gateway, **facts) as flying:
        upload = ended(dispatch(mission))
        assert (upload.state, upload.outcome_code) == (CommandState.FAILED, code), upload.outcome
        assert all(part in upload.outcome for part in words), upload.outcome
        assert not {"MISSION_COUNT", "MISSION_CLEAR_ALL", "MISSION_ITEM_INT"} & {message.get_type() for message in flying.received}
        wait_for(lambda: UavLink.objects.get(uav=uav).limits == WIDE | narrow, "limits that are kept")
    assert list(upload.events.values_list("state", flat=True)) == ["queued", "failed"]
    assert not any(vehicle.lists.values())


def test_limits_are_read_anew_before_a_mission_is_refused(uav, plan, tmp_path):
    vehicle = Px4(parameters=WIDE | {"MIS_DIST_WPS": 50.0})
    with gateway_at_work(tmp_path) as gateway, flyer(vehicle, gateway):
        wait_for(lambda: UavLink.objects.filter(uav=uav, limits__MIS_DIST_WPS=50.0).exists(), "limits that were told")
        vehicle.parameters = WIDE
        upload = ended(dispatch(approve(plan)))
        assert (upload.state, upload.outcome) == (CommandState.APPLIED, "")
        wait_for(lambda: UavLink.objects.get(uav=uav).limits == WIDE, "the new limits")


def test_a_mission_approved_with_points_on_its_legs_is_within_the_limits(uav, plan, tmp_path):
    vehicle = Px4(parameters=WIDE | {"MIS_DIST_WPS": 50.0})
    with gateway_at_work(tmp_path) as gateway, flyer(vehicle, gateway):
        upload = ended(dispatch(approve(plan, longest_leg_m=50.0)))
        assert upload.state == CommandState.APPLIED, upload.outcome
        assert holds(vehicle, load_of(upload).load, AutopilotType.PX4)


def test_a_vehicle_that_tells_no_limits_is_given_its_mission_with_a_warning(uav, plan, tmp_path):
    with gateway_at_work(tmp_path) as gateway, flyer(Px4(), gateway):
        upload = ended(dispatch(approve(plan)))
    assert (upload.state, command_json(upload)["outcome"]) == (CommandState.APPLIED, UNTOLD)
    assert upload.events.last().note.endswith(UNTOLD)


def test_a_list_that_is_longer_than_usual_is_warned_of(uav, plan, tmp_path, monkeypatch):
    monkeypatch.setitem(limits.USUAL_ITEMS, (AutopilotType.PX4, MissionType.MISSION), 2)
    with gateway_at_work(tmp_path) as gateway, flyer(Px4(parameters=WIDE), gateway):
        upload = ended(dispatch(approve(plan)))
    assert upload.state == CommandState.APPLIED
    assert "px4 on most boards takes 2" in upload.outcome
