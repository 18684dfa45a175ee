"""A return that begins after a hold, or at another height: step by step, and called off by whoever gives another command meanwhile."""

from datetime import timedelta

import pytest
from django.utils import timezone

from missions.models import CommandKind, CommandState, LinkKind, Uav, UavCommand
from missions.services.commands.commands import claim_commands, note_failed, note_sent, queue_command
from missions.services.commands.refused import Refused
from missions.services.commands.rtl_check import note_rtl_behaviour
from missions.services.commands.staggered_returns import stuck_returns
from missions.services.commands.steering import command_uav
from tests.accounts.users import client_of
from tests.missions.commands.outbox import claim, fence, now
from tests.missions.flights import an_operator, carry, fleet
from workspace.models import User

pytestmark = pytest.mark.django_db
COPTER = {"RTL_ALT": 3_000.0, "RTL_ALT_TYPE": 0.0}


@pytest.fixture
def user() -> User:
    return an_operator()


@pytest.fixture
def uav() -> Uav:
    return fleet("Tern")[0]


def given(uav: Uav, user: User, kind: CommandKind, **parameters: object) -> UavCommand:
    return command_uav(uav=uav, kind=kind, actor=user, parameters=parameters)


def last(uav: Uav) -> UavCommand:
    return uav.commands.order_by("-sequence")[0]


def test_a_return_in_turn_holds_first_and_is_carried_once_its_time_has_come(uav, user):
    hold = given(uav, user, CommandKind.RETURN, wait_s=40.0)
    assert hold.kind == CommandKind.HOLD
    carry(uav)
    home = last(uav)
    assert (home.kind, home.state, home.created_by) == (CommandKind.RETURN, CommandState.QUEUED, user)
    assert 38.0 < (home.lease_expires_at - timezone.now()).total_seconds() <= 40.0
    assert claim(uav) == []
    UavCommand.objects.filter(pk=home.pk).update(lease_expires_at=timezone.now() - timedelta(seconds=1))
    assert [command.pk for command in claim(uav)] == [home.pk]


def test_a_hold_that_came_late_shortens_the_wait(uav, user):
    hold = given(uav, user, CommandKind.RETURN, wait_s=40.0)
    UavCommand.objects.filter(pk=hold.pk).update(created_at=timezone.now() - timedelta(seconds=60))
    carry(uav)
    assert last(uav).kind == CommandKind.RETURN and last(uav).lease_expires_at is None


@pytest.mark.parametrize("kind", [CommandKind.HOLD, CommandKind.RETURN, CommandKind.LAND])
def test_another_command_takes_the_place_of_a_return_that_waits(kind, uav, user):
    given(uav, user, CommandKind.RETURN, wait_s=40.0)
    carry(uav)
    waiting = last(uav)
    other = given(uav, user, kind)
    assert now(waiting).state == CommandState.EXPIRED
    carry(uav)
    assert last(uav) == other, "nothing follows a command that was given instead"


def test_a_command_that_was_given_while_it_was_told_to_hold_counts(uav, user):
    hold = given(uav, user, CommandKind.RETURN, wait_s=40.0)
    (claimed,) = claim(uav)
    assert note_sent(claimed.pk, **fence(claimed))
    land = given(uav, user, CommandKind.LAND)
    assert now(hold).state == CommandState.EXPIRED and last(uav) == land


def test_a_hold_that_failed_is_followed_by_nothing(uav, user):
    given(uav, user, CommandKind.RETURN, wait_s=40.0)
    (claimed,) = claim(uav)
    assert note_failed(claimed.pk, "denied", "No.", **fence(claimed))
    assert last(uav).kind == CommandKind.HOLD


def test_a_return_follows_its_height(uav, user):
    note_rtl_behaviour(uav_id=uav.pk, autopilot="ardupilot", parameters=COPTER)
    uav.refresh_from_db()
    command = given(uav, user, CommandKind.SET_RETURN_HEIGHT, height_m=75.0, then_return=True)
    assert command.kind == CommandKind.SET_RETURN_HEIGHT
    assert (command.expires_at - command.created_at) <= timedelta(seconds=60)
    carry(uav)
    assert (last(uav).kind, last(uav).parameters, last(uav).lease_expires_at) == (CommandKind.RETURN, {}, None)


