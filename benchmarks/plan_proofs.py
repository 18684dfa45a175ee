"""How many plans the proof in the background settles, and how far the others can be from the best: before and after it.

    .venv/bin/python -m benchmarks.plan_proofs [--missions 48] [--time 60] [--write]

Random missions of 13 to 25 targets and 2 to 4 UAVs that return to their bases: towers on random networks that look like power lines, with
a wind of 6 m/s, and in every second mission batteries that just suffice. Each is planned by the search, then handed to the prover on one
core. A plan that is said to be the best is looked for once more with two other seeds: the command fails where one of them is better.
"""

import argparse
import math
import sys
from dataclasses import dataclass, replace
from statistics import median
from time import perf_counter

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra, minimum_spanning_tree
from scipy.spatial.distance import cdist

from benchmarks.report import machine, table, write_section
from planning.problem import End, Objective, Problem, Resources, Solution, UavStart, Visit
from planning.solver.proof import prove
from planning.solver.solver import PROOF_TO_SEARCH, solve
from planning.solver.warm_up import rehearse

NODES = 300
SQUARE_M = 20_000.0
SECOND_WAYS = 0.15  # of the nodes have another line to a near one
AIRSPEED_MPS, POWER_W, WIND_MPS = 12.0, 400.0, 6.0
SEEDS = (11, 23)
WITHIN = 1e-5  # a plan is better than a proven one beyond the rounding of the proof
HEAD = ["targets", "objective", "missions", "proven before", "proven after", "median gap before", "median gap after", "better plans",
        "seconds, median", "most"]  # fmt: skip
TITLE = "Proofs in the background"


@dataclass(frozen=True)
class Mission:
    """A plan before and after its proof."""

    problem: Problem
    before: Solution
    after: Solution
    took_s: float

    @property
    def is_better(self) -> bool:
        return _value(self.problem, self.after) < _value(self.problem, self.before) * (1.0 - WITHIN)


def random_mission(seed: int, targets: int, uavs: int, objective: Objective) -> Problem:
    draw = np.random.default_rng((seed, targets, uavs))
    at = draw.uniform(0.0, SQUARE_M, (NODES, 2))
    apart_m = cdist(at, at)
    lines = minimum_spanning_tree(apart_m).tocoo()
    second = draw.choice(NODES, int(NODES * SECOND_WAYS), replace=False)
    begin = np.concatenate([lines.row, second])
    end = np.concatenate([lines.col, apart_m[second].argsort(axis=1)[:, 3]])
    begin, end = np.concatenate([begin, end]), np.concatenate([end, begin])
    course = at[end] - at[begin]
    length_m = np.hypot(*course.T)
    along_mps = WIND_MPS * course[:, 0] / length_m
    across_mps = WIND_MPS * course[:, 1] / length_m
    leg_s = length_m / (np.sqrt(AIRSPEED_MPS**2 - across_mps**2) + along_mps)
    places, bases = draw.choice(NODES, targets, replace=False), draw.choice(NODES, uavs, replace=False)

    def ways(cost: np.ndarray) -> np.ndarray:
        rows = np.concatenate([bases, places])
        return np.asarray(dijkstra(coo_array((cost, (begin, end)), (NODES, NODES)).tocsr(), indices=rows)[:, rows])

    way_m, way_s = ways(length_m), ways(leg_s)
    seconds = Resources(way_s[:uavs, uavs:], way_s[None, uavs:, uavs:], way_s[uavs:, :uavs])
    to_wh = POWER_W / 3_600.0
    problem = Problem(
        uavs=(UavStart(end=End.RETURN, speed_mps=AIRSPEED_MPS, usable_wh=math.inf, ready_s=60.0),) * uavs,
        visits=tuple(Visit(target, service_s=20.0) for target in range(targets)),
        target_count=targets,
        from_start_m=way_m[:uavs, uavs:],
        between_m=way_m[uavs:, uavs:],
        to_start_m=way_m[uavs:, :uavs],
        objective=objective,
        seconds=seconds,
        wh=Resources(seconds.first * to_wh, seconds.onward * to_wh, seconds.end * to_wh),
    )
    if seed % 2:
        longest_wh = max(problem.route_wh(uav, route) or 0.0 for uav, route in enumerate(solve(problem).routes))
        there_and_back_wh = (problem.wh.first + problem.wh.end.T).max() if problem.wh else 0.0
        usable_wh = max(0.9 * longest_wh, 1.05 * there_and_back_wh)
        problem = replace(problem, uavs=tuple(replace(uav, usable_wh=usable_wh) for uav in problem.uavs))
    return problem


def _value(problem: Problem, solution: Solution) -> float:
    return problem.value(solution.routes)


def proven(problem: Problem, time_s: float) -> Mission:
    search_s = time_s / PROOF_TO_SEARCH
    before = solve(problem, search_s=search_s)
    began = perf_counter()
    after = solve(problem, search_s=search_s, prover=prove)
    return Mission(problem, before, after, perf_counter() - began - (0.0 if before.is_proven else search_s))


def contradictions(mission: Mission) -> int:
    """Return how many plans of other seeds are better than one that is said to be the best."""
    if not mission.after.is_proven:
        return 0
    found = [solve(mission.problem, seed=seed, search_s=1.0) for seed in SEEDS]
    least = _value(mission.problem, mission.after) * (1.0 - WITHIN)
    missed = len(mission.after.unassigned)
    return sum(
        len(other.unassigned) < missed or (len(other.unassigned) == missed and _value(mission.problem, other) < least) for other in found
    )


def row(missions: list[Mission], sizes: str, objective: str) -> list[str]:
    count = len(missions)
    gaps = [f"{100 * median(gap):.2f} %" for gap in ([one.before.gap for one in missions], [one.after.gap for one in missions])]
    took_s = [one.took_s for one in missions]
    return [
        sizes, objective, str(count), str(sum(one.before.is_proven for one in missions)), str(sum(one.after.is_proven for one in missions)),
        *gaps, str(sum(one.is_better for one in missions)), f"{median(took_s):.1f}", f"{max(took_s):.1f}",
    ]  # fmt: skip


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--missions", type=int, default=48)
    parser.add_argument("--time", type=float, default=60.0, help="seconds of each proof")
    parser.add_argument("--write", action="store_true", help="write the table to docs/performance.md")
    options = parser.parse_args()
    rehearse()
    found: dict[tuple[str, str], list[Mission]] = {}
    contradicted = 0
    for number in range(options.missions):
        targets, uavs = 13 + number * 5 % 13, 2 + number % 3
        objective = list(Objective)[number // 2 % 4]
        mission = proven(random_mission(number, targets, uavs, objective), options.time)
        contradicted += contradictions(mission)
        found.setdefault(("13-20" if targets <= 20 else "21-25", objective.value), []).append(mission)
        print(f"{number}: {targets} targets, {uavs} UAVs, {objective.value}: {mission.before.gap:.4f} -> {mission.after.gap:.4f} "
              f"({mission.after.method}), {mission.took_s:.1f} s", flush=True)  # fmt: skip
    rows = [row(missions, *key) for key, missions in sorted(found.items())]
    rows.append(row([one for missions in found.values() for one in missions], "13-25", "all"))
    told = f"Plans of other seeds that are better than a proven one: {contradicted}."
    text = "\n\n".join((table(HEAD, rows), told, machine("ortools", "numba")))
    print(text)
    if options.write:
        write_section(TITLE, text)
    return 1 if contradicted else 0


if __name__ == "__main__":
    sys.exit(main())
