"""The link to a UAV still carries what is sent, and nothing that it says: what makes it safe is sent all the same, and nothing else."""

import time
from collections import Counter, deque
from dataclasses import dataclass, replace

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.autopilot_type import AutopilotType
from mavlink.frames import frames_of_datagram
from mavlink.signing import FrameWriter
from missions.command_rules import HAND_OVER
from missions.models import CommandKind, CommandState, UavCommand
from missions.services.commands.commands import queue_command
from telemetry.gateway import delivery, dispatcher
from telemetry.gateway.fleet import KnownUav
from telemetry.gateway.session import ADDRESS_GOOD_S, Session
from telemetry.models import UavLink
from telemetry.services.links.links import Lease
from tests.telemetry.gateway.commands.test_commands import AUTOPILOT_TYPES, ended
from tests.telemetry.gateway.flyer import Flyer
from tests.telemetry.gateway.outages.test_outages import database_away
from tests.telemetry.gateway.station import Link, gateway_at_work, heartbeat, port_of, wait_for

pytestmark = pytest.mark.django_db(transaction=True)
IN_MISSION = {AutopilotType.PX4: 4 << 16 | 4 << 24, AutopilotType.ARDUPILOT: 3}
RETURNING = {AutopilotType.PX4: 4 << 16 | 5 << 24, AutopilotType.ARDUPILOT: 6}


@pytest.fixture(autouse=True)
def soon_silent(monkeypatch):
    for module in (delivery, dispatcher):
        monkeypatch.setattr(module, "RECEIVED_WITHIN_S", 1.5)


def sent_unacknowledged(command: UavCommand) -> bool:
    command.refresh_from_db()
    return (command.state, command.outcome_code) == (CommandState.SENT, "unheard")


def silenced(flying: Flyer, gateway) -> None:
    session = wait_for(lambda: gateway.sessions.get(7))
    wait_for(lambda: session.is_served(time.time(), 1.5) and session.state.is_in_air is not None, "that it is heard")
    flying.is_unacknowledged = True
    wait_for(lambda: not session.is_served(time.time(), 1.5), "silence")


@pytest.mark.parametrize(
    ("autopilot_type", "kind"), [(AutopilotType.PX4, CommandKind.ABORT), (AutopilotType.ARDUPILOT, CommandKind.RETURN)]
)
def test_a_return_reaches_a_uav_that_is_not_heard_and_counts_once_it_is(kind, autopilot_type, uav, tmp_path):
    vehicle = AUTOPILOT_TYPES[autopilot_type](is_armed=True, is_in_air=True, custom_mode=IN_MISSION[autopilot_type])
    with gateway_at_work(tmp_path) as gateway, Flyer(vehicle, port_of(gateway)) as flying:
        silenced(flying, gateway)
        command = queue_command(uav=uav, kind=kind, actor=None)
        wait_for(lambda: vehicle.custom_mode == RETURNING[autopilot_type], "that it returns")
        wait_for(lambda: sent_unacknowledged(command), "that it is told")
        time.sleep(1.5)
        assert sent_unacknowledged(command), "nobody has seen it done"
        flying.is_unacknowledged = False
        assert ended(command).state == CommandState.APPLIED, command.outcome
        assert (command.outcome_code, command.outcome) == ("", "")


@pytest.mark.parametrize("autopilot_type", [AutopilotType.PX4, pytest.param(AutopilotType.ARDUPILOT, marks=pytest.mark.long)])
def test_what_stood_on_the_ground_when_it_was_heard_is_not_disarmed_unheard(autopilot_type, uav, tmp_path):
    vehicle = AUTOPILOT_TYPES[autopilot_type](is_armed=True, custom_mode=IN_MISSION[autopilot_type])
    with gateway_at_work(tmp_path) as gateway, Flyer(vehicle, port_of(gateway)) as flying:
        silenced(flying, gateway)
        vehicle.is_in_air = True
        queue_command(uav=uav, kind=CommandKind.ABORT, actor=None)
        wait_for(lambda: vehicle.custom_mode == RETURNING[autopilot_type], "that it returns")
    assert {command for command, _ in vehicle.taken} == {mavlink.MAV_CMD_DO_SET_MODE}


def test_it_ends_as_unconfirmed_and_a_firmer_one_takes_its_place(uav, tmp_path):
    vehicle = AUTOPILOT_TYPES[AutopilotType.PX4](is_armed=True, is_in_air=True, custom_mode=IN_MISSION[AutopilotType.PX4])
    with gateway_at_work(tmp_path) as gateway, Flyer(vehicle, port_of(gateway)) as flying:
        silenced(flying, gateway)
        hold = queue_command(uav=uav, kind=CommandKind.HOLD, actor=None)
        wait_for(lambda: sent_unacknowledged(hold), "that it is told")
        back = queue_command(uav=uav, kind=CommandKind.RETURN, actor=None, expires_in_s=2.5)
        wait_for(lambda: vehicle.custom_mode == RETURNING[AutopilotType.PX4], "that it returns")
        assert (ended(back).state, back.outcome_code) == (CommandState.EXPIRED, "unconfirmed")
    hold.refresh_from_db()
    assert (hold.state, hold.outcome_code) == (CommandState.EXPIRED, "superseded")


