"""S2: of a signed link nothing is taken twice, from somebody else, or at a wrong time; each cause is counted, and no key is ever told."""

import logging
import time

import pytest
from django.contrib.gis.geos import Point

from mavlink.signing import FrameWriter
from missions.models import CredentialKind, Uav, UavCredential
from missions.services.fleet.credentials import make_credential
from telemetry.gateway import sender_authentication
from telemetry.models import TelemetryRecord, UavLink
from tests.accounts.users import a_user
from tests.telemetry.gateway.station import Link, gateway_at_work, heartbeat, port_of, position, signed_uav, wait_for

pytestmark = pytest.mark.django_db(transaction=True)


@pytest.fixture
def uav_and_key():
    return signed_uav(3, a_user())


def losses(uav) -> dict[str, int]:
    link = UavLink.objects.filter(uav=uav).first()
    return link.losses if link else {}


def test_what_a_signed_link_refuses(uav_and_key, tmp_path, caplog):
    uav, key = uav_and_key
    caplog.set_level(logging.DEBUG)
    now_s = time.time()
    with gateway_at_work(tmp_path) as gateway, Link(port_of(gateway), 3, key) as vehicle:
        good = [vehicle.frame(heartbeat()), *(vehicle.frame(position(1_000 + n)) for n in range(10))]
        vehicle.send_raw(*good)
        wait_for(lambda: TelemetryRecord.objects.count() == 10)
        bad = position(9_000, lon=20.0)
        vehicle.send_raw(*good)
        vehicle.send_raw(*[FrameWriter(3, 1).frame_of(bad, now_s)] * 2)
        vehicle.send_raw(*[FrameWriter(3, 1, key=b"x" * 32).frame_of(bad, now_s)] * 3)
        vehicle.send_raw(*[FrameWriter(3, 1, link_id=9, key=key).frame_of(bad, now_s - 62)] * 4)
        vehicle.send_raw(*[FrameWriter(3, 1, link_id=9, key=key).frame_of(bad, now_s + 120)] * 5)
        vehicle.send_raw(FrameWriter(3, 1, key=key).frame_of(bad, now_s - 30))  # a restart with an older clock
        vehicle.send(position(2_000))
        wait_for(lambda: TelemetryRecord.objects.count() == 11)
    assert losses(uav) == {"replayed": 11 + 1, "unsigned": 2, "wrong-signature": 3, "too-old": 4, "from-the-future": 5}
    assert not TelemetryRecord.objects.filter(sequence=9_000).exists()
    reported = caplog.text + repr(gateway.sessions)
    for form in (key.hex(), repr(key), key.decode("latin-1"), str(list(key))):
        assert form not in reported


def test_no_other_gateway_and_no_restart_accepts_a_replay(uav_and_key, tmp_path):
    uav, key = uav_and_key
    link = Link(1, 3, key)
    frames = [link.frame(heartbeat()), *(link.frame(position(1_000 + n)) for n in range(5))]
    with gateway_at_work(tmp_path, name="one") as gateway, Link(port_of(gateway), 3, key) as vehicle:
        vehicle.send_raw(*frames)
        wait_for(lambda: TelemetryRecord.objects.count() == 5)
        sent = UavLink.objects.get(uav=uav).signing["sent"]
    with gateway_at_work(tmp_path, name="two") as gateway, Link(port_of(gateway), 3, key) as vehicle:
        vehicle.send_raw(*frames)
        vehicle.send(position(2_000))
        wait_for(lambda: TelemetryRecord.objects.count() == 6)
        received = wait_for(vehicle.received)
    assert losses(uav)["replayed"] == len(frames)
    assert UavLink.objects.get(uav=uav).signing["sent"] > sent
    assert received and link.writer.key == key


def test_a_vehicle_whose_clock_is_late_is_told_the_time(uav_and_key, tmp_path):
    """A vehicle without a clock of its own takes the time of the signed frames that it hears."""
    _, key = uav_and_key
    with gateway_at_work(tmp_path) as gateway, Link(port_of(gateway), 3, key) as vehicle:

        def answered() -> list:
            vehicle.send_raw(vehicle.frame(heartbeat(), time.time() - 1_000))
            return vehicle.received()

        (beat, *_) = wait_for(answered)
    assert beat.get_type() == "HEARTBEAT"
    assert not TelemetryRecord.objects.exists()


def test_the_key_before_counts_until_the_new_one_was_used(uav_and_key, tmp_path):
    uav, key = uav_and_key
    with gateway_at_work(tmp_path) as gateway, Link(port_of(gateway), 3, key) as vehicle:
        vehicle.send(heartbeat(), position(1_000))
        wait_for(lambda: UavCredential.objects.filter(last_used_at__isnull=False).exists())
        new_key = _rotated(uav)
        wait_for(lambda: len(gateway.sessions[3].uav.keys) == 2)
        vehicle.send(position(2_000))
        wait_for(lambda: TelemetryRecord.objects.filter(sequence=2_000).exists(), "the UAV has its old key still")
        vehicle.received()
        (beat, *_) = wait_for(vehicle.received)
        assert beat.get_type()
        with Link(port_of(gateway), 3, new_key) as renewed:

            def stored() -> bool:
                renewed.send(position(3_000))
                return TelemetryRecord.objects.filter(sequence=3_000).exists()

            wait_for(stored)
            wait_for(lambda: len(gateway.sessions[3].uav.keys) == 1)
            renewed.received()
            assert wait_for(renewed.received)
            vehicle.send(position(4_000))
            wait_for(lambda: losses(uav).get("wrong-signature"))
    assert not TelemetryRecord.objects.filter(sequence=4_000).exists()


def test_who_speaks_without_the_key_that_was_shown_is_not_believed_though_unsigned_frames_are_allowed(uav_and_key, tmp_path, monkeypatch):
    """Not even once the UAV is silent, nor by another gateway: its system id would be stolen."""
    monkeypatch.setattr(sender_authentication, "SENDER_SILENT_S", 0.2)
    uav, key = uav_and_key
    Uav.objects.filter(pk=uav.pk).update(allows_unsigned=True)
    for name in ("one", "two"):
        with gateway_at_work(tmp_path, name=name) as gateway, Link(port_of(gateway), 3, key) as vehicle, Link(port_of(gateway), 3) as thief:
            number = 1_000 if name == "one" else 2_000
            vehicle.send(heartbeat(), position(number))
            wait_for(lambda number=number: TelemetryRecord.objects.filter(sequence=number).exists())
            time.sleep(0.5)
            thief.send(heartbeat(), position(9_000, lon=20.0))
            wait_for(lambda gateway=gateway: gateway.sessions[3].losses["unsigned"] >= 2)
            thief.received()
            time.sleep(1.2)
            assert thief.received() == [], "nothing is said to it"
    assert not TelemetryRecord.objects.filter(sequence=9_000).exists()


def _rotated(uav) -> bytes:
    return bytes.fromhex(make_credential(uav=uav, actor=a_user(), kind=CredentialKind.MAVLINK_KEY).secret)


def test_a_uav_with_neither_key_nor_leave_to_be_unsigned_is_not_heard(tmp_path):
    Uav.objects.create(name="Bare", location=Point(0, 0), mavlink_system_id=4)
    with gateway_at_work(tmp_path) as gateway, Link(port_of(gateway), 4) as bare, Link(port_of(gateway), 4, b"k" * 32) as stranger:
        bare.send(heartbeat(), position(1_000))
        stranger.send(heartbeat(), position(1_000))
        wait_for(lambda: gateway.sessions)
    assert not TelemetryRecord.objects.exists() and not UavLink.objects.exists()
