"""How many records a second a gateway takes from its sockets into rows without losing one.

    python -m benchmarks.telemetry.gateway_rate [--seconds 10] [--vehicles 20] [--start 1000] [--write]

A gateway of its own process, on the database of the settings, hears vehicles that another process plays: each report is a
GLOBAL_POSITION_INT with an ATTITUDE before it, each in a datagram of its own. The rate goes up by a quarter from step to step until a
report is missing; where one is missing at the first step, down until none is. The UAVs and their records are removed afterwards. With
--write the table goes to docs/performance.md. Exits with 1 where the bar is missed.
"""

import argparse
import multiprocessing
import os
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import django

os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
django.setup()

from django.contrib.gis.geos import Point  # noqa: E402
from django.db import connection  # noqa: E402
from pymavlink.dialects.v20 import ardupilotmega as mavlink  # noqa: E402

from benchmarks.report import machine, table, write_section  # noqa: E402
from mavlink.signing import FrameWriter  # noqa: E402
from missions.models import Uav  # noqa: E402
from telemetry.models import TelemetryRecord  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
BAR_HZ = 2_000.0
FACTOR = 1.25
SETTLES_S = 8.0
FIRST_SYSTEM = 100
BURST_S = 0.005


@dataclass(frozen=True)
class Step:
    wanted_hz: float
    sent: int
    stored: int
    took_s: float
    cpu_s: float

    @property
    def sent_hz(self) -> float:
        return self.sent / self.took_s

    @property
    def is_whole(self) -> bool:
        return self.stored == self.sent


OTHER_SENDER_S = 6.0  # each step has a socket of its own, which is believed once the one before was silent for so long


def free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@contextmanager
def gateway(port: int) -> Iterator[subprocess.Popen[str]]:
    with TemporaryDirectory() as logs:
        command = [sys.executable, "manage.py", "run_gateway", "--udp", f"127.0.0.1:{port}", "--tcp", "", "--name", "benchmark"]
        environment = os.environ | {"SPANWISE_LOG_DIR": logs, "SPANWISE_LOG_LEVEL": "WARNING"}
        process = subprocess.Popen(command, cwd=ROOT, env=environment, stdout=subprocess.PIPE, text=True)
        if process.stdout is None or "listening" not in process.stdout.readline():
            raise SystemExit("the gateway does not listen")
        try:
            yield process
        finally:
            process.terminate()
            process.wait(30)


def play(port: int, systems: list[int], rate_hz: float, seconds: float, first_ms: int, reported: Any) -> None:
    """Sends as many reports a second; tells how many it has sent, and how long that took."""
    sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sender.connect(("127.0.0.1", port))
    writers = {system: FrameWriter(system, 1) for system in systems}
    for system in systems:
        beat = mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_QUADROTOR, mavlink.MAV_AUTOPILOT_PX4, 209, 0, 4, 3)
        sender.send(writers[system].frame_of(beat, 0.0))
    step_ms = max(int(1000 * len(systems) / rate_hz), 1)
    reports = []
    for number in range(int(rate_hz * seconds)):
        system, boot_ms = systems[number % len(systems)], first_ms + number // len(systems) * step_ms
        attitude = mavlink.MAVLink_attitude_message(boot_ms, 0.1, 0.2, 0.3, 0.0, 0.0, 0.0)
        position = mavlink.MAVLink_global_position_int_message(boot_ms, 550_000_000 + number, 100_000_000, 30_000, 20_000, 100, 0, 0, 9_000)
        reports.append((writers[system].frame_of(attitude, 0.0), writers[system].frame_of(position, 0.0)))
    began_s = time.monotonic()
    for number, report in enumerate(reports):
        ahead_s = began_s + number / rate_hz - time.monotonic()
        if ahead_s > BURST_S:
            time.sleep(ahead_s)
        for datagram in report:
            sender.send(datagram)
    reported.put((len(reports), time.monotonic() - began_s))


def cpu_s(process: subprocess.Popen[str]) -> float:
    fields = Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def step(port: int, program: subprocess.Popen[str], uavs: list[Uav], rate_hz: float, seconds: float, first_ms: int) -> Step:
    before, began_cpu_s = TelemetryRecord.objects.filter(uav__in=uavs).count(), cpu_s(program)
    reported: Any = multiprocessing.get_context("spawn").Queue()
    systems = [uav.mavlink_system_id for uav in uavs]
    player = multiprocessing.get_context("spawn").Process(target=play, args=(port, systems, rate_hz, seconds, first_ms, reported))
    player.start()
    sent, took_s = reported.get()
    player.join()
    until_s = time.monotonic() + SETTLES_S
    while (stored := TelemetryRecord.objects.filter(uav__in=uavs).count() - before) < sent and time.monotonic() < until_s:
        time.sleep(0.2)
    return Step(rate_hz, sent, stored, took_s, cpu_s(program) - began_cpu_s)


def next_rate_hz(steps: list[Step], first_hz: float) -> float | None:
    """None: the highest rate without loss lies between two steps, or below the bar."""
    if not steps:
        return first_hz
    last = steps[-1]
    if last.is_whole:
        has_lost = any(not done.is_whole for done in steps)
        return None if has_lost else last.wanted_hz * FACTOR
    has_kept = any(done.is_whole for done in steps)
    return None if has_kept or last.wanted_hz < BAR_HZ else last.wanted_hz / FACTOR


def cells(done: Step) -> list[str]:
    return [f"{done.sent_hz:,.0f}", f"{done.sent:,}", f"{done.stored:,}", f"{done.cpu_s / done.took_s:.2f}"]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--vehicles", type=int, default=20)
    parser.add_argument("--start", type=float, default=1_000.0, help="records a second of the first step")
    parser.add_argument("--write", action="store_true", help="into docs/performance.md")
    options = parser.parse_args()
    at = Point(10, 55, srid=4326)
    uavs = [
        Uav.objects.create(name=f"benchmark {system}", location=at, mavlink_system_id=system, allows_unsigned=True)
        for system in range(FIRST_SYSTEM, FIRST_SYSTEM + options.vehicles)
    ]
    port, first_ms = free_port(), 1_000
    steps: list[Step] = []
    try:
        with gateway(port) as program:
            time.sleep(2)
            while (rate_hz := next_rate_hz(steps, options.start)) is not None:
                steps.append(step(port, program, uavs, rate_hz, options.seconds, first_ms))
                print(" | ".join(cells(steps[-1])), flush=True)
                first_ms += int(options.seconds * 1000 * FACTOR) + 60_000
                time.sleep(OTHER_SENDER_S)
    finally:
        with connection.cursor() as cursor:
            cursor.execute("DELETE FROM telemetry_telemetryrecord WHERE uav_id = ANY(%s)", [[uav.pk for uav in uavs]])
        Uav.objects.filter(pk__in=[uav.pk for uav in uavs]).delete()
    steps.sort(key=lambda done: done.wanted_hz)
    best = max((done.sent_hz for done in steps if done.is_whole), default=0.0)
    head = ["records a second sent", "sent", "stored", "cores of the gateway"]
    command = f"python -m benchmarks.telemetry.gateway_rate --seconds {options.seconds:g} --start {options.start:g}"
    text = (
        f"`{command}`: {best:,.0f} records a second of {options.vehicles} vehicles without losing one, each with a second message, "
        f"through one socket. {machine('pymavlink', 'psycopg', 'django')}"
    )
    text += "\n\n" + table(head, [cells(done) for done in steps])
    print(text)
    if options.write:
        write_section("From a gateway's socket into rows", text)
    sys.exit(best < BAR_HZ)


if __name__ == "__main__":
    main()
