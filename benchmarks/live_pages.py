"""How long a datagram of a UAV takes to the browsers that watch it, and whether one is lost on the way.

    python -m benchmarks.live_pages [--uavs 200] [--pages 50] [--seconds 180] [--curve] [--write]

With real programs, each a process of its own: UAVs that send MAVLink by UDP once a second, the gateway, the database of the settings, a
Redis, the websocket program, nginx, and pages that do with each word what the browser's do. With --curve smaller and larger loads are
tried as well, for a third of a minute each. With --write the table goes to docs/performance.md. The UAVs and their records are removed
afterwards. Exits with 1 where a report was lost, or one of twenty took half a second or longer.
"""

import argparse
import json
import multiprocessing
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import django

os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
django.setup()

from django.conf import settings  # noqa: E402
from django.contrib.auth import BACKEND_SESSION_KEY, HASH_SESSION_KEY, SESSION_KEY  # noqa: E402
from django.contrib.gis.geos import Point  # noqa: E402
from django.contrib.sessions.backends.db import SessionStore  # noqa: E402
from django.db import connection  # noqa: E402
from pymavlink.dialects.v20 import ardupilotmega as mavlink  # noqa: E402

from benchmarks.gateway_rate import free_port, gateway  # noqa: E402
from benchmarks.live_clients import FIRST_DEG, PER_DEGREE  # noqa: E402
from benchmarks.report import machine, table, write_section  # noqa: E402
from missions.mavlink.signing import FrameWriter  # noqa: E402
from missions.models import Uav  # noqa: E402
from scripts.places import Places  # noqa: E402
from scripts.programs import web_programs  # noqa: E402
from scripts.proxy import configuration  # noqa: E402
from scripts.system_packages import find_program  # noqa: E402
from telemetry.models import TelemetryRecord  # noqa: E402
from workspace.models import Organisation, User  # noqa: E402

ROOT = Path(__file__).resolve().parents[1]
BAR_P95_MS = 500.0
FIRST_SYSTEM = 2
MOST_SYSTEMS = 253
WARM_UP_S = 3.0
SETTLES_S = 6.0
CURVE = ((20, 10), (50, 50), (100, 50), (200, 10), (200, 100), (250, 50))
CURVE_S = 20.0
NAME = "live pages' benchmark"


@dataclass(frozen=True)
class Run:
    uavs: int
    pages: int
    sent: int
    stored: int
    seen_share: float  # of what was sent, by the page that saw the least
    gaps: int
    errors: list[str]
    waits_ms: list[int]
    cores: dict[str, float]
    kilobytes_s: float  # to one page

    def wait_ms(self, percent: float) -> float:
        waits = sorted(self.waits_ms)
        return float(waits[min(int(len(waits) * percent / 100), len(waits) - 1)]) if waits else float("inf")

    @property
    def is_passed(self) -> bool:
        whole = self.stored == self.sent and not self.gaps and not self.errors and self.seen_share == 1.0
        return whole and self.wait_ms(95) < BAR_P95_MS


@contextmanager
def running(command: list[str], **environment: str) -> Iterator[subprocess.Popen[bytes]]:
    process = subprocess.Popen(command, cwd=ROOT, env=os.environ | environment, stdout=subprocess.DEVNULL)  # which tells of each request
    try:
        yield process
    finally:
        process.terminate()
        process.wait(30)


@contextmanager
def front_door() -> Iterator[tuple[int, dict[str, int]]]:
    """The port, and the processes behind it by name. Its Redis is that of whoever runs inside."""
    folder = Path(tempfile.mkdtemp(prefix="sw-", dir="/tmp"))  # short enough for sockets
    places = Places(folder)
    places.process("proxy").mkdir(parents=True)
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    (folder / "nginx.conf").write_text(configuration(places, folder, port))
    live = next(program for program in web_programs(places, folder) if program.name == "live").command
    redis = [find_program("redis-server") or "redis-server", "--port", "0", "--unixsocket", str(folder / "redis.sock"), "--save", ""]
    nginx = [find_program("nginx") or "nginx", "-e", "stderr", "-c", str(folder / "nginx.conf")]
    own = {"REDIS_URL": f"unix://{folder / 'redis.sock'}", "SPANWISE_SECRET_KEY": settings.SECRET_KEY}
    try:
        with ExitStack() as stack:
            started = {
                "redis": stack.enter_context(running([*redis, "--logfile", os.devnull])),
                "live": stack.enter_context(running(live, **own)),
                "nginx": stack.enter_context(running(nginx)),
            }
            os.environ["REDIS_URL"] = own["REDIS_URL"]  # for the gateway
            until_s = time.monotonic() + 30
            while not (folder / "live.sock").exists() and time.monotonic() < until_s:
                time.sleep(0.1)
            yield port, {name: process.pid for name, process in started.items()}
    finally:
        shutil.rmtree(folder)


