"""S2: who listens on a UAV's network and sends its signed frames on, faster than they come, takes neither its answers nor its place."""

import time
from contextlib import ExitStack
from dataclasses import dataclass, field

import pytest

from mavlink.autopilot_type import PX4_AUTO
from mavlink.signing import FrameWriter
from missions.models import CommandKind, CommandState
from missions.services.commands.commands import queue_command
from telemetry.gateway import addresses, sender_authentication
from telemetry.gateway.addresses import MAX_ADDRESSES, Addresses
from telemetry.models import Alert, TelemetryRecord, UavLink
from tests.accounts.users import a_user
from tests.telemetry.gateway.flyer import Flyer
from tests.telemetry.gateway.station import Link, gateway_at_work, heartbeat, port_of, position, signed_uav, wait_for
from tests.telemetry.vehicles.px4 import HOLD, MISSION, Px4

db = pytest.mark.django_db(transaction=True)


@dataclass
class CopiedFlyer(Flyer):
    """Each of its frames arrives from `thief` before it arrives from the vehicle."""

    thief: Link | None = field(default=None, repr=False)

    def __enter__(self) -> "CopiedFlyer":
        super().__enter__()
        link = self._link

        def send(*messages) -> None:
            for message in messages:
                raw = link.frame(message)
                self.thief.socket.send(raw)
                link.socket.send(raw)

        link.send = send
        return self


@db
@pytest.mark.parametrize("first", ["uav", "thief"])
def test_uav_whose_frames_arrive_as_copies_first_gets_every_answer(first, tmp_path):
    uav, key = signed_uav(3, a_user())
    with gateway_at_work(tmp_path) as gateway, Link(port_of(gateway), 3, key) as vehicle, Link(port_of(gateway), 3) as thief:
        if first == "uav":
            vehicle.send(heartbeat())
            wait_for(lambda: vehicle.received())
        answers = {"vehicle": 0, "thief": 0}
        until_s = time.monotonic() + 4.0
        while time.monotonic() < until_s:
            raw = vehicle.frame(heartbeat())
            thief.send_raw(raw)
            time.sleep(0.005)
            vehicle.send_raw(raw)
            time.sleep(0.2)
            answers["vehicle"] += len(vehicle.received())
            answers["thief"] += len(thief.received())
        assert answers["vehicle"] >= 4, answers
        alert = wait_for(lambda: Alert.objects.filter(code="second-sender").first())
        own, other = (str(link.socket.getsockname()[1]) for link in (vehicle, thief))
    assert {alert.values["believed"].rpartition(":")[2], alert.values["other"].rpartition(":")[2]} == {own, other}
    if first == "uav":
        assert UavLink.objects.get(uav=uav).address.endswith(f":{own}")


@db
def test_command_to_a_uav_whose_frames_are_copied_is_carried_out_by_it(tmp_path):
    uav, key = signed_uav(7, a_user())
    vehicle = Px4(7, is_armed=True, is_in_air=True, custom_mode=_number(MISSION))
    with ExitStack() as running:
        gateway = running.enter_context(gateway_at_work(tmp_path))
        thief = running.enter_context(Link(port_of(gateway), 7))
        with CopiedFlyer(vehicle, port_of(gateway), key=key, thief=thief):
            wait_for(lambda: UavLink.objects.filter(uav=uav, last_message_at__isnull=False).exists())
            hold = queue_command(uav=uav, kind=CommandKind.HOLD, actor=None)

            def is_applied() -> bool:
                hold.refresh_from_db()
                return hold.state == CommandState.APPLIED

            wait_for(is_applied, patience_s=15.0)
            assert vehicle.custom_mode == _number(HOLD), "noted as applied, and the UAV never got it"
            assert thief.received(), "who copies may hear the answers, as whoever listens does"


