"""What is on a vehicle is read back before it flies, in its own time; and what makes it doubtful in between is said."""

import time
from typing import Any

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.timeouts import TransferRules
from mavlink.vehicle_plan import MissionItem, MissionType
from missions.command_rules import CommandLifetimes
from missions.models import CommandState, Mission, Uav
from missions.serializers.commands import command_json
from missions.services.commands.dispatch import dispatch_mission
from telemetry.models import UavLink
from telemetry.services.links.onboard_lists import Doubt
from tests.accounts.users import a_user
from tests.missions.flights import approved, ground
from tests.missions.worlds import UAV_AT, world
from tests.telemetry.gateway.commands.test_commands import begin, dispatch, ended, flyer
from tests.telemetry.gateway.flyer import Flyer
from tests.telemetry.gateway.station import gateway_at_work, port_of, wait_for
from tests.telemetry.vehicles.px4 import Px4

pytestmark = pytest.mark.django_db(transaction=True)
CORNER, GLOBAL = mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION, mavlink.MAV_FRAME_GLOBAL
OTHERS_FENCE = [MissionItem(CORNER, GLOBAL, (3.0, 0.0, 0.0, 0.0), 100_000_000 + number, 550_000_000) for number in range(3)]


@pytest.fixture
def mission(uav, settings, tmp_path) -> Mission:
    """Without zones: its fence is empty."""
    settings.GRAPH_CACHE_DIR = tmp_path / "graphs"
    settings.FLIGHT_LOG_DIR = tmp_path
    ground(tmp_path / "hill.tif", 100.0)
    return approved(a_user(), [uav], world().towers[:2])[0]


def link_of(uav: Uav) -> UavLink:
    return UavLink.objects.get(uav=uav)


def test_a_fence_that_nobody_approved_is_found_at_the_start(uav, mission, tmp_path):
    vehicle = Px4()
    with gateway_at_work(tmp_path) as gateway, flyer(vehicle, gateway):
        upload = ended(dispatch(mission))
        vehicle.lists[MissionType.FENCE] = list(OTHERS_FENCE)
        start = ended(begin(uav, mission, upload.approval))
        assert (start.state, start.outcome_code) == (CommandState.FAILED, "other-list"), start.outcome
        assert "fence" in start.outcome and not vehicle.is_in_air
        assert link_of(uav).loaded_approval is None


@pytest.mark.long
def test_a_fence_of_its_own_that_was_told_at_the_upload_may_stay_but_not_change(uav, mission, tmp_path):
    vehicle = Px4()
    vehicle.lists[MissionType.FENCE] = list(OTHERS_FENCE)
    with gateway_at_work(tmp_path) as gateway, flyer(vehicle, gateway):
        upload = ended(dispatch(mission))
        assert upload.state == CommandState.APPLIED and "own fence" in upload.outcome
        vehicle.lists[MissionType.FENCE] = OTHERS_FENCE[:2]
        start = ended(begin(uav, mission, upload.approval))
        assert (start.state, start.outcome_code) == (CommandState.FAILED, "other-list"), start.outcome
        vehicle.lists[MissionType.FENCE] = list(OTHERS_FENCE)
        (again,) = dispatch_mission(mission=mission, actor=mission.author, place=0)
        assert ended(again).state == CommandState.APPLIED
        assert ended(begin(uav, mission, upload.approval)).state == CommandState.APPLIED


def other_station(flying: Any) -> None:
    flying.report(mavlink.MAVLink_mission_ack_message(42, 190, mavlink.MAV_MISSION_ACCEPTED, 0))


def reboot(flying: Any) -> None:
    flying.booted_s = time.monotonic()


@pytest.mark.long
@pytest.mark.parametrize(("happens", "doubt"), [(other_station, Doubt.OTHER_STATION), (reboot, Doubt.REBOOTED)])
def test_what_may_have_changed_since_is_doubted_until_it_is_read_back(happens, doubt, uav, mission, tmp_path):
    with gateway_at_work(tmp_path) as gateway, flyer(Px4(), gateway, booted_s=time.monotonic() - 100.0) as flying:
        upload = ended(dispatch(mission))
        link = link_of(uav)
        assert (link.loaded_doubt, link.loaded_approval) == ("", upload.approval_id) and link.loaded_read_at is not None
        happens(flying)
        wait_for(lambda: link_of(uav).loaded_doubt == doubt, "the doubt")
        assert ended(begin(uav, mission, upload.approval)).state == CommandState.APPLIED
        again = link_of(uav)
        assert again.loaded_doubt == "" and again.loaded_read_at > link.loaded_read_at