def play(port: int, systems: list[int], seconds: float, began_s: float, told: Any) -> None:
    """Each UAV sends a heartbeat, its attitude and where it is once a second, all of them evenly spread; tells what it sent."""
    sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sender.connect(("127.0.0.1", port))
    writers = {system: FrameWriter(system, 1) for system in systems}
    sent: dict[int, list[int]] = {system: [] for system in systems}
    every_s = 1.0 / len(systems)
    first_s = time.monotonic()
    for number in range(int(seconds * len(systems))):
        time.sleep(max(first_s + number * every_s - time.monotonic(), 0.0))
        system = systems[number % len(systems)]
        ms = int((time.monotonic() - began_s) * 1000)
        place = round(FIRST_DEG * PER_DEGREE) + ms
        for message in (
            mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_QUADROTOR, mavlink.MAV_AUTOPILOT_PX4, 209, 0, 4, 3),
            mavlink.MAVLink_attitude_message(ms, 0.1, 0.2, 0.3, 0.0, 0.0, 0.0),
            mavlink.MAVLink_global_position_int_message(ms, 550_000_000, place, 30_000, 20_000, 100, 0, 0, 9_000),
        ):
            sender.send(writers[system].frame_of(message, 0.0))
        sent[system].append(ms)
    told.put(sent)