@db
def test_frames_of_before_a_restart_are_refused_though_they_were_never_stored(tmp_path):
    _, key = signed_uav(3, a_user())
    with gateway_at_work(tmp_path, name="one") as gateway, Link(port_of(gateway), 3, key) as vehicle:
        vehicle.send(heartbeat(), position(1_000))
        wait_for(lambda: TelemetryRecord.objects.count() == 1)
        writer = vehicle.writer
    kept = [writer.frame_of(position(2_000 + n, lon=20.0), time.time()) for n in range(5)]  # while no gateway was there
    time.sleep(sender_authentication.LATE_BY_S + 0.2)
    with gateway_at_work(tmp_path, name="one") as gateway, Link(port_of(gateway), 3, key) as vehicle:
        vehicle.send_raw(*kept)
        vehicle.writer = writer

        def goes_on() -> bool:
            vehicle.send(position(3_000))
            return TelemetryRecord.objects.filter(sequence=3_000).exists()

        wait_for(goes_on)
        losses = gateway.sessions[3].losses
        assert (losses["before-start"], losses["replayed"]) == (5, 0), losses
    assert not TelemetryRecord.objects.filter(sequence__gte=2_000, sequence__lt=3_000).exists()


@db
def test_vehicle_whose_clock_is_late_is_heard_at_once_after_a_restart(tmp_path):
    """By as much as it was late before."""
    _, key = signed_uav(3, a_user())
    writer = FrameWriter(3, 1, key=key)
    for number, name in ((1_000, "one"), (2_000, "two")):
        with gateway_at_work(tmp_path, name=name) as gateway, Link(port_of(gateway), 3, key) as vehicle:
            began_s = time.monotonic()

            def stored(vehicle=vehicle, number=number) -> bool:
                vehicle.send_raw(writer.frame_of(heartbeat(), time.time() - 20.0), writer.frame_of(position(number), time.time() - 20.0))
                time.sleep(0.1)
                return TelemetryRecord.objects.filter(sequence=number).exists()

            wait_for(stored)
            if name == "two":
                assert time.monotonic() - began_s < 10.0


def _number(sub_mode: int) -> int:
    return PX4_AUTO << 16 | sub_mode << 24


# Addresses by themselves


@dataclass(frozen=True)
class _Peer:
    name: str

    def send(self, frame: bytes) -> None: ...


UAV, THIEF = _Peer("udp:10.0.0.1:1"), _Peer("udp:10.0.0.9:9")
STREAM = "1:0"


def test_new_address_is_answered_at_once_and_is_the_uavs_once_it_alone_was_heard_for_a_while():
    known = Addresses()
    for at_s in range(5):
        known.take(STREAM, at_s, UAV, float(at_s))
    known.take(STREAM, 10, THIEF, 4.5)
    assert (known.main, known.answered(4.5)) == (UAV, [UAV, THIEF])
    for step in range(20):
        at_s = 5.0 + step / 2
        known.take(STREAM, 11 + step, THIEF, at_s)
        if at_s < 4.0 + addresses.MOVE_AFTER_S:
            assert known.main == UAV
    assert (known.main, known.answered(14.5)) == (THIEF, [THIEF])


def test_the_uavs_place_is_kept_as_long_as_it_brings_its_frames_however_late():
    known = Addresses()
    known.take(STREAM, 0, UAV, 0.0)
    for step in range(1, 60):
        known.take(STREAM, step, THIEF, step / 2)
        assert known.copy(STREAM, step, UAV, step / 2 + 0.1)
    assert known.main == UAV
    assert known.copied == (THIEF.name, pytest.approx(29.6))


def test_a_frame_that_is_sent_again_later_gets_no_answer():
    known = Addresses()
    known.take(STREAM, 0, UAV, 0.0)
    assert not known.copy(STREAM, 0, THIEF, addresses.SAME_WITHIN_S + 0.1)
    assert not known.copy(STREAM, 99, THIEF, 0.1)
    assert known.answered(0.2) == [UAV]


def test_many_addresses_of_one_host_do_not_keep_another_out():
    known = Addresses()
    for port in range(1, MAX_ADDRESSES + 5):
        known.take(STREAM, port, _Peer(f"udp:10.0.0.9:{port}"), port / 100)
    known.copy(STREAM, MAX_ADDRESSES + 4, UAV, 0.2)
    assert UAV in known.answered(0.3)
    assert len(known.answered(0.3)) == MAX_ADDRESSES
