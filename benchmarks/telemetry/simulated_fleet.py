"""How many simulated UAVs fly in real time on this machine, MAVLink and all, through a gateway into the log.

    python -m benchmarks.telemetry.simulated_fleet [--seconds 30] [--start 20] [--more 20] [--most 250] [--finest 5] [--processes 1]
    [--speed 1] [--simulator] [--write]

All UAVs fly a square for ever, each with its own socket; their processes, the gateway and the database share the machine. Their number
goes up from step to step until one step of the flight begins more than a whole step (0.04 s of simulated time) after it was due, or less
than 98 % of the positions are stored; then the limit is looked for between the last two numbers. MAVLink has 250 system ids: what the
machine can do beyond that shows at a higher --speed, at which each UAV counts so many times. With --simulator they are flown by one
`run_simulator`, under its lease and with what it writes down. The UAVs and their records are removed afterwards. With --write the table
goes to docs/performance.md. Exits with 1 where the bar is missed.
"""

import argparse
import gc
import multiprocessing
import os
import resource
import sys
import time
from dataclasses import dataclass
from datetime import timedelta
from pathlib import Path
from typing import Any
from unittest import mock

import django

os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
django.setup()

from django.contrib.gis.geos import Point  # noqa: E402
from django.db import connection, connections  # noqa: E402
from django.utils import timezone  # noqa: E402
from pymavlink.dialects.v20 import ardupilotmega as mavlink  # noqa: E402

from benchmarks.report import machine, table, write_section  # noqa: E402
from benchmarks.telemetry.gateway_rate import OTHER_SENDER_S, cpu_s, free_port, gateway  # noqa: E402
from inspection.geodesy import LonLat  # noqa: E402
from mavlink.mission_items import position_e7  # noqa: E402
from mavlink.vehicle_plan import MissionItem, MissionType  # noqa: E402
from missions.models import Uav  # noqa: E402
from planning.energy.conditions import Conditions  # noqa: E402
from simulation.flight.states import FlightMode  # noqa: E402
from simulation.management.commands.run_simulator import SWITCH_S  # noqa: E402
from simulation.models import SimulatedVehicle, Simulation, SimulationState  # noqa: E402
from simulation.rehearsing.weather_scenario import Named, named_scenario, scenario_to_json  # noqa: E402
from simulation.simulator.flight import RunningSimulation  # noqa: E402
from simulation.simulator.options import SimulatorOptions  # noqa: E402
from simulation.simulator.process import Simulator  # noqa: E402
from simulation.vehicle_endpoint.fleet import FleetReport, SimulatedFleet  # noqa: E402
from simulation.vehicle_endpoint.launch import MAX_SYSTEM_ID, Launch, fleet_of, in_a_row  # noqa: E402
from telemetry.models import TelemetryRecord  # noqa: E402

BAR = 60
POSITIONS_HZ = 5.0
STORED_SHARE = 0.98
CLIMBS_S = 15.0  # simulated, until all fly and nothing is built any more
TAKEN_WITHIN_S = 120.0
SETTLES_S = 5.0
FIRST = LonLat(10.4, 55.4)
SIDE_DEG = 0.002
HEIGHT_M = 30.0


@dataclass(frozen=True)
class Batch:
    """What one process has done while it was measured. A simulator does not count what it sends."""

    report: FleetReport
    cpu_s: float
    memory_mb: float
    counts_messages: bool = True


@dataclass(frozen=True)
class Step:
    uavs: int
    speed: float
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
        return self.stored / (self.uavs * self.speed * POSITIONS_HZ * self.wall_s)

    @property
    def is_kept(self) -> bool:
        return self.late_steps == 0 and self.stored_share >= STORED_SHARE

    @property
    def load(self) -> float:
        """Simulated seconds a second."""
        return self.uavs * self.speed


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


def on_their_squares(fleet: SimulatedFleet) -> SimulatedFleet:
    for flying in fleet.uavs:
        flying.endpoint.missions.put(MissionType.MISSION, square(flying.uav.state.position))
        flying.uav.set_mode(FlightMode.MISSION)
        flying.uav.arm()
    return fleet


def fly(port: int, systems: list[int], places: list[LonLat], speed: float, seconds: float, reported: Any, begins: Any) -> None:
    """In a process of its own."""
    launches = [Launch(system, place, talks_to=[("127.0.0.1", port)]) for system, place in zip(systems, places, strict=True)]
    fleet = on_their_squares(fleet_of(launches, speed=speed))
    first = fleet.uavs[0].uav
    fleet.run(lambda: first.now_s >= CLIMBS_S)
    gc.freeze()  # as fly_simulated does
    begins.wait()
    began_cpu_s, ends_s = time.process_time(), time.monotonic() + seconds
    report = fleet.run(lambda: time.monotonic() >= ends_s)
    memory_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    reported.put(Batch(report, time.process_time() - began_cpu_s, memory_mb))
    fleet.close()


