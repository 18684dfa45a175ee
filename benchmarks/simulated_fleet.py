"""How many simulated UAVs fly in real time on this machine, MAVLink and all, through a gateway into the log.

    python -m benchmarks.simulated_fleet [--seconds 30] [--start 20] [--more 20] [--processes 1] [--most 200] [--write]

All UAVs fly a square for ever, each with its own socket; their processes, the gateway and the database share the machine. Their number
goes up from step to step until one step of the flight begins more than a whole step (0.04 s) after it was due, or less than 98 % of the
positions are stored. The UAVs and their records are removed afterwards. With --write the table goes to docs/performance.md. Exits with 1
where the bar is missed.
"""

import argparse
import gc
import multiprocessing
import os
import resource
import sys
import time
from dataclasses import dataclass
from typing import Any

import django

os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
django.setup()

from django.contrib.gis.geos import Point  # noqa: E402
from django.db import connection  # noqa: E402
from pymavlink.dialects.v20 import ardupilotmega as mavlink  # noqa: E402

from benchmarks.gateway_rate import OTHER_SENDER_S, cpu_s, free_port, gateway  # noqa: E402
from benchmarks.report import machine, table, write_section  # noqa: E402
from inspection.geodesy import LonLat  # noqa: E402
from missions.mavlink.content import MissionItem, MissionType  # noqa: E402
from missions.mavlink.items import position_e7  # noqa: E402
from missions.models import Uav  # noqa: E402
from simulation.flight.states import Mode  # noqa: E402
from simulation.vehicle_endpoint.fleet import FleetReport  # noqa: E402
from simulation.vehicle_endpoint.launch import HIGHEST_SYSTEM, Launch, fleet_of, in_a_row  # noqa: E402
from telemetry.models import TelemetryRecord  # noqa: E402

BAR = 60
POSITIONS_HZ = 5.0
STORED_SHARE = 0.98
CLIMBS_S = 15.0  # until all fly and nothing is built any more
SETTLES_S = 5.0
FIRST = LonLat(10.4, 55.4)
SIDE_DEG = 0.002
HEIGHT_M = 30.0


@dataclass(frozen=True)
class Batch:
    """What one process has done while it was measured."""

    report: FleetReport
    cpu_s: float
    memory_mb: float


@dataclass(frozen=True)
class Step:
    uavs: int
    batches: list[Batch]
    stored: int
    gateway_cpu_s: float

    @property
    def wall_s(self) -> float:
        return max(batch.report.wall_s for batch in self.batches)

    @property
    def late_steps(self) -> int:
        return sum(batch.report.late_steps for batch in self.batches)

    @property
    def stored_share(self) -> float:
        return self.stored / (self.uavs * POSITIONS_HZ * self.wall_s)

    @property
    def is_kept(self) -> bool:
        return self.late_steps == 0 and self.stored_share >= STORED_SHARE


def square(at: LonLat) -> tuple[MissionItem, ...]:
    """Round and round."""
    nothing = (0.0, 0.0, 0.0, float("nan"))
    corners = [
        at,
        LonLat(at.lon, at.lat + SIDE_DEG),
        LonLat(at.lon + 2 * SIDE_DEG, at.lat + SIDE_DEG),
        LonLat(at.lon + 2 * SIDE_DEG, at.lat),
    ]
    take_off = MissionItem(mavlink.MAV_CMD_NAV_TAKEOFF, mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT, nothing, *position_e7(at), HEIGHT_M)
    flown = [
        MissionItem(mavlink.MAV_CMD_NAV_WAYPOINT, mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT, nothing, *position_e7(corner), HEIGHT_M)
        for corner in corners
    ]
    return (take_off, *flown, MissionItem(mavlink.MAV_CMD_DO_JUMP, mavlink.MAV_FRAME_MISSION, (1.0, -1.0, 0.0, 0.0)))


def fly(port: int, systems: list[int], places: list[LonLat], seconds: float, told: Any, begins: Any) -> None:
    """In a process of its own."""
    launches = [Launch(system, place, talks_to=[("127.0.0.1", port)]) for system, place in zip(systems, places, strict=True)]
    fleet = fleet_of(launches)
    for flying in fleet.uavs:
        flying.endpoint.missions.put(MissionType.MISSION, square(flying.uav.state.position))
        flying.uav.set_mode(Mode.MISSION)
        flying.uav.arm()
    first = fleet.uavs[0].uav
    fleet.run(lambda: first.now_s >= CLIMBS_S)
    gc.freeze()  # as fly_simulated does
    begins.wait()
    began_cpu_s, ends_s = time.process_time(), time.monotonic() + seconds
    report = fleet.run(lambda: time.monotonic() >= ends_s)
    memory_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    told.put(Batch(report, time.process_time() - began_cpu_s, memory_mb))
    fleet.close()


