"""Lines inspected by several UAVs: shared in parts, beside whole lines that one UAV flies each.

    .venv/bin/python benchmarks/planning/shared_lines.py [--uavs 2 4] [--longest 5] [--line REF] [--part 1000] [--write]

Plans on the map data of the database, such as the demo region's after ./run, with a UAV at each end of the line in turn. For each of the
longest lines: when the last UAV is back, and how long planning takes, with the line as one target and in parts. Exits with 1 where
sharing is later by over a second, or leaves a part out that is flown as a whole.
"""

import argparse
import os
import sys
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any

import django

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
django.setup()

from benchmarks.report import machine, table, write_section  # noqa: E402 (Django first)
from config.compiled.compiled_core import use_compiled_directory  # noqa: E402
from inspection.geodesy import LonLat  # noqa: E402
from inspection.models import Asset, AssetKind  # noqa: E402
from inspection.selectors.picking import NotOneLine, parts_of_asset  # noqa: E402
from missions.services import PlanRequest, TargetRequest, UavRequest, make_plan  # noqa: E402
from planning.problem import Objective  # noqa: E402
from planning.request import EndAction  # noqa: E402

TITLE = "Lines shared among UAVs"
SPEED_MPS = 16.0


@dataclass(frozen=True)
class Planned:
    finish_s: float
    km: float
    left_out: int
    bound_s: float | None
    seconds: float


def planned(ends: tuple[LonLat, LonLat], targets: list[TargetRequest], uavs: int) -> Planned:
    fleet = tuple(UavRequest(f"UAV {number}", ends[number % 2], None, SPEED_MPS, EndAction.RETURN) for number in range(uavs))
    began_s = perf_counter()
    plan: dict[str, Any] = make_plan(request=PlanRequest(fleet, tuple(targets), Objective.MAKESPAN, True))
    return Planned(
        finish_s=max(route["departs_s"] + route["duration_s"] for route in plan["routes"]),
        km=plan["total_length_m"] / 1_000.0,
        left_out=len(plan["unassigned"]),
        bound_s=plan["lower_bound_s"],
        seconds=perf_counter() - began_s,
    )


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--uavs", type=int, nargs="+", default=[2, 4])
    parser.add_argument("--longest", type=int, default=5, help="lines")
    parser.add_argument("--line", help="the reference of the only line")
    parser.add_argument("--part", type=float, default=1_000.0, help="metres")
    parser.add_argument("--write", action="store_true", help="into docs/performance.md")
    options = parser.parse_args()
    use_compiled_directory()
    lines = Asset.objects.filter(kind=AssetKind.LINE, is_flyable=True, vanished_at=None, length_m__gte=2 * options.part).order_by(
        "-length_m"
    )
    if options.line:
        lines = lines.filter(ref=options.line)
    rows, is_worse, compared = [], False, 0
    for line in lines.iterator():
        try:
            parts = parts_of_asset(line, options.part)
        except NotOneLine:
            continue
        if len(parts) < 2:
            continue
        ends = parts[0].start, parts[-1].end
        shared_targets = [TargetRequest(line.pk, stretch=(part.start, part.end)) for part in parts]
        if not compared:
            planned(ends, shared_targets[:1], 1)  # loads the graph and its indices
        for uavs in options.uavs:
            whole, shared = planned(ends, [TargetRequest(line.pk)], uavs), planned(ends, shared_targets, uavs)
            is_worse |= not whole.left_out and (shared.left_out > 0 or shared.finish_s > whole.finish_s + 1.0)
            bound = "none" if shared.bound_s is None else f"{shared.bound_s / 60.0:.1f}"
            rows.append([
                f"{line.ref or line.pk}, {(line.length_m or 0.0) / 1_000.0:.1f} km", str(len(parts)), str(uavs),
                f"{whole.finish_s / 60.0:.1f}" if not whole.left_out else "left out", f"{shared.finish_s / 60.0:.1f}",
                f"{shared.finish_s / whole.finish_s:.2f}" if not whole.left_out else "–", bound, f"{whole.km:.1f} and {shared.km:.1f}",
                str(shared.left_out), f"{whole.seconds:.2f} and {shared.seconds:.2f}",
            ])  # fmt: skip
            print(*rows[-1], sep="  ", flush=True)
        compared += 1
        if compared == options.longest:
            break
    heads = ["line", "parts", "UAVs", "done after, whole [min]", "shared [min]", "ratio", "bound [min]", "km, whole and shared",
             "parts left out", "planned in [s], whole and shared"]  # fmt: skip
    print(table(heads, rows))
    if options.write:
        write_section(TITLE, f"`python benchmarks/planning/shared_lines.py`, demo region. {machine('numpy')}\n\n{table(heads, rows)}")
    return int(is_worse or not rows)


if __name__ == "__main__":
    sys.exit(main())