def simulate(port: int) -> None:
    """`run_simulator` in a process of its own, whose UAVs set out at once."""

    def under_way(simulation: Simulation, vehicles: tuple[SimulatedVehicle, ...], launches: list[Launch]) -> RunningSimulation:
        return RunningSimulation(simulation, vehicles, on_their_squares(fleet_of(launches, speed=simulation.speed)), simulation.speed)

    sys.setswitchinterval(SWITCH_S)
    with mock.patch("simulation.simulator.process.flight_of", under_way):
        Simulator(SimulatorOptions(name="benchmark", most_load=1e6, gateway=("127.0.0.1", port), host="127.0.0.1")).run()


def simulation_of(uavs: list[Uav], speed: float) -> Simulation:
    ends_at = timezone.now() + timedelta(hours=1)
    simulation = Simulation.objects.create(organisation=uavs[0].organisation, speed=speed, lifetime_ends_at=ends_at)
    calm = scenario_to_json(named_scenario(Named.CALM, Conditions()))
    SimulatedVehicle.objects.bulk_create(
        SimulatedVehicle(
            simulation=simulation, sequence=number, uav=uav, name=uav.name, system_id=uav.mavlink_system_id or 0, airframe="iris",
            position=Point(*place, srid=4326), conditions=calm,
        )
        for number, (uav, place) in enumerate(zip(uavs, in_a_row(FIRST, len(uavs), 20.0), strict=True))
    )  # fmt: skip
    return simulation


def pace_from(simulation: Simulation, simulated_s: float) -> dict[str, float]:
    """As it was last written down, once so much was flown."""
    until_s = time.monotonic() + TAKEN_WITHIN_S + simulated_s / simulation.speed
    while time.monotonic() < until_s:
        simulation.refresh_from_db()
        if simulation.state == SimulationState.FAILED:
            raise SystemExit(f"the simulation failed: {simulation.reason}")
        if simulation.step_timing.get("simulated_s", 0.0) >= simulated_s:
            return dict(simulation.step_timing)
        time.sleep(0.2)
    raise SystemExit("nothing was flown")


def step_in_simulator(port: int, program: Any, uavs: list[Uav], speed: float, seconds: float) -> Step:
    """Of its step timing what it wrote down at the beginning and at the end; `latest_s` is from when it began."""
    simulation = simulation_of(uavs, speed)
    connections.close_all()
    player = multiprocessing.get_context("spawn").Process(target=simulate, args=(port,))
    player.start()
    try:
        before = pace_from(simulation, CLIMBS_S)
        records = TelemetryRecord.objects.filter(uav__in=uavs)
        stored, began_s, began_cpu_s, gateway_s = records.count(), time.monotonic(), cpu_s(player), cpu_s(program)
        time.sleep(seconds)
        stored, wall_s = records.count() - stored, time.monotonic() - began_s
        used_s, gateway_s = cpu_s(player) - began_cpu_s, cpu_s(program) - gateway_s
        after = pace_from(simulation, before["simulated_s"] + 0.5 * speed * seconds)
        flown = {name: after[name] - before[name] for name in ("simulated_s", "steps", "late_steps", "slipped_s")}
        report = FleetReport(
            uavs=len(uavs), simulated_s=flown["simulated_s"], wall_s=wall_s, steps=int(flown["steps"]), late_steps=int(flown["late_steps"]),
            latest_s=after["latest_s"], slipped_s=flown["slipped_s"], sent=0, received_count=0, failed=0,
        )  # fmt: skip
        return Step(len(uavs), speed, [Batch(report, used_s, memory_mb(player.pid or 0), counts_messages=False)], stored, gateway_s)
    finally:
        player.terminate()
        player.join(30)
        Simulation.objects.filter(pk=simulation.pk).delete()


def memory_mb(process: int) -> float:
    """Resident."""
    return int(Path(f"/proc/{process}/statm").read_text().split()[1]) * resource.getpagesize() / 2**20


def step(port: int, program: Any, uavs: list[Uav], processes: int, speed: float, seconds: float) -> Step:
    systems, places = [uav.mavlink_system_id for uav in uavs], in_a_row(FIRST, len(uavs), 20.0)
    spawn = multiprocessing.get_context("spawn")
    reported, begins = spawn.Queue(), spawn.Barrier(processes + 1)
    players = [
        spawn.Process(target=fly, args=(port, systems[part::processes], places[part::processes], speed, seconds, reported, begins))
        for part in range(processes)
    ]
    for player in players:
        player.start()
    begins.wait()
    records = TelemetryRecord.objects.filter(uav__in=uavs)
    before, began_cpu_s = records.count(), cpu_s(program)
    batches = [reported.get() for _ in players]
    used_s = cpu_s(program) - began_cpu_s
    time.sleep(SETTLES_S)
    for player in players:
        player.join()
    return Step(len(uavs), speed, batches, records.count() - before, used_s)


