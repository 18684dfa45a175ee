"""Simulated flights against their bars: how true they keep to a square of 2 km, how fast they are worked out, and what a UAV takes.

    python -m benchmarks.simulation [--seeds 3] [--write]

Four legs of 500 m at 5 m/s, 30 m above ground, with take-off and landing, in four kinds of weather, the wind from another side with each
seed. One core; the processor's seconds are counted, not the clock's, and the fastest of the seeds is what is told: others are at work on
the machine. Memory is what 100 UAVs, each stepped, add to a process. With --write the tables go to docs/performance.md. Exits with 1 where
a bar is missed.
"""

import argparse
import math
from dataclasses import dataclass
from pathlib import Path
from time import process_time

import numpy as np

from benchmarks.report import machine, table, write_section
from inspection.geodesy import LonLat, path_length_m
from inspection.geodesy.local_frame import LocalFrame
from planning.energy.conditions import Conditions, WindLayer
from simulation.flight.airframe import AIRFRAMES
from simulation.flight.faults import Weather
from simulation.flight.plant import PHYSICS_HZ
from simulation.flight.route_flight import RouteFile, RouteFlight, fly_route
from simulation.flight.uav import SimulatedUav

HOME = LonLat(9.0, 47.0)
SIDE_M, HEIGHT_M = 500.0, 30.0
MIN_TIMES_REAL = 200.0
MAX_TOUCH_DOWN_M = 1.0
UAVS = 100
PAGE_BYTES = 4096


@dataclass(frozen=True)
class Case:
    """A weather and the bars of the square in it: cross-track RMS and greatest [m]."""

    name: str
    most_rms_m: float
    most_m: float
    wind_mps: float = 0.0
    gusts_mps: float = 0.0
    turbulence_mps: float = 0.0

    def weather(self, from_deg: float) -> Weather:
        wind = (WindLayer(10.0, self.wind_mps, from_deg),) if self.wind_mps else ()
        return Weather(Conditions(wind), self.gusts_mps, turbulence_mps_at_20ft=self.turbulence_mps)


CASES = (
    Case("calm", 0.3, 2.0),
    Case("wind 8 m/s", 0.4, 2.0, 8.0),
    Case("wind 8 m/s, Dryden turbulence", 0.5, 2.0, 8.0, turbulence_mps=8.0),
    Case("wind 8 m/s, gusts of 2 m/s", 1.0, 3.0, 8.0, gusts_mps=2.0),
)


@dataclass(frozen=True)
class Run:
    flight: RouteFlight
    cpu_s: float

    @property
    def times_real(self) -> float:
        return self.flight.flown.end.at_s / self.cpu_s

    @property
    def touch_down_m(self) -> float:
        where = self.flight.flown.touched_down_at
        return math.inf if where is None else path_length_m(np.array([where, HOME]))


def square(speed_mps: float) -> RouteFile:
    frame = LocalFrame.around(*HOME)
    corners = frame.to_degrees(SIDE_M * np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]], dtype=np.float64))
    return RouteFile(tuple(LonLat(*corner) for corner in corners.tolist()), (HEIGHT_M,) * 5, speed_mps)


def run(case: Case, seed: int, *, airframe: str = "iris", speed_mps: float = 5.0, physics_hz: int = 250) -> Run:
    began_s = process_time()
    flight = fly_route(
        square(speed_mps), AIRFRAMES[airframe], weather=case.weather((270.0 + 137.0 * (seed - 1)) % 360.0), seed=seed, physics_hz=physics_hz
    )
    return Run(flight, process_time() - began_s)


def row(name: str, runs: list[Run]) -> list[str]:
    """The worst deviation, the mean of what was used, and the fastest run."""
    beside = [one.flight.cross_track_m for one in runs]
    ends = [one.flight.flown.end for one in runs]
    fastest = max(runs, key=lambda one: one.times_real)
    return [
        name,
        f"{max(math.sqrt(np.mean(off**2)) for off in beside):.2f}",
        f"{max(off.max() for off in beside):.2f}",
        f"{max(one.touch_down_m for one in runs):.2f}",
        f"{np.mean([end.at_s for end in ends]):.0f}",
        f"{np.mean([end.battery_used_wh for end in ends]):.1f}",
        f"{fastest.times_real:.0f}",
        f"{1000.0 / fastest.times_real:.1f}",
    ]


def misses(case: Case, runs: list[Run]) -> list[str]:
    found = []
    for one in runs:
        off = one.flight.cross_track_m
        if not (math.sqrt(np.mean(off**2)) < case.most_rms_m and off.max() < case.most_m):
            found.append(f"{case.name}: beside the route")
        if not one.touch_down_m < MAX_TOUCH_DOWN_M:
            found.append(f"{case.name}: touch-down")
        if one.flight.reasons:
            found.append(f"{case.name}: {one.flight.reasons[0]}")
    if max(one.times_real for one in runs) < MIN_TIMES_REAL:
        found.append(f"{case.name}: slower than {MIN_TIMES_REAL:.0f} times real time")
    return found


def resident_bytes() -> int:
    return int(Path("/proc/self/statm").read_text().split()[1]) * PAGE_BYTES


def memory() -> tuple[float, float]:
    """MiB of the process before, and of each UAV."""
    before = resident_bytes()
    uavs = [SimulatedUav(AIRFRAMES["iris"], HOME, seed=number) for number in range(UAVS)]
    for uav in uavs:
        uav.take_off(5.0)
        uav.arm()
        for _ in range(25):
            uav.step()
    return before / 2**20, (resident_bytes() - before) / UAVS / 2**20


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--write", action="store_true", help="into docs/performance.md")
    options = parser.parse_args()
    process_mib, uav_mib = memory()
    missed: list[str] = []
    head = ["square of 2 km", "cross-track RMS m", "max m", "touch-down m", "flight s", "Wh", "times real time", "CPU ms per simulated s"]
    rows = []
    run(CASES[0], 1)  # loads what is compiled
    for case in CASES:
        runs = [run(case, seed + 1) for seed in range(options.seeds)]
        missed += misses(case, runs)
        rows.append(row(f"Iris, 5 m/s, {case.name} (bars {case.most_rms_m:g} and {case.most_m:g})", runs))
    for physics_hz in PHYSICS_HZ[1:]:
        for case in (CASES[0], CASES[-1]):
            rows.append(row(f"Iris, {physics_hz} Hz, {case.name}", [run(case, 1, physics_hz=physics_hz)]))
    for case in (CASES[0], Case("wind 12 m/s, gusts of 2 m/s", 1.0, 3.0, 12.0, gusts_mps=2.0)):
        rows.append(row(f"Inspector, 10 m/s, {case.name}", [run(case, 1, airframe="inspector", speed_mps=10.0)]))
    text = (
        f"`python -m benchmarks.simulation`: the worst of {options.seeds} seeds, each with the wind from another side; speed is that of "
        f"the fastest of them, one core, in processor time. The model is stepped at 250 Hz where no other rate is named. A UAV takes "
        f"{uav_mib:.2f} MiB, on top of {process_mib:.0f} MiB of the process with all its libraries. "
        f"{machine('jsbsim', 'numpy')}\n\n{table(head, rows)}"
    )
    print(text)
    if options.write:
        write_section("Flight in simulation", text)
    if missed:
        raise SystemExit("missed: " + "; ".join(missed))


if __name__ == "__main__":
    main()