MOTION_S, ITEM_S = 3.0, 0.8  # a busy machine takes the start up within 3 s, and reading its list back takes longer


class SlowRadio(Px4):
    """Gives an item each ITEM_S at most."""

    _given_s: float = 0.0

    def _mission_request_int(self, message: Any, now_s: float) -> list[Any]:
        if now_s - self._given_s < ITEM_S:
            return []
        self._given_s = now_s
        return super()._mission_request_int(message, now_s)


@pytest.mark.long
@pytest.mark.parametrize(("read_back_s", "state"), [(30.0, CommandState.APPLIED), (0.5, CommandState.EXPIRED)])
def test_a_start_waits_for_the_reading_as_long_as_that_goes_on_and_is_allowed(read_back_s, state, uav, mission, settings, tmp_path):
    settings.COMMAND_RULES = CommandLifetimes(motion_s=MOTION_S, read_back_s=read_back_s)
    vehicle = SlowRadio()
    with gateway_at_work(tmp_path) as gateway, flyer(vehicle, gateway):
        upload = ended(dispatch(mission))
        assert upload.state == CommandState.APPLIED, upload.outcome
        start = begin(uav, mission, upload.approval)
        given, first_until = start.created_at, start.expires_at
        ended(start)
        assert start.state == state, start.outcome
        assert vehicle.is_in_air == (state == CommandState.APPLIED)
        assert (start.expires_at - given).total_seconds() <= MOTION_S + read_back_s + 0.01
        assert start.expires_at > first_until and start.progress["total"] > start.progress.get("done", 0) - 1
        if state == CommandState.APPLIED:
            assert (start.sent_at - given).total_seconds() > MOTION_S


class Homeless(Flyer):
    def _reports(self, now_s: float) -> list[Any]:
        return super()._reports(now_s)[:1]


@pytest.mark.long
def test_a_start_that_waited_for_home_in_vain_ends_with_that_reason(uav, mission, settings, tmp_path):
    settings.COMMAND_RULES = CommandLifetimes(motion_s=1.5)
    with gateway_at_work(tmp_path) as gateway, Homeless(Px4(), port_of(gateway), at=UAV_AT, altitude_amsl_m=101.0):
        upload = ended(dispatch(mission))
        start = ended(begin(uav, mission, upload.approval))
    assert (start.state, start.outcome_code) == (CommandState.EXPIRED, "no-home"), start.outcome
    assert start.outcome == ("It was not sent in time. The UAV does not tell where its home is, from which it counts its heights.")
    assert command_json(start)["outcome"] == start.outcome


class Unreadable(Px4):
    """Lets its lists be read no more once it holds them."""

    is_unreadable = False

    def _mission_request_list(self, message: Any, now_s: float) -> list[Any]:
        return [] if self.is_unreadable else super()._mission_request_list(message, now_s)


@pytest.mark.long
def test_a_start_that_waited_for_the_reading_in_vain_ends_with_that_reason(uav, mission, settings, tmp_path):
    settings.COMMAND_RULES = CommandLifetimes(motion_s=5.0)
    vehicle = Unreadable()
    with gateway_at_work(tmp_path) as gateway, flyer(vehicle, gateway):
        upload = ended(dispatch(mission))
        vehicle.is_unreadable = True
        settings.TRANSFER_RULES = TransferRules(timeout_s=0.3, item_timeout_s=0.1, retries=2)
        start = ended(begin(uav, mission, upload.approval))
    assert (start.state, start.outcome_code) == (CommandState.EXPIRED, "silent"), start.outcome
    assert start.outcome == "It was not sent in time. Nothing was sent: the mission on the vehicle could not be read."


@pytest.mark.long
def test_a_start_does_not_wait_for_a_vehicle_that_falls_silent(uav, mission, settings, tmp_path):
    settings.COMMAND_RULES = CommandLifetimes(motion_s=1.5, read_back_s=60.0)
    with gateway_at_work(tmp_path) as gateway, flyer(Px4(), gateway) as flying:
        upload = ended(dispatch(mission))
        flying.is_silent = True
        start = ended(begin(uav, mission, upload.approval))
        assert (start.state, start.outcome_code) == (CommandState.EXPIRED, "not-delivered")
        assert (start.expires_at - start.created_at).total_seconds() < 2.0