def numbers_to_try(start: int, more: int, most: int, finest: int, tried: list[Step]) -> int | None:
    """The next number of UAVs: up until one is too many, then the middle between the most that was kept and the least that was not."""
    kept = max((done.uavs for done in tried if done.is_kept), default=0)
    missed = min((done.uavs for done in tried if not done.is_kept), default=None)
    if missed is None:
        following = kept + more if tried else start
        return min(following, most) if kept < most else None
    return (kept + missed) // 2 if missed - kept > finest else None


def cells(done: Step) -> list[str]:
    cores = sum(batch.cpu_s for batch in done.batches) / done.wall_s
    messages = sum(batch.report.sent for batch in done.batches)
    return [
        str(done.uavs),
        str(done.late_steps),
        f"{1e3 * max(batch.report.latest_s for batch in done.batches):.0f}",
        f"{100 * min(done.stored_share, 1.0):.1f}",
        f"{messages / (done.wall_s + CLIMBS_S / done.speed):,.0f}" if done.batches[0].counts_messages else "–",
        f"{cores:.2f}",
        f"{1e3 * cores / done.load:.1f}",
        f"{done.gateway_cpu_s / done.wall_s:.2f}",
        f"{sum(batch.memory_mb for batch in done.batches) / done.uavs:.1f}",
    ]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--seconds", type=float, default=30.0, help="that each number is measured for")
    parser.add_argument("--start", type=int, default=20, help="UAVs of the first step")
    parser.add_argument("--more", type=int, default=20, help="UAVs that are added from step to step")
    parser.add_argument("--most", type=int, default=MAX_SYSTEM_ID, help=f"UAVs; there are {MAX_SYSTEM_ID} system ids")
    parser.add_argument("--finest", type=int, default=5, help="UAVs by which the limit is known in the end")
    parser.add_argument("--processes", type=int, default=1, help="that share the UAVs")
    parser.add_argument("--speed", type=float, default=1.0, help="times real time; each UAV counts so many times")
    parser.add_argument("--simulator", action="store_true", help="flown by one run_simulator")
    parser.add_argument("--write", action="store_true", help="into docs/performance.md")
    options = parser.parse_args()
    most = min(options.most, MAX_SYSTEM_ID)
    at = Point(*FIRST, srid=4326)
    uavs = [
        Uav.objects.create(name=f"benchmark {system}", location=at, mavlink_system_id=system, allows_unsigned=True, is_simulated=True)
        for system in range(1, most + 1)
    ]
    port = free_port()
    steps: list[Step] = []
    head = [
        "UAVs", "late steps", "latest [ms]", "positions stored [%]", "messages a second", "cores of the UAVs", "CPU a UAV [ms/simulated s]",
        "cores of the gateway", "memory a UAV [MB]",
    ]  # fmt: skip
    try:
        with gateway(port) as program:
            time.sleep(2)
            while (number := numbers_to_try(options.start, options.more, most, options.finest, steps)) is not None:
                chosen = uavs[:number]
                if options.simulator:
                    steps.append(step_in_simulator(port, program, chosen, options.speed, options.seconds))
                else:
                    steps.append(step(port, program, chosen, options.processes, options.speed, options.seconds))
                print(" | ".join(f"{name}: {cell}" for name, cell in zip(head, cells(steps[-1]), strict=True)), flush=True)
                time.sleep(OTHER_SENDER_S)
    finally:
        with connection.cursor() as cursor:
            cursor.execute("DELETE FROM telemetry_telemetryrecord WHERE uav_id = ANY(%s)", [[uav.pk for uav in uavs]])
        Uav.objects.filter(pk__in=[uav.pk for uav in uavs]).delete()
    best = max((done.uavs for done in steps if done.is_kept), default=0)
    given = "".join([f" --speed {options.speed:g}"] * (options.speed != 1.0) + [" --simulator"] * options.simulator)
    flown_by = "one simulator" if options.simulator else f"{options.processes} process{'es' if options.processes > 1 else ''}"
    least = "at least " if steps and all(done.is_kept for done in steps) else ""
    text = (
        f"`python -m benchmarks.telemetry.simulated_fleet{given}`: {least}{best} simulated UAVs at {options.speed:g} times real time "
        f"without a late "
        f"step, in {flown_by}, through the gateway into the log. {machine('jsbsim', 'pymavlink', 'psycopg')}"
    )
    text += "\n\n" + table(head, [cells(done) for done in sorted(steps, key=lambda done: done.uavs)])
    print(text)
    if options.write:
        at_speed = f", at {options.speed:g} times" if options.speed != 1.0 else ""
        write_section(f"Simulated UAVs in real time{at_speed}{', in one simulator' if options.simulator else ''}", text)
    sys.exit(best * options.speed < BAR)


if __name__ == "__main__":
    main()
