"""Photos of wires from both sides: how much they show, how near the flight comes to wires that swing, and what planning takes.

    python -m benchmarks.planning.span_views [--towers N] [--write]

Twenty models of towers 300 m apart, two cameras of the catalogue, two ground sample distances. Coverage is that of the band in which wires
hang, patch by patch; nearest approach is that of places every 0.3 m to all triangles and wires, as in benchmarks.planning.view_plans.
Exits with 1 where less than 95 % of what can be shown is shown though photos are taken, or a flight comes nearer than the clearance.
"""

import argparse
import sys
import time
from typing import NamedTuple

import numpy as np

from benchmarks.planning.view_plans import STEP_M, nearest_m
from benchmarks.report import machine, table, write_section
from planning.views.catalogue import catalogue
from planning.views.detail_views import TooManyPhotos
from planning.views.view_plan import ViewSpeeds, spans_plan
from tests.planning.views.geometry_oracle import flown_places
from tests.planning.views.towers import SPAN_M, TOWERS, standing

TITLE = "Photos of wires"
CAMERAS = ("dji-m30t-zoom", "dji-p1-50")
GSDS_M = (0.004, 0.008)
SHARE = 0.95
AROUND_M = SPAN_M / 2.0 + 80.0


class Measured(NamedTuple):
    """Of one tower, camera and GSD; spare_m is what the nearest approach has beyond the clearance."""

    share: float
    reachable: float
    photos: int
    minutes: float
    spare_m: float
    plan_s: float


def measured(tower: str, key: str, gsd_m: float) -> Measured | None:
    """Return the figures; None where it would take too many photos."""
    stands = standing(TOWERS[tower], around_m=AROUND_M)
    began = time.process_time()
    try:
        plan = spans_plan(stands.site, catalogue()[key].camera, gsd_m, ViewSpeeds())
    except TooManyPhotos:
        return None
    plan_s = time.process_time() - began
    area_m2 = plan.coverage.patches.area_m2
    reachable = float(area_m2[plan.coverage.reachable].sum() / area_m2.sum())
    spare_m = nearest_m(stands, flown_places(plan.flight, STEP_M)) - stands.clearance_m
    return Measured(plan.coverage.share, reachable, len(plan.poses), plan.seconds / 60.0, spare_m, plan_s)


def row(key: str, gsd_m: float, cases: list[Measured | None]) -> list[str]:
    taken = [own for own in cases if own is not None and own.photos]
    minutes = [own.minutes for own in taken]
    return [
        key, f"{gsd_m * 1000:.0f}", str(len(taken)), str(cases.count(None)), f"{min(own.share for own in taken):.1%}",
        f"{np.median([own.photos for own in taken]):.0f}", f"{np.median(minutes):.0f}", f"{min(own.spare_m for own in taken):+.2f}",
        f"{np.median([own.plan_s for own in taken]):.1f}", f"{max(own.plan_s for own in taken):.1f}",
    ]  # fmt: skip


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--towers", type=int, default=len(TOWERS))
    parser.add_argument("--write", action="store_true")
    arguments = parser.parse_args()
    measured("wooden pole, 20 kV", CAMERAS[0], GSDS_M[0])  # imports and compiles what the first plan would
    rows, every = [], list[Measured]()
    for key in CAMERAS:
        for gsd_m in GSDS_M:
            cases = [measured(tower, key, gsd_m) for tower in list(TOWERS)[: arguments.towers]]
            rows.append(row(key, gsd_m, cases))
            every += [own for own in cases if own is not None]
            print(*rows[-1], flush=True)
    heads = ["camera", "GSD [mm]", "towers photographed", "over 200 photos", "least shown of what can be shown", "photos, median",
             "minutes, median", "nearest approach beyond the clearance [m]", "CPU to plan, median [s]", "most [s]"]  # fmt: skip
    print(table(heads, rows))
    if arguments.write:
        told = f"`python -m benchmarks.planning.span_views`: {len(TOWERS)} towers. {machine('numpy', 'scipy', 'embreex')}"
        write_section(TITLE, f"{told}\n\n{table(heads, rows)}")
    return int(any(own.photos and (own.share < SHARE or own.spare_m < 0.0) for own in every))


if __name__ == "__main__":
    sys.exit(main())