def test_a_height_alone_is_followed_by_nothing_and_is_wanted_as_long_as_an_upload(uav, user):
    note_rtl_behaviour(uav_id=uav.pk, autopilot="ardupilot", parameters=COPTER)
    uav.refresh_from_db()
    command = given(uav, user, CommandKind.SET_RETURN_HEIGHT, height_m=75.0)
    assert (command.expires_at - command.created_at) > timedelta(minutes=30)
    carry(uav)
    assert last(uav) == command


def test_a_height_is_refused_that_is_out_of_bounds_or_of_a_uav_whose_parameter_is_not_known(uav, user):
    with pytest.raises(Refused, match="was never read"):
        given(uav, user, CommandKind.SET_RETURN_HEIGHT, height_m=75.0)
    note_rtl_behaviour(uav_id=uav.pk, autopilot="ardupilot", parameters=COPTER)
    uav.refresh_from_db()
    for parameters in ({}, {"height_m": 0.0}, {"height_m": 500.0}, {"height_m": 75.0, "speed_mps": 3.0}):
        with pytest.raises(Refused):
            given(uav, user, CommandKind.SET_RETURN_HEIGHT, **parameters)
    uav.link = LinkKind.HTTP
    with pytest.raises(Refused, match="companion"):
        given(uav, user, CommandKind.SET_RETURN_HEIGHT, height_m=75.0)
    with pytest.raises(Refused):
        given(uav, user, CommandKind.RETURN, wait_s=5_000.0)


def test_a_return_holds_first_and_then_gets_its_height(uav, user):
    note_rtl_behaviour(uav_id=uav.pk, autopilot="ardupilot", parameters=COPTER)
    uav.refresh_from_db()
    hold = given(uav, user, CommandKind.RETURN, wait_s=40.0, height_m=75.0)
    assert (hold.kind, hold.parameters["height_m"]) == (CommandKind.HOLD, 75.0)
    carry(uav)
    height = last(uav)
    assert (height.kind, height.parameters["height_m"]) == (CommandKind.SET_RETURN_HEIGHT, 75.0)
    carry(uav)
    home = last(uav)
    assert home.kind == CommandKind.RETURN and 35.0 < home.parameters["wait_s"] <= 40.0


def test_a_step_that_fails_is_stuck_until_another_command_about_its_flight(uav, user):
    note_rtl_behaviour(uav_id=uav.pk, autopilot="ardupilot", parameters=COPTER)
    uav.refresh_from_db()
    height = given(uav, user, CommandKind.RETURN, height_m=75.0)
    (claimed,) = claim(uav)
    assert note_failed(claimed.pk, "denied", "RTL_ALT stays 3000.", **fence(claimed))
    assert [command.pk for command in stuck_returns()] == [height.pk]
    given(uav, user, CommandKind.HOLD)
    assert stuck_returns() == []


def test_a_return_that_the_uav_refuses_is_stuck_and_one_that_is_superseded_is_not(uav, user):
    home = given(uav, user, CommandKind.RETURN)
    (claimed,) = claim(uav)
    assert note_failed(claimed.pk, "denied", "No.", **fence(claimed))
    assert [command.pk for command in stuck_returns()] == [home.pk]
    given(uav, user, CommandKind.RETURN, wait_s=40.0)
    given(uav, user, CommandKind.LAND)
    assert stuck_returns() == []


def test_a_return_along_the_route_is_refused_without_a_mission_and_beside_a_wait(uav, user):
    with pytest.raises(Refused, match="has no mission"):
        given(uav, user, CommandKind.RETURN, along_route=True)
    with pytest.raises(Refused):
        given(uav, user, CommandKind.RETURN, along_route=True, wait_s=40.0)


def test_a_return_along_the_route_is_not_sent_to_one_that_is_not_heard(uav, user):
    command = queue_command(uav=uav, kind=CommandKind.RETURN, actor=user, parameters={"along_route": True})
    assert claim_commands(uav_ids=[uav.pk], holder="gateway-1", lease_s=10.0, limit=5, to_unreachable=True) == []
    assert [one.pk for one in claim(uav)] == [command.pk]


def test_the_api_takes_both(uav, user):
    note_rtl_behaviour(uav_id=uav.pk, autopilot="ardupilot", parameters=COPTER)
    notify = client_of(user).post
    address = f"/api/v1/uavs/{uav.pk}/commands"
    body = {"kind": "set-return-height", "parameters": {"height_m": 75, "then_return": True}}
    assert notify(address, body, content_type="application/json").json()["kind"] == "set-return-height"
    body = {"kind": "return", "parameters": {"wait_s": 40}}
    assert notify(address, body, content_type="application/json").json()["kind"] == "hold"
