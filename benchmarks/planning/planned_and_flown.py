"""What plans say of time and battery beside what the same missions take in simulation.

    python -m benchmarks.planning.planned_and_flown [--missions 24] [--lines FILE.osm.pbf …] [--write]

Missions past towers and back, with photos, looks and holds at some of them, along power lines of OSM files with --lines; each is timed as
plans time it, by the mean wind and the rules' speeds up and down, and flown by JSBSim in three kinds of air, by the Iris or the Inspector.
Beside it the same without what `Manoeuvres` count (planning/rules.py). With --write the table goes to docs/performance.md.
Exits with 1 where the mean of a row is more than 10 % off, or where one of 20 flights takes over 10 % more than planned.
"""

import argparse
import multiprocessing
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from benchmarks.report import machine, table, write_section
from inspection.geodesy import LonLat
from planning.rules import AT_ONCE, FlightRules
from simulation.flight.airframe import AIRFRAMES
from tests.simulation.rehearsals.planned_flights import CALM, ROUGH, WINDY, air_of, compared, mission, planned_timing
from tests.telemetry.estimation.routes import lines_of

PROCESSES = 2
MAX_MEAN_ERROR, MIN_SHARE = 0.10, 0.90


class Found(NamedTuple):
    code: str
    air: str
    time: float
    energy: float
    time_before: float
    energy_before: float


def flown(seed: int, lines: Sequence[Sequence[LonLat]]) -> list[Found]:
    route, code = mission(seed, lines)
    found = []
    for kind in (CALM, WINDY, ROUGH):
        weather = air_of(seed, code, kind)
        one = compared(route, code, weather, seed)
        before = planned_timing(route, code, weather.conditions, FlightRules(manoeuvres=AT_ONCE))
        found.append(Found(
            code, kind, one.time_ratio, one.energy_ratio, before.total_s / one.flown_s, (before.total_wh or 0.0) / one.flown_wh
        ))  # fmt: skip
    return found


def search_from(ratios: Sequence[float]) -> str:
    low, high = np.quantile(ratios, [0.05, 0.95])
    return f"{np.mean(ratios):.3f} ({low:.2f} to {high:.2f})"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--missions", type=int, default=24)
    parser.add_argument("--lines", type=Path, nargs="*", default=[])
    parser.add_argument("--write", action="store_true", help="into docs/performance.md")
    asked = parser.parse_args()
    lines = [line for path in asked.lines for line in lines_of(path)]
    with multiprocessing.Pool(PROCESSES) as pool:
        each = [one for many in pool.imap(partial(flown, lines=lines), range(asked.missions)) for one in many]
    rows, missed = [], []
    for code in AIRFRAMES:
        for air in (CALM, WINDY, ROUGH):
            own = [one for one in each if one.code == code and one.air == air]
            columns = [[getattr(one, name) for one in own] for name in ("time", "energy", "time_before", "energy_before")]
            rows.append([f"{AIRFRAMES[code].name}, {air}", str(len(own)), *map(search_from, columns)])
            for ratios in columns[:2]:
                if abs(float(np.mean(ratios)) - 1.0) > MAX_MEAN_ERROR or float(np.quantile(ratios, 0.05)) < MIN_SHARE:
                    missed.append(rows[-1][0])
    head = ["planned for flown, mean (5 to 95 %)", "missions", "time", "energy", "time, without manoeuvres", "energy, without"]
    where = f"along {len(lines):,} real power lines" if lines else "along drawn lines"
    text = (
        f"`python -m benchmarks.planning.planned_and_flown`: {asked.missions} missions {where}, each flown in three kinds of air. "
        f"Above 1 the plan "
        f"says more than the flight takes. {machine('jsbsim', 'numba', 'numpy')}\n\n{table(head, rows)}"
    )
    print(text)
    if asked.write:
        write_section("Planned and flown", text)
    if missed:
        sys.exit("missed: " + "; ".join(missed))


if __name__ == "__main__":
    main()
