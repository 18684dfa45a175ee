"""How fast small plans are beside the article's method on the same graph and missions, and what a million nodes cost.

    python -m benchmarks.planning.plan_speed [--write] [--near 100] [--anywhere 100] [--article-s 300]

`manage.py plan_file` plans missions of 2 UAVs and 4 targets on a graph of 200,000 nodes, within 30 km and anywhere in a component; the
article's method (benchmarks/planning/paper_baseline.py) plans the same, anywhere as many as there is time for. No plan may be costlier.
Then a graph of 1,000,000 nodes is indexed, and a planner's process maps the stored index and plans. With --write the table goes to
docs/performance.md. Exits with 1 where a bar is missed.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from benchmarks.network.make_graph import make, missions
from benchmarks.planning.paper_baseline import build, plan
from benchmarks.report import machine, table, write_section

ROOT = Path(__file__).resolve().parents[2]
UAVS, TARGETS = 2, 4
NEAR_M = 30_000.0
MIN_RATIO = {"within 30 km": 50.0, "anywhere": 3_000.0}
MAX_INDEX_S, MAX_PLANNER_MIB, MAX_PLAN_MS = 15.0, 400.0, 1.0
SAME_M = 1e-6


@dataclass(frozen=True)
class Planned:
    plans: list[dict[str, Any]]
    index_s: float
    peak_mib: float

    @property
    def median_ms(self) -> float:
        return median(plan["ms"]["total"] for plan in self.plans)


def plan_file(graph: Path, asked: list[dict[str, Any]], folder: Path) -> Planned:
    """Run the command in a process of its own."""
    (folder / "missions.json").write_text(json.dumps(asked))
    command = [sys.executable, "manage.py", "plan_file", "--graph", str(graph)]
    command += ["--missions", str(folder / "missions.json"), "--json", str(folder / "plans.json")]
    process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True)
    stated = process.stdout.read() if process.stdout else ""
    _, status, usage = os.wait4(process.pid, 0)
    if status:
        raise SystemExit("plan_file has failed")
    return Planned(json.loads((folder / "plans.json").read_bytes()), float(stated.split(" in ")[1].split(" s;")[0]), usage.ru_maxrss / 1024)


def article_ms(network: tuple[Any, Any], graph: Any, asked: list[dict[str, Any]], ours: Planned, limit_s: float) -> list[float]:
    """Milliseconds of the article's method for as many missions as there is time for. Ends the run where ours is costlier."""
    ends_s, times = time.monotonic() + limit_s, []
    for number, mission in enumerate(asked):
        if times and time.monotonic() > ends_s:
            break
        theirs = plan(*network, graph["lat"], graph["lon"], mission)
        times.append(theirs["ms"]["total"])
        if ours.plans[number]["cost_m"] > theirs["cost_m"] + SAME_M:
            raise SystemExit(f"mission {number} is costlier than the article's: {ours.plans[number]['cost_m']} m, {theirs['cost_m']} m")
    return times


def compare(options: argparse.Namespace, folder: Path) -> tuple[list[list[str]], list[str]]:
    """Rows of the table, and which bars are missed."""
    graph = make(options.nodes)
    np.savez(folder / "graph.npz", **graph)
    network = build(graph["lat"], graph["lon"], graph["u"], graph["v"], graph["w"])
    rows, missed = [], []
    for name, radius_m, count in (("within 30 km", NEAR_M, options.near), ("anywhere", None, options.anywhere)):
        asked = missions(graph, UAVS, TARGETS, count, radius_m=radius_m)
        ours = plan_file(folder / "graph.npz", asked, folder)
        theirs = article_ms(network, graph, asked, ours, options.article_s)
        ratio = median(theirs) / median(plan["ms"]["total"] for plan in ours.plans[: len(theirs)])
        if ratio < MIN_RATIO[name]:
            missed.append(f"{name}: {ratio:.0f} times as fast, less than {MIN_RATIO[name]:.0f}")
        compared = f"{len(theirs)} of {count}"
        rows.append([name, f"{ours.median_ms:.3f} ms", f"{median(theirs):,.1f} ms", f"{ratio:,.0f}", compared, "0"])
        print(*rows[-1], sep="  ", flush=True)
    return rows, missed


def large(options: argparse.Namespace, folder: Path) -> tuple[list[list[str]], list[str]]:
    """The graph of a million nodes: rows of the table, and which bars are missed."""
    graph = make(options.large_nodes)
    np.savez(folder / "large.npz", **graph)
    subprocess.run([sys.executable, "-m", "benchmarks.network.large_graph", "--store", str(folder)], cwd=ROOT, check=True)
    rows, missed = [], []
    for name, radius_m in (("within 30 km", NEAR_M), ("anywhere", None)):
        asked = missions(graph, UAVS, TARGETS, options.near, radius_m=radius_m)
        ours = plan_file(folder / "large.npz", asked, folder)
        (folder / "missions.json").write_text(json.dumps(asked))
        child = [sys.executable, "-m", "benchmarks.network.large_graph", "--planner", str(folder)]
        stated = json.loads(subprocess.run(child, cwd=ROOT, check=True, stdout=subprocess.PIPE).stdout)
        rows.append(
            [name, f"{ours.index_s:.2f} s", f"{ours.peak_mib:.0f} MiB", f"{ours.median_ms:.3f} ms", f"{stated['peak_mib']:.0f} MiB"]
        )
        print(*rows[-1], sep="  ", flush=True)
        if ours.index_s > MAX_INDEX_S or stated["peak_mib"] > MAX_PLANNER_MIB or ours.median_ms > MAX_PLAN_MS:
            missed.append(f"{options.large_nodes:,} nodes, {name}")
    return rows, missed


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--nodes", type=int, default=200_000)
    parser.add_argument("--large-nodes", type=int, default=1_000_000)
    parser.add_argument("--near", type=int, default=100, help="missions within 30 km")
    parser.add_argument("--anywhere", type=int, default=100, help="missions anywhere in a component")
    parser.add_argument("--article-s", type=float, default=300.0, help="no mission of the article's method begins later than this")
    parser.add_argument("--write", action="store_true", help="into docs/performance.md")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        rows, missed = compare(options, folder)
        large_rows, large_missed = large(options, folder)
    head = [
        "2 UAVs, 4 targets, 200,000 nodes",
        "Spanwise, median",
        "the article's method",
        "times as fast",
        "missions compared",
        "costlier",
    ]
    large_head = [
        f"{options.large_nodes:,} nodes",
        "index",
        "plan_file, most memory",
        "plan, median",
        "planner with mapped index, most memory",
    ]
    text = (
        f"`python -m benchmarks.planning.plan_speed`: positions to finished JSON, one process, beside the article's method on the "
        f"same missions. "
        f"{machine('numba', 'numpy', 'networkx', 'ortools')}\n\n{table(head, rows)}\n\n{table(large_head, large_rows)}"
    )
    print(text)
    if options.write:
        write_section("Speed of small plans", text)
    if missed or large_missed:
        raise SystemExit("missed: " + "; ".join(missed + large_missed))


if __name__ == "__main__":
    main()
