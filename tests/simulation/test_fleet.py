"""Batches of simulated UAVs on sockets: what is changed in flight, what is lost, and the command that flies them."""

import json
import os
import signal
import socket
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import pytest
from django.core.management import CommandError, call_command
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from inspection.geodesy import LonLat
from mavlink.frames import frames_of_datagram, message_of
from mavlink.signing import FrameWriter, SignatureCheck
from simulation.flight.faults import Faults
from simulation.vehicle_endpoint.fleet import InvalidSpeed, VehicleChange, WrongOrder, change_of
from simulation.vehicle_endpoint.launch import Launch, fleet_of, in_a_row
from simulation.vehicle_endpoint.radio import InvalidStationAddress, Radio, address_of
from tests.simulation.fleets import AT, flying, free_port, wait_for

PROJECT_DIR = Path(__file__).resolve().parents[2]
KEY = bytes(range(32))


class Ear:
    """A station's socket; `received` are the messages of all that came since it was asked last."""

    def __init__(self, port: int = 0) -> None:
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", port))
        self.socket.setblocking(False)
        self.port = self.socket.getsockname()[1]
        self.writer = FrameWriter(255, 190)

    def received(self):
        found = []
        while True:
            try:
                datagram = self.socket.recv(65_535)
            except BlockingIOError:
                return found
            found += [(frame, message_of(frame)) for frame in frames_of_datagram(datagram, Counter())]

    def receives(self, kind, system=None):
        return [message for frame, message in self.received() if message.get_type() == kind and system in (None, frame.system)]

    def notify(self, port, message):
        self.socket.sendto(self.writer.frame_of(message, time.time()), ("127.0.0.1", port))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.socket.close()


def test_all_uavs_of_a_batch_talk_to_all_given_and_to_who_asks():
    with Ear() as given, Ear() as asking:
        launches = [Launch(system, place, talks_to=[("127.0.0.1", given.port)]) for system, place in enumerate(in_a_row(AT, 3, 20.0), 1)]
        with flying(launches, speed=10.0) as fleet:
            systems: set[int] = set()
            wait_for(lambda: systems.update(frame.system for frame, _ in given.received()) or systems == {1, 2, 3})
            asking.notify(fleet.uavs[1].radio.port, mavlink.MAVLink_param_request_read_message(2, 1, b"RTL_TYPE", -1))
            wait_for(lambda: asking.receives("PARAM_VALUE", 2), "the answer")
            wait_for(lambda: asking.receives("GLOBAL_POSITION_INT", 2), "what all are told")
            given.received()
            asking.notify(fleet.uavs[1].radio.port, mavlink.MAVLink_param_request_read_message(2, 1, b"RTL_TYPE", -1))
            wait_for(lambda: asking.receives("PARAM_VALUE", 2))
            assert given.receives("PARAM_VALUE") == [], "an answer is for who asked"


def test_one_that_is_ended_is_silent_and_lets_its_port_go_while_the_others_fly_on():
    with Ear() as ear:
        launches = [Launch(system, place, talks_to=[("127.0.0.1", ear.port)]) for system, place in enumerate(in_a_row(AT, 2, 20.0), 1)]
        with flying(launches, speed=10.0) as fleet:
            wait_for(lambda: ear.receives("HEARTBEAT", 1), "the first one")
            port = fleet.uavs[0].radio.port
            fleet.post(VehicleChange(system=1, ends=True))
            wait_for(lambda: fleet.uavs[0].radio.socket.fileno() < 0, "its end")
            ear.received()
            wait_for(lambda: ear.receives("HEARTBEAT", 2), "the other one")
            wait_for(lambda: 1 not in {frame.system for frame, _ in ear.received()}, "silence")
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as another:
                another.bind(("127.0.0.1", port))
            assert fleet.report().failed == 0


def test_a_lost_link_is_lost_both_ways_for_as_long_as_simulated_time_says():
    with Ear() as ear:
        launch = Launch(1, AT, faults=Faults(link_lost_until_s=4.0), talks_to=[("127.0.0.1", ear.port)])
        with flying([launch], speed=10.0) as fleet:
            uav = fleet.uavs[0]
            ear.notify(uav.radio.port, mavlink.MAVLink_command_long_message(1, 1, 400, 0, 1, 0, 0, 0, 0, 0, 0))
            wait_for(lambda: uav.uav.now_s >= 3.0)
            assert ear.received() == [] and uav.received_count == 0 and not uav.uav.state.is_armed
            wait_for(lambda: ear.receives("HEARTBEAT"))
            fleet.post(change_of('{"faults": {"link_lost_for_s": 5}}'))
            wait_for(lambda: uav.uav.faults.link_lost_until_s > 5.0)
            ear.received()
            wait_for(lambda: ear.receives("GLOBAL_POSITION_INT"))
            assert uav.uav.now_s >= 8.0


