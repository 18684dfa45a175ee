"""Networks whose edges are all inspected by flights of limited length from one depot, beside two other programs.

    .venv/bin/python benchmarks/network_coverage.py --data ../shared/data/line-coverage [--seconds 2 15] [--network delhi ...] [--write]

25 city networks of the LineCoverage dataset (OpenStreetMap, ODbL). Each edge is inspected once, from either end, at 5 m/s; between edges
flights go straight at 8 m/s. The depot is the node nearest to the mean of all, a flight takes 600 or 1,200 s at most, and the sum of all
is as small as can be. `peers.csv` beside the networks has the totals of MEM with 2-opt and of PyVRP in 15 s on one core; this program
also uses one core. With --uavs it plans for the earliest end of several UAVs, and states the lower bound.
"""

import argparse
import csv
import math
import os
import sys
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from statistics import median
from time import perf_counter

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from benchmarks.report import machine, table, write_section
from config.compiled.compiled_core import use_compiled_directory
from planning.problem import End, FloatArray, Objective, Problem, Solution, UavStart, Visit
from planning.solver.solver import solve

TITLE = "Networks of lines from one depot"
INSPECT_MPS, FLY_MPS = 5.0, 8.0
FLIGHTS_S = (600.0, 1_200.0)
SPARE_FLIGHTS = 2.0  # of those that the length of all edges needs at least
UAVS_FLIGHT_S = 1_200.0


@dataclass(frozen=True)
class Network:
    name: str
    node_m: FloatArray  # (n, 2)
    edges: list[tuple[int, int]]

    @classmethod
    def read(cls, folder: Path) -> "Network":
        rows = [line.split() for line in (folder / "node_data").read_text().splitlines() if line.strip()]
        place = {row[0]: number for number, row in enumerate(rows)}
        edges = [line.split() for line in (folder / "req_edge_list").read_text().splitlines() if line.strip()]
        node_m = np.array([[float(x) for x in row[1:3]] for row in rows])
        return cls(folder.name, node_m, [(place[one], place[other]) for one, other in edges])

    def problem(self, flight_s: float, uavs: int, objective: Objective) -> Problem:
        """Return the problem in seconds: as metres at 1 m/s."""
        depot = self.node_m[np.hypot(*(self.node_m - self.node_m.mean(axis=0)).T).argmin()]
        ends = self.node_m[np.array(self.edges)]
        inspect_s = np.hypot(*(ends[:, 1] - ends[:, 0]).T) / INSPECT_MPS
        begin, end = np.concatenate([ends[:, 0], ends[:, 1]]), np.concatenate([ends[:, 1], ends[:, 0]])
        out_s, home_s = (np.hypot(*(places - depot).T) / FLY_MPS for places in (begin, end))
        between_s = np.hypot(*(end[:, None] - begin[None]).transpose(2, 0, 1)) / FLY_MPS
        sorties = math.ceil(SPARE_FLIGHTS * float(inspect_s.sum()) / flight_s / uavs) + 3
        count = len(self.edges)
        return Problem(
            uavs=(UavStart(max_range_m=flight_s, end=End.RETURN, sorties=sorties),) * uavs,
            visits=tuple(Visit(number % count, number >= count, float(inspect_s[number % count])) for number in range(2 * count)),
            target_count=count,
            from_start_m=np.tile(out_s, (uavs, 1)),
            between_m=between_s,
            to_start_m=np.tile(home_s[:, None], (1, uavs)),
            objective=objective,
        )


@dataclass(frozen=True)
class Judged:
    total_s: float
    flights: int
    left_out: int


def judged(problem: Problem, solution: Solution, flight_s: float) -> Judged:
    """Return what the flights take, counted anew. Raises ValueError where one is too long or an edge is inspected twice."""
    flights = [flight for of_uav in solution.sorties for flight in of_uav if flight]
    taken_s = [
        float(problem.from_start_m[0, flight[0]] + problem.to_start_m[flight[-1], 0])
        + sum(problem.visits[visit].length_m for visit in flight)
        + sum(float(problem.between_m[pair]) for pair in pairwise(flight))
        for flight in flights
    ]
    if max(taken_s) > flight_s + 1e-3:
        raise ValueError(f"a flight takes {max(taken_s):.1f} s")
    done = [problem.visits[visit].target for flight in flights for visit in flight]
    if len(done) != len(set(done)):
        raise ValueError("an edge is inspected twice")
    return Judged(sum(taken_s), len(flights), problem.target_count - len(done))


