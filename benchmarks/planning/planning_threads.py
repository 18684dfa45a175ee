"""What a small plan costs where several threads of one process plan: by turns, as they do, and all at once.

    .venv/bin/python benchmarks/planning/planning_threads.py --threads 1 2 4 8 --count 600

On the ground in the database. Time is of the process (user and system, over all its threads), for each plan; changes are the times that
a thread gave its core up to wait, which is what threads that take the interpreter from each other do.
"""

import argparse
import os
import resource
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import nullcontext
from pathlib import Path
from threading import Lock
from time import perf_counter
from unittest import mock

import django

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
django.setup()

from django.db import connections  # noqa: E402 (Django first)

from benchmarks.planning.plan_latency import missions  # noqa: E402
from benchmarks.report import machine  # noqa: E402
from inspection.selectors import current_graph  # noqa: E402
from missions.services import PlanRequest, TargetRequest, UavRequest, make_plan  # noqa: E402
from missions.services.planning import planner  # noqa: E402
from planning.problem import Objective  # noqa: E402
from planning.request import EndAction  # noqa: E402


def requests(uavs: int, targets: int, count: int, seed: int) -> list[PlanRequest]:
    graph = current_graph()
    return [
        PlanRequest(
            tuple(UavRequest(f"UAV {number}", start, None, 12.0, EndAction.HOVER) for number, start in enumerate(starts)),
            tuple(TargetRequest(int(graph.node_asset[node])) for node in nodes),
            Objective.TOTAL,
            False,
        )
        for starts, nodes in missions(graph, uavs, targets, count, seed)
    ]


def plan_all(asked: Iterator[PlanRequest], taking: Lock) -> None:
    try:
        while True:
            with taking:
                request = next(asked, None)
            if request is None:
                return
            make_plan(request=request, as_text=True)
    finally:
        connections.close_all()


def measured(asked: Sequence[PlanRequest], threads: int) -> str:
    used, began_s, taking, left = resource.getrusage(resource.RUSAGE_SELF), perf_counter(), Lock(), iter(asked)
    with ThreadPoolExecutor(threads) as pool:
        for made in [pool.submit(plan_all, left, taking) for _ in range(threads)]:
            made.result()
    now, count = resource.getrusage(resource.RUSAGE_SELF), len(asked)
    cpu_ms = 1_000 * (now.ru_utime - used.ru_utime + now.ru_stime - used.ru_stime) / count
    return (
        f"{cpu_ms:5.2f} ms a plan, {(now.ru_nvcsw - used.ru_nvcsw) / count:4.0f} changes, {count / (perf_counter() - began_s):4.0f} plans/s"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2, 4, 8])
    parser.add_argument("--uavs", type=int, default=2)
    parser.add_argument("--targets", type=int, default=4)
    parser.add_argument("--count", type=int, default=600)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    print(machine())
    asked = requests(options.uavs, options.targets, options.count, options.seed)
    measured(asked[:100], 1)  # the first ones load the graph and its indices
    for threads in options.threads:
        print(f"{threads} threads by turns: {measured(asked, threads)}")
        with mock.patch.object(planner, "hold_planning_lock", nullcontext):
            print(f"{threads} threads at once:  {measured(asked, threads)}", flush=True)


if __name__ == "__main__":
    main()