def step(port: int, program: Any, uavs: list[Uav], processes: int, seconds: float) -> Step:
    systems, places = [uav.mavlink_system_id for uav in uavs], in_a_row(FIRST, len(uavs), 20.0)
    spawn = multiprocessing.get_context("spawn")
    told, begins = spawn.Queue(), spawn.Barrier(processes + 1)
    players = [
        spawn.Process(target=fly, args=(port, systems[part::processes], places[part::processes], seconds, told, begins))
        for part in range(processes)
    ]
    for player in players:
        player.start()
    begins.wait()
    records = TelemetryRecord.objects.filter(uav__in=uavs)
    before, began_cpu_s = records.count(), cpu_s(program)
    batches = [told.get() for _ in players]
    used_s = cpu_s(program) - began_cpu_s
    time.sleep(SETTLES_S)
    for player in players:
        player.join()
    return Step(len(uavs), batches, records.count() - before, used_s)


def cells(done: Step) -> list[str]:
    cores = sum(batch.cpu_s for batch in done.batches) / done.wall_s
    messages = sum(batch.report.sent for batch in done.batches)
    return [
        str(done.uavs),
        str(done.late_steps),
        f"{1e3 * max(batch.report.latest_s for batch in done.batches):.0f}",
        f"{100 * min(done.stored_share, 1.0):.1f}",
        f"{messages / (done.wall_s + CLIMBS_S):,.0f}",
        f"{cores:.2f}",
        f"{1e3 * cores / done.uavs:.1f}",
        f"{done.gateway_cpu_s / done.wall_s:.2f}",
        f"{sum(batch.memory_mb for batch in done.batches) / done.uavs:.1f}",
    ]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--seconds", type=float, default=30.0, help="that each number is measured for")
    parser.add_argument("--start", type=int, default=20, help="UAVs of the first step")
    parser.add_argument("--more", type=int, default=20, help="UAVs that are added from step to step")
    parser.add_argument("--most", type=int, default=200)
    parser.add_argument("--processes", type=int, default=1, help="that share the UAVs")
    parser.add_argument("--write", action="store_true", help="into docs/performance.md")
    options = parser.parse_args()
    most = min(options.most, HIGHEST_SYSTEM)
    at = Point(*FIRST, srid=4326)
    uavs = [
        Uav.objects.create(name=f"benchmark {system}", location=at, mavlink_system_id=system, allows_unsigned=True, is_simulated=True)
        for system in range(1, most + 1)
    ]
    port, steps, number = free_port(), [], options.start
    head = [
        "UAVs", "late steps", "latest [ms]", "positions stored [%]", "messages a second", "cores of the UAVs", "CPU a UAV [ms/s]",
        "cores of the gateway", "memory a UAV [MB]",
    ]  # fmt: skip
    try:
        with gateway(port) as program:
            time.sleep(2)
            while number <= most and (not steps or steps[-1].is_kept):
                steps.append(step(port, program, uavs[:number], options.processes, options.seconds))
                print(" | ".join(f"{name}: {cell}" for name, cell in zip(head, cells(steps[-1]), strict=True)), flush=True)
                number += options.more
                time.sleep(OTHER_SENDER_S)
    finally:
        with connection.cursor() as cursor:
            cursor.execute("DELETE FROM telemetry_telemetryrecord WHERE uav_id = ANY(%s)", [[uav.pk for uav in uavs]])
        Uav.objects.filter(pk__in=[uav.pk for uav in uavs]).delete()
    best = max((done.uavs for done in steps if done.is_kept), default=0)
    text = (
        f"`python -m benchmarks.simulated_fleet`: {best} simulated UAVs in real time without a late step, in {options.processes} "
        f"process{'es' if options.processes > 1 else ''}, through the gateway into the log. {machine('jsbsim', 'pymavlink', 'psycopg')}"
    )
    text += "\n\n" + table(head, [cells(done) for done in steps])
    print(text)
    if options.write:
        write_section("Simulated UAVs in real time", text)
    sys.exit(best < BAR)


if __name__ == "__main__":
    main()