def test_weather_faults_and_pace_change_in_flight_for_one_or_all():
    launches = [Launch(system, place) for system, place in enumerate(in_a_row(AT, 2, 20.0), 1)]
    with flying(launches, speed=1.0) as fleet:
        one, other = (flying_uav.uav for flying_uav in fleet.uavs)
        fleet.post(change_of('{"system": 2, "weather": {"wind": [8, 270], "gusts_mps": 2}, "faults": {"motor_failed": 1}}'))
        wait_for(lambda: other.faults.motor_failed == 1)
        assert other.weather.gusts_mps == 2 and other.weather.conditions.wind[0].speed_mps == 8
        assert one.weather.gusts_mps == 0 and one.faults.motor_failed is None
        fleet.post(change_of('{"faults": {"stuck_item": 3}}'))
        wait_for(lambda: one.faults.stuck_item == 3)
        assert (other.faults.motor_failed, other.faults.stuck_item) == (1, 3), "the faults before stay"
        before_s, began_s = one.now_s, time.monotonic()
        fleet.post(change_of('{"speed": 10}'))
        wait_for(lambda: one.now_s - before_s > 5.0)
        assert time.monotonic() - began_s < 4.0
        with pytest.raises(InvalidSpeed):
            fleet.post(VehicleChange(speed=1_000.0))


def test_a_signed_uav_is_told_by_its_key_and_hears_nobody_else():
    with Ear() as ear, flying([Launch(9, AT, key=KEY, talks_to=[("127.0.0.1", ear.port)])], speed=10.0) as fleet:
        uav = fleet.uavs[0]
        ask = mavlink.MAVLink_param_request_read_message(9, 1, b"RTL_TYPE", -1)
        ear.notify(uav.radio.port, ask)
        wait_for(lambda: uav.refused == 1)
        check = SignatureCheck(KEY)
        frames = [frame for frame, _ in wait_for(ear.received)]
        assert [check.refusal(frame, time.time()) for frame in frames] == [None] * len(frames)
        ear.writer = FrameWriter(255, 190, key=KEY)
        ear.notify(uav.radio.port, ask)
        wait_for(lambda: ear.receives("PARAM_VALUE"))


def test_a_wrong_clock_shows_in_the_time_of_day_until_a_key_sets_it():
    with Ear() as ear:
        launch = Launch(9, AT, key=KEY, faults=Faults(clock_offset_s=-3_600.0), talks_to=[("127.0.0.1", ear.port)])
        with flying([launch], speed=10.0) as fleet:

            def off_s():
                (*_, reported) = wait_for(lambda: ear.receives("SYSTEM_TIME"))
                return reported.time_unix_usec / 1e6 - time.time()

            assert off_s() == pytest.approx(-3_600.0, abs=5.0)
            ear.writer = FrameWriter(255, 190, key=KEY)
            ear.notify(fleet.uavs[0].radio.port, mavlink.MAVLink_ping_message(1, 1, 0, 0))
            wait_for(lambda: abs(off_s()) < 5.0)


def test_a_fault_of_the_program_costs_one_uav_and_not_the_batch(caplog, monkeypatch):
    with flying([Launch(1, AT), Launch(2, AT)], speed=10.0) as fleet:
        one, other = fleet.uavs
        monkeypatch.setattr(one.uav, "step", lambda: 1 / 0)
        wait_for(lambda: fleet.report().failed == 1)
        stood_s, flew_s = one.uav.now_s, other.uav.now_s
        wait_for(lambda: other.uav.now_s > flew_s + 2.0)
        assert one.uav.now_s == stood_s
    assert "simulated UAV 1" in caplog.text


@pytest.mark.parametrize(
    "line",
    [
        "", "[]", "1",
        '{"sytem": 1}', '{"system": "one"}', '{"weather": {"wind": 3}}', '{"weather": {"wind": [8, "west"]}}',
        '{"weather": {"wind": [80, 0]}}', '{"weather": {"gusts_mps": -1}}', '{"faults": {"motor_failed": 7}}',
        '{"faults": {"motor_failed": 1.5}}',
        '{"faults": {"battery_wh_left": -3}}', '{"faults": {"link_lost_for_s": NaN}}',
        '{"speed": true}',
    ],
)  # fmt: skip
def test_orders_that_say_nothing_are_refused(line):
    with pytest.raises(WrongOrder):
        change_of(line)