def test_nothing_else_is_sent_unheard(uav, tmp_path):
    vehicle = AUTOPILOT_TYPES[AutopilotType.PX4](custom_mode=IN_MISSION[AutopilotType.PX4])
    with gateway_at_work(tmp_path) as gateway, Flyer(vehicle, port_of(gateway)) as flying:
        silenced(flying, gateway)
        for kind in (CommandKind.ARM, CommandKind.TAKE_OFF, CommandKind.CHANGE_SPEED, CommandKind.PAUSE, CommandKind.RESUME):
            queue_command(uav=uav, kind=kind, actor=None)
            time.sleep(0.3)
        queue_command(uav=uav, kind=CommandKind.HOLD, actor=None, parameters={HAND_OVER: True})
        time.sleep(1.0)
    assert set(UavCommand.objects.values_list("attempts", flat=True)) == {0}
    assert vehicle.taken == []


def test_a_uav_that_was_never_heard_here_is_not_addressed(uav, tmp_path):
    """Not where another gateway heard it, nor where somebody speaks with another system id."""
    with gateway_at_work(tmp_path) as gateway, Link(port_of(gateway), 9) as other, Link(port_of(gateway), 7) as unasked:
        UavLink.objects.create(uav=uav, address=f"udp:127.0.0.1:{unasked.socket.getsockname()[1]}", is_in_air=True, is_armed=True)
        other.send(heartbeat(is_armed=True))
        command = queue_command(uav=uav, kind=CommandKind.ABORT, actor=None)
        time.sleep(2.5)
        asked = [(message.command, message.param1) for message in other.received()]
        assert asked == [(mavlink.MAV_CMD_REQUEST_MESSAGE, mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT)], "where it is, and nothing else"
        assert unasked.received() == []
    command.refresh_from_db()
    assert (command.state, command.attempts) == (CommandState.QUEUED, 0)


KEY, OTHER_KEY = b"k" * 32, b"o" * 32
SIGNED = KnownUav(1, 1, "Tern", 7, False, 1, KEY)


@dataclass(eq=False)
class Sender:
    sent: list[bytes]
    name: str = "udp"

    def send(self, frame: bytes) -> None:
        self.sent.append(frame)


def session_after(uav: KnownUav, at_s: float) -> tuple[Session, list[bytes]]:
    session, sent = Session(uav, deque(), link_id=1), []
    session.serve(Lease(1, {}, [], {}, ""), time.monotonic() + 60.0)
    frame = FrameWriter(7, 1, key=uav.key).frame_of(heartbeat(is_armed=True), at_s)
    for one in frames_of_datagram(frame, Counter()):
        session.receive(one, Sender(sent), at_s)
    return session, sent


@pytest.mark.parametrize(
    ("before", "after", "may_receive"),
    [
        (SIGNED, replace(SIGNED, name="Another"), True),
        (SIGNED, replace(SIGNED, credential_id=2, key=OTHER_KEY), False),
        (SIGNED, replace(SIGNED, credential_id=None, key=None, allows_unsigned=True), False),
        (replace(SIGNED, credential_id=None, key=None, allows_unsigned=True), replace(SIGNED, credential_id=None, key=None), False),
    ],
)
def test_who_was_believed_by_another_key_is_not_spoken_to(before, after, may_receive):
    now_s = time.time()
    session, sent = session_after(before, now_s)
    assert session.may_receive(now_s)
    session.change(after)
    session.tick(now_s)
    session.send([heartbeat()], now_s)
    assert (session.may_receive(now_s), bool(sent)) == (may_receive, may_receive)


def test_an_address_is_good_for_an_hour():
    now_s = time.time()
    session, sent = session_after(SIGNED, now_s)
    assert not session.may_receive(now_s + ADDRESS_GOOD_S + 1.0)
    session.tick(now_s + ADDRESS_GOOD_S + 1.0)
    assert sent == []


def test_a_gateway_that_nobody_can_give_commands_to_says_no_longer_that_it_is_there(uav, tmp_path, settings, caplog):
    settings.GATEWAY_ALONE_S = 1.0

    def beats(link: Link) -> bool:
        return any(message.get_type() == "HEARTBEAT" for message in link.received())

    with gateway_at_work(tmp_path) as gateway, Link(port_of(gateway), 7) as link:
        wait_for(lambda: link.send(heartbeat()) or beats(link), "heartbeats")
        with database_away():
            wait_for(lambda: "no heartbeats any more" in caplog.text, "that it is told")
            link.received()
            until_s = time.monotonic() + 2.5
            while time.monotonic() < until_s:
                link.send(heartbeat())
                assert not beats(link)
                time.sleep(0.1)
        wait_for(lambda: link.send(heartbeat()) or beats(link), "heartbeats again")
    assert "UAVs get heartbeats" in caplog.text
