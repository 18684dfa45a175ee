"""What wind, batteries and sorties cost the solver: milliseconds beside the same problem without them, gaps of large plans.

    .venv/bin/python -m benchmarks.planning.wind_and_battery [--instances 5] [--search-s 2] [--large 60]

Places and starts lie at random in a square of 6 km; UAVs fly 11 m/s through the air, the wind blows from the west at 6 m/s, and flying
takes 180 W. With `some` a battery lasts for about a third of what one UAV would need for all, with `ample` nothing is short. Two of the
three UAVs are of one class, the third flies 8 m/s with 120 W.
"""

import argparse
import math
from dataclasses import replace
from time import perf_counter

import numpy as np

from planning.problem import End, FloatArray, Objective, Problem, Resources, UavStart, Visit
from planning.solver import exact
from planning.solver.problem_arrays import Arcs
from planning.solver.solver import solve
from planning.solver.warm_up import rehearse

SQUARE_M = 6_000.0
WIND_MPS = 6.0
AIRSPEEDS_MPS, POWERS_W = (11.0, 8.0), (180.0, 120.0)
SERVICE_S = 10.0
BATTERIES = {"ample": math.inf, "some": 1 / 3}  # of the Wh of one UAV for all


def seconds(start: FloatArray, end: FloatArray, airspeed_mps: float) -> FloatArray:
    """(n, 2) and (m, 2) metres east, north → (n, m): the ground speed is what the wind leaves after the drift is held against."""
    way = end[None] - start[:, None]
    length_m = np.hypot(way[..., 0], way[..., 1])
    unit = np.divide(way, length_m[..., None], out=np.zeros_like(way), where=length_m[..., None] > 0)
    ground_mps = np.sqrt(airspeed_mps**2 - (WIND_MPS * unit[..., 1]) ** 2) + WIND_MPS * unit[..., 0]
    return np.asarray(length_m / ground_mps, dtype=np.float64)


def windy(seed: int, targets: int, objective: Objective, battery: str | None, sorties: int = 1) -> Problem:
    """Three UAVs; without a battery metres at a speed of 11 m/s alone."""
    draw = np.random.default_rng(seed)
    starts, places = draw.uniform(0.0, SQUARE_M, (3, 2)), draw.uniform(0.0, SQUARE_M, (targets, 2))
    plain = Problem(
        uavs=tuple(UavStart(end=End.RETURN, speed_mps=AIRSPEEDS_MPS[0], sorties=sorties, turnaround_s=180.0) for _ in range(3)),
        visits=tuple(Visit(target, service_s=SERVICE_S) for target in range(targets)),
        target_count=targets,
        from_start_m=np.hypot(*(starts[:, None] - places[None]).transpose(2, 0, 1)),
        between_m=np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1)),
        to_start_m=np.hypot(*(places[:, None] - starts[None]).transpose(2, 0, 1)),
        objective=Objective.TOTAL,
    )
    if battery is None:
        return replace(plain, objective=objective)
    class_of = (0, 0, 1)
    flown = Resources(
        np.concatenate([seconds(starts[[uav]], places, AIRSPEEDS_MPS[number]) for uav, number in enumerate(class_of)]),
        np.stack([seconds(places, places, airspeed_mps) for airspeed_mps in AIRSPEEDS_MPS]),
        np.concatenate([seconds(places, starts[[uav]], AIRSPEEDS_MPS[number]) for uav, number in enumerate(class_of)], axis=1),
    )
    watt_hours = np.array(POWERS_W) / 3_600.0
    by_uav = watt_hours[list(class_of)]
    wh = Resources(
        flown.first * by_uav[:, None],
        flown.onward * watt_hours[:, None, None],
        flown.end * by_uav,
        service=np.tile(SERVICE_S * watt_hours[:, None], (1, targets)),
        ready=np.full(3, 1.5),
    )
    uavs = tuple(replace(uav, usable_wh=math.inf) for uav in plain.uavs)
    ample = replace(plain, seconds=flown, wh=wh, class_of=class_of, uavs=uavs, objective=objective)
    if math.isinf(BATTERIES[battery]):
        return ample
    alone = solve(replace(ample, uavs=tuple(replace(uav, sorties=1) for uav in ample.uavs), objective=Objective.ENERGY))
    usable_wh = BATTERIES[battery] * (alone.total_wh or 0.0) + 10.0
    return replace(ample, uavs=tuple(replace(uav, usable_wh=usable_wh) for uav in ample.uavs))


def least_ms(problem: Problem) -> float:
    arcs, least_s = Arcs.of(problem), math.inf
    for _ in range(5):
        began_s = perf_counter()
        exact.proven_routes(arcs)
        least_s = min(least_s, perf_counter() - began_s)
    return least_s * 1_000.0


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--instances", type=int, default=5)
    parser.add_argument("--search-s", type=float, default=2.0)
    parser.add_argument("--large", type=int, default=60, help="targets of the plans that are searched for; 0: none")
    options = parser.parse_args()
    rehearse()
    plain_ms = {objective: least_ms(windy(0, 12, objective, None)) for objective in (Objective.TOTAL, Objective.MAKESPAN, Objective.TIME)}
    print("12 targets, plain, ms: " + ", ".join(f"{objective} {took_ms:.1f}" for objective, took_ms in plain_ms.items()))
    for objective in Objective:
        base_ms = plain_ms.get(objective, plain_ms[Objective.TOTAL])
        for battery, sorties in (("ample", 1), ("some", 1), ("some", 2)):
            problems = [windy(seed, 12, objective, battery, sorties) for seed in range(options.instances)]
            took_ms = [least_ms(problem) for problem in problems]
            solved = [solve(problem) for problem in problems]
            print(
                f"12 targets, {objective}, {battery} battery, {sorties} sorties: {np.median(took_ms):.1f} ms (most {max(took_ms):.1f}), "
                f"{np.median(took_ms) / base_ms:.1f} x plain, proven {sum(plan.is_proven for plan in solved)} of {len(solved)}, "
                f"left out {sum(len(plan.unassigned) for plan in solved)}",
                flush=True,
            )
    for objective in Objective if options.large else ():
        for battery, sorties in (("ample", 1), ("some", 1), ("some", 3)):
            plan = solve(windy(0, options.large, objective, battery, sorties), search_s=options.search_s)
            print(f"{options.large} targets, {objective}, {battery} battery, {sorties} sorties: gap {100 * plan.gap:.1f} %", end="")
            print(f", left out {len(plan.unassigned)}, sorties {[len(flown) for flown in plan.sorties]}", flush=True)


if __name__ == "__main__":
    main()