@pytest.mark.parametrize("text", ["", "localhost", ":14550", "localhost:", "localhost:0", "localhost:70000", "no.such.host.invalid:1"])
def test_addresses_that_are_none(text):
    with pytest.raises(InvalidStationAddress):
        address_of(text)


@pytest.mark.parametrize(("talks_to", "is_alone"), [([], True), ([("127.0.0.1", 9)], True), ([("127.0.0.1", 9), ("192.0.2.1", 9)], False)])
def test_who_only_talks_to_this_machine_is_heard_by_it_alone(talks_to, is_alone):
    radio = Radio(talks_to)
    assert (radio.socket.getsockname()[0] == "127.0.0.1") is is_alone
    radio.close()


def test_a_socket_that_is_taken_is_told_and_none_is_kept():
    with Ear() as ear, pytest.raises(OSError, match="in use"):
        fleet_of([Launch(1, AT), Launch(2, AT, listens_at=("127.0.0.1", ear.port))])


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--at", "north"], "LON,LAT"),
        (["--at", "10,55", "--to", "nowhere"], "HOST:PORT"),
        (["--at", "10,55", "--at", "11,55", "--count", "3"], "--count"),
        (["--at", "10,55", "--first-system", "250", "--count", "2"], "system ids"),
        (["--at", "10,55", "--speed", "0"], "speed"),
        (["--at", "10,55", "--wind", "80,0"], "wind"),
        (["--at", "10,95"], "stands"),
    ],
)
def test_the_command_says_what_is_wrong(options, words):
    with pytest.raises(CommandError, match=words):
        call_command("fly_simulated", *options)


def test_the_command_says_nothing_of_keys(tmp_path):
    keys = tmp_path / "keys.json"
    keys.write_text('{"1": "abcdef0123"}')
    with pytest.raises(CommandError, match=r"keys\.json") as error:
        call_command("fly_simulated", "--at", "10,55", "--keys", str(keys))
    assert "abcdef" not in str(error.value)


@pytest.mark.long
def test_the_command_flies_without_a_database_until_it_is_told_to_stop(tmp_path):
    keys = tmp_path / "keys.json"
    keys.write_text(json.dumps({"12": KEY.hex()}))
    with Ear() as ear:
        command = [
            sys.executable, "manage.py", "fly_simulated", "--at", "10.4,55.4", "--count", "2", "--first-system", "11", "--speed", "10",
            "--autopilot-type", "ardupilot", "--to", f"127.0.0.1:{ear.port}", "--keys", str(keys), "--orders",
        ]  # fmt: skip
        nowhere = {"DATABASE_URL": "postgis://nobody@127.0.0.1:1/none", "REDIS_URL": "redis://127.0.0.1:1/0"}
        pipe = subprocess.PIPE
        with subprocess.Popen(  # noqa: S603
            command, cwd=PROJECT_DIR, env=os.environ | nowhere, stdin=pipe, stdout=pipe, stderr=pipe, text=True
        ) as process:
            try:
                reported: dict[int, bool] = {}
                wait_for(lambda: reported.update({frame.system: frame.is_signed for frame, _ in ear.received()}) or len(reported) == 2)
                assert reported == {11: False, 12: True}
                process.stdin.write('{"speed": 0}\n{"weather": {"wind": [5, 90]}}\n{"system": 11, "faults": {"link_lost_for_s": 10000}}\n')
                process.stdin.flush()
                wait_for(lambda: {frame.system for frame, _ in ear.received()} == {12}, "the lost link")
                process.send_signal(signal.SIGTERM)
                out, err = process.communicate(timeout=20)
            finally:
                process.kill()
        report = json.loads(out.splitlines()[-1])
        assert process.returncode == 0 and report["uavs"] == 2 and report["steps"] > 0
        assert "not done" in err and KEY.hex() not in out + err


def test_places_in_a_row_lie_so_far_apart():
    first, second = in_a_row(LonLat(10.0, 60.0), 2, 111.195)
    assert (second.lat, second.lon - first.lon) == (60.0, pytest.approx(0.002))
    assert free_port() > 0