def cpu_s(pid: int) -> float:
    """Of a process and all below it."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    own = (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    return own + sum(cpu_s(int(child)) for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split())


def cookie_of(user: User) -> str:
    session = SessionStore()
    session[SESSION_KEY], session[BACKEND_SESSION_KEY] = str(user.pk), settings.AUTHENTICATION_BACKENDS[0]
    session[HASH_SESSION_KEY] = user.get_session_auth_hash()
    session.create()
    return f"{settings.SESSION_COOKIE_NAME}={session.session_key}"


@contextmanager
def fleet(number: int) -> Iterator[tuple[list[Uav], User]]:
    organisation = Organisation.objects.create(name=f"{NAME} {time.time():.0f}")
    user = User.objects.create_user(f"benchmark-{time.time():.0f}", organisation=organisation)
    taken = set(Uav.objects.filter(mavlink_system_id__isnull=False).values_list("mavlink_system_id", flat=True))
    systems = [system for system in range(FIRST_SYSTEM, FIRST_SYSTEM + MOST_SYSTEMS) if system not in taken][:number]
    facts: dict[str, Any] = {"organisation": organisation, "location": Point(10, 55, srid=4326), "allows_unsigned": True}
    uavs = [Uav.objects.create(name=f"benchmark {system}", mavlink_system_id=system, **facts) for system in systems]
    try:
        yield uavs, user
    finally:
        keys = [uav.pk for uav in uavs]
        with connection.cursor() as cursor:
            cursor.execute("DELETE FROM telemetry_telemetryrecord WHERE uav_id = ANY(%s)", [keys])
        Uav.objects.filter(pk__in=keys).delete()
        user.delete()
        organisation.delete()


def run(number: int, pages: int, seconds: float) -> Run:
    udp = free_port()
    with fleet(number) as (uavs, user), front_door() as (port, programs), gateway(udp) as program:
        programs["gateway"] = program.pid
        time.sleep(WARM_UP_S)
        began_s = time.monotonic()
        command = [sys.executable, "-m", "benchmarks.live_clients", "--port", str(port), "--began", str(began_s)]
        clients = subprocess.Popen(command, cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        if clients.stdin is None or clients.stdout is None:
            raise SystemExit("the pages do not open")
        clients.stdin.write(" ".join(cookie_of(user) for _ in range(pages)) + "\n")
        clients.stdin.flush()
        clients.stdout.readline()
        time.sleep(WARM_UP_S)
        programs["pages"] = clients.pid
        before_s = {name: cpu_s(pid) for name, pid in programs.items()}
        context = multiprocessing.get_context("spawn")
        told: Any = context.Queue()
        systems = [uav.mavlink_system_id for uav in uavs]
        player = context.Process(target=play, args=(udp, systems, seconds, began_s, told))
        player.start()
        sent = told.get()
        cores = {name: (cpu_s(pid) - before_s[name]) / seconds for name, pid in programs.items()}
        player.join()
        time.sleep(SETTLES_S)
        clients.stdin.write("\n")
        clients.stdin.flush()
        saw = json.loads(clients.stdout.readline())
        clients.wait(30)
        stored = TelemetryRecord.objects.filter(uav__in=uavs).count()
    by_uav = {str(uav.pk): set(sent[uav.mavlink_system_id]) for uav in uavs}
    return _summed(number, pages, by_uav, stored, saw, cores, seconds)


def _summed(
    number: int, pages: int, sent: dict[str, set[int]], stored: int, saw: list[dict[str, Any]], cores: dict[str, float], seconds: float
) -> Run:
    all_sent = sum(len(reports) for reports in sent.values())
    shares = [sum(len(reports & set(page["seen"].get(uav, []))) for uav, reports in sent.items()) / all_sent for page in saw]
    return Run(
        uavs=number,
        pages=pages,
        sent=all_sent,
        stored=stored,
        seen_share=min(shares),
        gaps=sum(page["gaps"] for page in saw),
        errors=[page["error"] for page in saw if page["error"]],
        waits_ms=[wait for page in saw for wait in page["waits_ms"]],
        cores=cores,
        kilobytes_s=sum(page["bytes"] for page in saw) / pages / seconds / 1000,
    )


HEAD = [
    "UAVs",
    "pages",
    "sent",
    "lost",
    "seen by each page",
    "p50 ms",
    "p95 ms",
    "p99 ms",
    "kB/s a page",
    "cores: gateway, live, nginx, pages",
]


def cells(done: Run) -> list[str]:
    cores = ", ".join(f"{done.cores[name]:.2f}" for name in ("gateway", "live", "nginx", "pages"))
    waits = [f"{done.wait_ms(percent):.0f}" for percent in (50, 95, 99)]
    lost = f"{done.sent - done.stored}"
    return [str(done.uavs), str(done.pages), f"{done.sent:,}", lost, f"{done.seen_share:.2%}", *waits, f"{done.kilobytes_s:.0f}", cores]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--uavs", type=int, default=200)
    parser.add_argument("--pages", type=int, default=50)
    parser.add_argument("--seconds", type=float, default=180.0)
    parser.add_argument("--curve", action="store_true", help="smaller and larger loads as well")
    parser.add_argument("--write", action="store_true", help="into docs/performance.md")
    options = parser.parse_args()
    runs = []
    for uavs, pages, seconds in [
        (options.uavs, options.pages, options.seconds),
        *([(*load, CURVE_S) for load in CURVE] if options.curve else []),
    ]:
        runs.append(run(uavs, pages, seconds))
        print(" | ".join(cells(runs[-1])), runs[-1].errors[:3] or "", flush=True)
    asked = runs[0]
    text = (
        f"`python -m benchmarks.live_pages`: {asked.uavs} UAVs that report once a second and {asked.pages} open pages for "
        f"{options.seconds:.0f} s; of a datagram's way to the browser 95 of 100 took at most {asked.wait_ms(95):.0f} ms, "
        f"{asked.sent - asked.stored} were lost. Everything ran on this machine: UAVs, gateway, PostgreSQL, Redis, the websocket program, "
        f"nginx, and the pages. {machine('granian', 'channels', 'redis', 'pymavlink', 'psycopg', 'django')}"
    )
    text += "\n\n" + table(HEAD, [cells(done) for done in sorted(runs, key=lambda done: (done.uavs, done.pages))])
    print(text)
    if options.write:
        write_section("From a UAV's datagram to the browsers that watch it", text)
    sys.exit(not asked.is_passed)


if __name__ == "__main__":
    main()
