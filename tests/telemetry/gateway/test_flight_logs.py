"""A log of each flight, in the form that the tools of MAVLink read."""

import asyncio
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
from pymavlink import mavutil
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from telemetry.gateway.flights import DISARMED_FOR_S, FlightRecorder, Flights
from telemetry.gateway.options import GatewayOptions
from telemetry.models import FlightLog
from tests.accounts.users import a_user
from tests.telemetry.gateway.station import Link, gateway_at_work, heartbeat, port_of, position, signed_uav, unsigned_uav, wait_for


@pytest.fixture(autouse=True)
def own_folder(settings, tmp_path):
    settings.FLIGHT_LOG_DIR = tmp_path


def names_in(path) -> list[str]:
    log = mavutil.mavlink_connection(str(path), dialect="ardupilotmega")
    names = []
    while (message := log.recv_match()) is not None:
        names.append(message.get_type())
    return names


@pytest.mark.django_db(transaction=True)
def test_a_flight_is_logged_from_arming_to_disarming(tmp_path):
    uav = unsigned_uav()
    with gateway_at_work(tmp_path) as gateway, Link(port_of(gateway)) as vehicle:
        vehicle.send(heartbeat(), position(1_000))
        wait_for(lambda: gateway.sessions and gateway.sessions[1].lease)
        vehicle.send(heartbeat(is_armed=True))
        for number in range(100):
            vehicle.send(position(2_000 + number * 200))
        wait_for(lambda: FlightLog.objects.filter(uav=uav, ended_at=None).exists())
        vehicle.send(heartbeat())
        wait_for(lambda: FlightLog.objects.filter(ended_at__isnull=False).exists())
        vehicle.send(position(90_000))
    log = FlightLog.objects.get()
    path = tmp_path / log.path
    assert (log.uav, log.size_bytes) == (uav, path.stat().st_size)
    names = names_in(path)
    assert names.count("GLOBAL_POSITION_INT") == 100
    assert "BAD_DATA" not in names
    dumper = Path(sys.executable).with_name("mavlogdump.py")  # comes with pymavlink
    dumped = subprocess.run(  # noqa: S603
        [sys.executable, dumper, "--types", "GLOBAL_POSITION_INT", str(path)], capture_output=True, text=True, timeout=60, check=True
    )
    assert dumped.stdout.count("GLOBAL_POSITION_INT {") == 100


@pytest.mark.django_db(transaction=True)
def test_both_directions_are_logged_and_no_key_is(tmp_path):
    uav, key = signed_uav(5, a_user())
    with gateway_at_work(tmp_path) as gateway, Link(port_of(gateway), 5, key) as vehicle:
        vehicle.send(heartbeat(is_armed=True))
        wait_for(lambda: gateway.sessions and gateway.sessions[5].log)
        vehicle.send(mavlink.MAVLink_setup_signing_message(255, 190, list(key), 1), position(1_000))
        wait_for(lambda: [message for message in vehicle.received() if message.get_type() == "HEARTBEAT"])
    content = (tmp_path / FlightLog.objects.get(uav=uav).path).read_bytes()
    assert key not in content and key[:16] not in content
    names = names_in(tmp_path / FlightLog.objects.get().path)
    assert "GLOBAL_POSITION_INT" in names and "COMMAND_LONG" in names and "SETUP_SIGNING" not in names


@pytest.mark.django_db(transaction=True)
def test_a_log_that_a_dead_gateway_left_open_is_closed_by_the_next(tmp_path):
    uav = unsigned_uav()
    (tmp_path / "left.tlog").write_bytes(b"x" * 99)
    FlightLog.objects.create(uav=uav, path="left.tlog", started_at="2026-01-01T00:00:00Z")
    with gateway_at_work(tmp_path) as gateway, Link(port_of(gateway)) as vehicle:
        vehicle.send(heartbeat(is_armed=True))
        left = wait_for(lambda: FlightLog.objects.filter(path="left.tlog", ended_at__isnull=False).first())
    assert left.size_bytes == 99
    assert FlightLog.objects.filter(ended_at=None).count() == 0


def test_a_vehicle_that_arms_and_disarms_all_the_time_keeps_to_one_file(tmp_path):
    flights = Flights(GatewayOptions(udp=[], tcp=[], name="test", log_dir=tmp_path))
    uav, state = SimpleNamespace(uav_id=1, system=7, name="Tern"), SimpleNamespace(is_armed=True)
    session = SimpleNamespace(uav=uav, state=state, log=None, last_message_s=1_000.0)
    for number in range(200):
        state.is_armed = number % 2 == 0
        flights.watch(session, 1_000.0 + number / 100)
    assert len(list(tmp_path.rglob("*.tlog"))) == 1 and session.log is not None
    asyncio.run(flights.sync(1_002.0 + DISARMED_FOR_S))
    assert session.log is None
    state.is_armed = True
    flights.watch(session, 1_010.0)
    assert len(list(tmp_path.rglob("*.tlog"))) == 2, "the next flight"
    flights.end_all(1_011.0)


def test_a_log_is_not_longer_than_it_may_be(tmp_path):
    recorder = FlightRecorder(tmp_path / "uav" / "a.tlog", most_bytes=100)
    for _ in range(20):
        recorder.write(b"0123456789", 0, 1.0)
    recorder.close()
    assert not recorder.is_complete
    assert (tmp_path / "uav" / "a.tlog").stat().st_size == recorder.size_bytes == 90


def test_a_folder_that_cannot_be_written_stops_nothing(tmp_path):
    (tmp_path / "file").write_text("")
    recorder = FlightRecorder(tmp_path / "file" / "a.tlog", most_bytes=100)
    recorder.write(b"0123456789", 0, 1.0)
    recorder.sync()
    recorder.close()
    assert not recorder.is_complete
