"""How long a datagram of a UAV takes to the browsers that watch it, and whether one is lost on the way.

    python -m benchmarks.telemetry.live_pages [--uavs 200] [--pages 50] [--seconds 180] [--curve] [--write]

With real programs, each a process of its own: UAVs that send MAVLink by UDP once a second, the gateway, the estimator, a Redis, the
websocket program, nginx, and pages that do with each word what the browser's do. Ten UAVs each fly an approved mission, so that there is
something to estimate and to be alerted of. All is in a database of its own on the server of the settings, which is removed afterwards.
With --curve smaller and larger loads are tried as well, for a third of a minute each. With --write the table goes to
docs/performance.md. Exits with 1 where a report was lost, or one of twenty took half a second or longer.
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
import numpy as np

os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
django.setup()

from django.conf import settings  # noqa: E402
from django.contrib.auth import BACKEND_SESSION_KEY, HASH_SESSION_KEY, SESSION_KEY  # noqa: E402
from django.contrib.sessions.backends.db import SessionStore  # noqa: E402
from pymavlink.dialects.v20 import ardupilotmega as mavlink  # noqa: E402

from benchmarks.report import machine, table, write_section  # noqa: E402
from benchmarks.telemetry.gateway_rate import free_port, gateway  # noqa: E402
from benchmarks.telemetry.live_clients import PER_DEGREE  # noqa: E402
from benchmarks.telemetry.live_fleet import GROUND_M, SPEED_MPS, UAVS_A_MISSION, Line, make_site, own_database, put_under_way  # noqa: E402
from mavlink.signing import FrameWriter  # noqa: E402
from scripts.installation.system_packages import find_program  # noqa: E402
from scripts.places import Places  # noqa: E402
from scripts.proxy.proxy import configuration  # noqa: E402
from scripts.supervision.programs import web_programs  # noqa: E402
from telemetry.models import Alert, TelemetryRecord, UavWatch  # noqa: E402
from workspace.models import User  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
BAR_P95_MS = 500.0
WARM_UP_S = 3.0
SETTLES_S = 6.0
CURVE = ((20, 10), (50, 50), (100, 50), (200, 10), (200, 100), (250, 50))
CURVE_S = 20.0
IN_MISSION, BY_HAND = 4 << 16 | 4 << 24, 3 << 16  # PX4's custom modes: automatic, mission; position
EACH_MANUALLY = 20  # an alert each


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
    estimated: int  # UAVs
    alerts: int

    def wait_ms(self, percent: float) -> float:
        waits = sorted(self.waits_ms)
        return float(waits[min(int(len(waits) * percent / 100), len(waits) - 1)]) if waits else float("inf")

    @property
    def is_passed(self) -> bool:
        whole = self.stored == self.sent and not self.gaps and not self.errors and self.seen_share == 1.0 and self.estimated == self.uavs
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
def front_endpoint() -> Iterator[tuple[int, dict[str, int]]]:
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


def play(port: int, lines: list[Line], seconds: float, began_s: float, reported: Any) -> None:
    """Each UAV sends a heartbeat, its attitude and where it is once a second, all of them evenly spread; tells what it sent.

    A millisecond later is a ten-millionth degree further east, which is how a page knows when a report was sent.
    """
    sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sender.connect(("127.0.0.1", port))
    writers = {line.system: FrameWriter(line.system, 1) for line in lines}
    sent: dict[int, list[int]] = {line.uav_id: [] for line in lines}
    every_s = 1.0 / len(lines)
    first_s = time.monotonic()
    for number in range(int(seconds * len(lines))):
        time.sleep(max(first_s + number * every_s - time.monotonic(), 0.0))
        line = lines[number % len(lines)]
        mode = IN_MISSION if line.system % EACH_MANUALLY else BY_HAND
        ms = int((time.monotonic() - began_s) * 1000)
        lat, lon = round(line.lat * PER_DEGREE), round(line.lon * PER_DEGREE) + ms
        height_mm = round(1_000 * float(np.interp(lon / PER_DEGREE, *line.heights_m)))
        for message in (
            mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_QUADROTOR, mavlink.MAV_AUTOPILOT_PX4, 209, mode, 4, 3),
            mavlink.MAVLink_attitude_message(ms, 0.1, 0.2, 0.3, 0.0, 0.0, 0.0),
            mavlink.MAVLink_global_position_int_message(
                ms, lat, lon, round(GROUND_M * 1_000) + height_mm, height_mm, 0, round(SPEED_MPS * 100), 0, 9_000
            ),
        ):
            sender.send(writers[line.system].frame_of(message, 0.0))
        sent[line.uav_id].append(ms)
    reported.put(sent)


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


def run(user: User, lines: list[Line], pages: int, seconds: float) -> Run:
    put_under_way(lines)
    udp = free_port()
    with (
        front_endpoint() as (port, programs),
        gateway(udp) as program,
        running([sys.executable, "manage.py", "run_estimator"]) as estimator,
    ):
        programs |= {"gateway": program.pid, "estimator": estimator.pid}
        time.sleep(WARM_UP_S)
        began_s = time.monotonic()
        command = [sys.executable, "-m", "benchmarks.telemetry.live_clients", "--port", str(port), "--began", str(began_s)]
        clients = subprocess.Popen(command, cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        if clients.stdin is None or clients.stdout is None:
            raise SystemExit("the pages do not open")
        clients.stdin.write(json.dumps({line.uav_id: round(line.lon * PER_DEGREE) for line in lines}) + "\n")
        clients.stdin.write(" ".join(cookie_of(user) for _ in range(pages)) + "\n")
        clients.stdin.flush()
        clients.stdout.readline()
        time.sleep(WARM_UP_S)
        programs["pages"] = clients.pid
        before_s = {name: cpu_s(pid) for name, pid in programs.items()}
        context = multiprocessing.get_context("spawn")
        reported: Any = context.Queue()
        player = context.Process(target=play, args=(udp, lines, seconds, began_s, reported))
        player.start()
        sent = reported.get()
        cores = {name: (cpu_s(pid) - before_s[name]) / seconds for name, pid in programs.items()}
        player.join()
        estimated, alerts = UavWatch.objects.filter(estimated__isnull=False).count(), Alert.objects.count()
        time.sleep(SETTLES_S)
        clients.stdin.write("\n")
        clients.stdin.flush()
        saw = json.loads(clients.stdout.readline())
        clients.wait(30)
        stored = TelemetryRecord.objects.count()
    all_sent = sum(len(reports) for reports in sent.values())
    shares = [sum(len(set(reports) & set(page["seen"].get(str(uav), []))) for uav, reports in sent.items()) / all_sent for page in saw]
    return Run(
        uavs=len(lines),
        pages=pages,
        sent=all_sent,
        stored=stored,
        seen_share=min(shares),
        gaps=sum(page["gaps"] for page in saw),
        errors=[page["error"] for page in saw if page["error"]],
        waits_ms=[wait for page in saw for wait in page["waits_ms"]],
        cores=cores,
        kilobytes_s=sum(page["bytes"] for page in saw) / pages / seconds / 1000,
        estimated=estimated,
        alerts=alerts,
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
    "alerts",
    "cores: gateway, estimator, live, nginx, pages",
]


def cells(done: Run) -> list[str]:
    cores = ", ".join(f"{done.cores[name]:.2f}" for name in ("gateway", "estimator", "live", "nginx", "pages"))
    waits = [f"{done.wait_ms(percent):.0f}" for percent in (50, 95, 99)]
    lost = f"{done.sent - done.stored}"
    reported = f"{done.kilobytes_s:.0f}"
    return [str(done.uavs), str(done.pages), f"{done.sent:,}", lost, f"{done.seen_share:.2%}", *waits, reported, str(done.alerts), cores]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--uavs", type=int, default=200)
    parser.add_argument("--pages", type=int, default=50)
    parser.add_argument("--seconds", type=float, default=180.0)
    parser.add_argument("--curve", action="store_true", help="smaller and larger loads as well")
    parser.add_argument("--write", action="store_true", help="into docs/performance.md")
    options = parser.parse_args()
    loads = [(options.uavs, options.pages, options.seconds), *([(*load, CURVE_S) for load in CURVE] if options.curve else [])]
    runs = []
    with own_database():
        user, lines = make_site(max(uavs for uavs, _, _ in loads))
        for uavs, pages, seconds in loads:
            runs.append(run(user, lines[:uavs], pages, seconds))
            print(" | ".join(cells(runs[-1])), runs[-1].errors[:3] or "", flush=True)
    asked = runs[0]
    text = (
        f"`python -m benchmarks.telemetry.live_pages`: {asked.uavs} UAVs on approved missions of {UAVS_A_MISSION}, which report once "
        f"a second, and "
        f"{asked.pages} open pages for {options.seconds:.0f} s; of a datagram's way to the browser 95 of 100 took at most "
        f"{asked.wait_ms(95):.0f} ms, {asked.sent - asked.stored} were lost. Everything ran on this machine: UAVs, gateway, estimator, "
        "PostgreSQL, Redis, the websocket program, nginx, and the pages. "
        f"{machine('granian', 'channels', 'redis', 'pymavlink', 'psycopg', 'django')}"
    )
    text += "\n\n" + table(HEAD, [cells(done) for done in sorted(runs, key=lambda done: (done.uavs, done.pages))])
    print(text)
    if options.write:
        write_section("From a UAV's datagram to the browsers that watch it", text)
    sys.exit(not asked.is_passed)


if __name__ == "__main__":
    main()