def compare_totals(networks: list[Network], peers: dict[tuple[str, float], dict[str, str]], search_s: float) -> str:
    """Print a row for each network; return a sentence with the ratios."""
    to_mem, to_pyvrp = [], []
    print("network | flight [s] | edges | flights: here, MEM, PyVRP | total [s] | over MEM | over PyVRP | left out | took [s]")
    for network in networks:
        for flight_s in FLIGHTS_S:
            problem, peer = network.problem(flight_s, 1, Objective.TOTAL), peers[network.name, flight_s]
            began_s = perf_counter()
            solution = solve(problem, search_s=search_s)
            took_s, ours = perf_counter() - began_s, judged(problem, solution, flight_s)
            mem, pyvrp = (ours.total_s / float(peer[f"{name}_total_s"]) for name in ("mem", "pyvrp"))
            if not ours.left_out and peer["pyvrp_feasible"] == "True":
                to_mem.append(mem)
                to_pyvrp.append(pyvrp)
            flights = f"{ours.flights}, {peer['mem_flights']}, {peer['pyvrp_flights']}"
            cells = [network.name, f"{flight_s:.0f}", str(len(network.edges)), flights, f"{ours.total_s:.1f}", f"{mem:.4f}", f"{pyvrp:.4f}"]
            print(" | ".join([*cells, str(ours.left_out), f"{took_s:.1f}"]), flush=True)
    words = "; ".join(
        f"{name}: median {median(ratios):.4f}, best {min(ratios):.4f}, worst {max(ratios):.4f}"
        for name, ratios in (("over MEM", to_mem), ("over PyVRP", to_pyvrp))
    )
    return f"{search_s:g} s, {len(to_mem)} cases with a solution: {words}."


def compare_ends(networks: list[Network], numbers: list[int], search_s: float) -> str:
    """Return the table of the earliest ends with so many UAVs."""
    rows = []
    for network in networks:
        for uavs in numbers:
            problem = network.problem(UAVS_FLIGHT_S, uavs, Objective.MAKESPAN)
            solution = solve(problem, search_s=search_s)
            ours = judged(problem, solution, UAVS_FLIGHT_S)
            ratio = f"{solution.longest_s / solution.lower_bound:.3f}" if solution.lower_bound else "–"
            cells = [network.name, str(uavs), f"{solution.longest_s / 60.0:.1f}", f"{solution.lower_bound / 60.0:.1f}", ratio]
            rows.append([*cells, f"{ours.total_s / 60.0:.1f}", str(ours.left_out)])
            print(" | ".join(rows[-1]), flush=True)
    return table(["network", "UAVs", "done after [min]", "lower bound [min]", "ratio", "sum of all flights [min]", "left out"], rows)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, required=True, help="folder with a folder for each network, and peers.csv")
    parser.add_argument("--seconds", type=float, nargs="+", default=[2.0, 15.0], help="time of each search")
    parser.add_argument("--network", nargs="+", help="only these")
    parser.add_argument("--uavs", type=int, nargs="*", default=[2, 4, 8], help="numbers of UAVs for the earliest end")
    parser.add_argument("--write", action="store_true", help="put the tables into docs/performance.md")
    options = parser.parse_args()
    use_compiled_directory()
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    with (options.data / "peers.csv").open() as file:
        peers = {(row["network"], float(row["flight_s"])): row for row in csv.DictReader(file)}
    networks = [Network.read(folder) for folder in sorted(options.data.iterdir()) if folder.is_dir()]
    networks = [network for network in networks if not options.network or network.name in options.network]
    solve(networks[0].problem(FLIGHTS_S[0], 1, Objective.TOTAL), search_s=0.1)  # loads the compiled functions
    found = [compare_totals(networks, peers, search_s) for search_s in options.seconds]
    ends = compare_ends(networks, options.uavs, max(options.seconds)) if options.uavs else ""
    summary = "\n".join(f"- {words}" for words in found)
    print(summary)
    if options.write:
        command = f"`python benchmarks/network_coverage.py --seconds {' '.join(f'{one:g}' for one in options.seconds)}`"
        text = f"{command}, one core. {machine('numpy', 'numba')}\n\n{summary}\n\n{ends}"
        write_section(TITLE, text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
