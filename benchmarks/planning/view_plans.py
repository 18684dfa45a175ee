"""Photos of towers and bridges: how much they show, how many they are against a bound, how near the flight comes to what stands there, and
what planning takes.

    python -m benchmarks.planning.view_plans [--kind towers|bridges] [--first N] [--write]

Twenty models of towers, seven of bridges, three cameras of the catalogue, two ground sample distances. Coverage is measured on patches that
are a third as long as the planner's; what can be shown is looked for from each patch, not among the planner's candidates. Nearest approach
is that of places every 0.3 m (0.1 s at 3 m/s) to all triangles and to wires with and without sag, still and swung with their strings, by
plain formulas.
The bound is that of the linear relaxation over the candidates that were weighed. --write puts the tables into docs/performance.md.
Exits with 1 where less than 95 % (of bridges 90 %) of what can be shown is shown, or a flight comes nearer than the clearance.
"""

import argparse
import sys
import time
from collections.abc import Callable, Iterator
from functools import partial
from itertools import islice
from typing import NamedTuple

import numpy as np

from benchmarks.report import machine, table, write_section
from config.compiled.compiled_core import use_compiled_directory
from planning.views.catalogue import catalogue
from planning.views.coverage import coverage_of
from planning.views.detail_views import DetailViews, detail_views
from planning.views.limits import LIMITS, DetailRules, Limit, limits_of
from planning.views.proof import reach_m
from planning.views.site import InspectionSite
from planning.views.solids import patches_of
from planning.views.view_flight import view_flight
from planning.views.visibility import RayCaster
from tests.planning.views.bridges import BRIDGES, site_of
from tests.planning.views.geometry_oracle import flown_places, to_triangles_m, to_wires_m
from tests.planning.views.towers import TOWERS, StandingTower, standing

TITLES = {"towers": "Photos of towers", "bridges": "Photos of bridges"}
CAMERAS = ("dji-m30t-zoom", "dji-p1-50", "dji-m4e-tele")
GSDS_M = (0.002, 0.004)
SHARES = {"towers": 0.95, "bridges": 0.9}  # of long bridges a very long lens leaves out more
PATCH_M, STEP_M = 0.8, 0.3
ABOVE_M = 2.0  # the keep-out, where flights begin
Nearest = Callable[[np.ndarray], float]


class Measured(NamedTuple):
    """Of one tower, camera and GSD; clearance_m is what the nearest approach has beyond what is asked for."""

    share: float
    reachable: float
    photos: int
    bound: int
    spare_m: float
    plan_s: float
    flight_s: float
    limit: str


def measured(site: InspectionSite, nearest_m: Nearest, key: str, gsd_m: float) -> Measured:
    camera, rules = catalogue()[key].camera, DetailRules(gsd_m)
    began = time.process_time()
    views = detail_views(site, camera, rules)
    planned = time.process_time()
    entry = np.array([0.0, 0.0, site.keep_out.top_at(np.zeros(2)) + ABOVE_M])
    flight = view_flight(views.poses, site.keep_out, entry, entry)
    flown = time.process_time()
    patches, caster = patches_of(site.solid, PATCH_M), RayCaster([site.solid])
    farthest_m = reach_m(camera, gsd_m)
    limits = limits_of(patches, site.keep_out, caster, camera, farthest_m)
    coverage = coverage_of(views.poses, views.lens, camera, patches, caster, limits.limit)
    barred_m2 = np.bincount(limits.limit, patches.area_m2, minlength=len(LIMITS))
    barred_m2[LIMITS.index(Limit.NONE)] = 0.0
    return Measured(
        coverage.share, float(patches.area_m2[coverage.reachable].sum() / patches.area_m2.sum()), len(views.poses), views.bound,
        nearest_m(flown_places(flight, STEP_M)) - site.clearance_m, planned - began, flown - planned,
        LIMITS[int(barred_m2.argmax())].value,
    )  # fmt: skip


def sites(kind: str) -> Iterator[tuple[str, InspectionSite, Nearest]]:
    """Yield each asset's name and site, and the nearest approach of places to it and its wires."""
    for name in TOWERS if kind == "towers" else ():
        stands = standing(TOWERS[name])
        yield name, stands.site, partial(nearest_of_tower_m, stands)
    for name in BRIDGES if kind == "bridges" else ():
        site = site_of(BRIDGES[name])
        yield name, site, partial(nearest_of_bridge_m, site)


def nearest_of_tower_m(stands: StandingTower, places: np.ndarray) -> float:
    wires_m = [to_wires_m(places, stands.supports, start, end).min() for start, end in ((0, 1), (2, 0))]
    return float(min(to_triangles_m(places, stands.solid.triangles).min(), *wires_m))


def nearest_of_bridge_m(site: InspectionSite, places: np.ndarray) -> float:
    return float(to_triangles_m(places, site.solid.triangles).min())


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kind", choices=list(TITLES), action="append")
    parser.add_argument("--first", type=int, default=len(TOWERS), help="so many of each kind")
    parser.add_argument("--write", action="store_true")
    arguments = parser.parse_args()
    use_compiled_directory()
    warm_up()
    return max(run(kind, arguments.first, writes=arguments.write) for kind in arguments.kind or TITLES)


def run(kind: str, first: int, *, writes: bool) -> int:
    found: dict[tuple[str, float], list[Measured]] = {}
    for name, site, nearest_m in islice(sites(kind), first):
        for key in CAMERAS:
            for gsd_m in GSDS_M:
                own = measured(site, nearest_m, key, gsd_m)
                found.setdefault((key, gsd_m), []).append(own)
                figures = (f"{value:.3f}" if isinstance(value, float) else value for value in own)
                print(name, key, f"{gsd_m * 1000:.0f} mm", *figures, flush=True)
    rows = [[key, f"{gsd_m * 1000:.0f}", *summary(own)] for (key, gsd_m), own in found.items()]
    every = [own for cases in found.values() for own in cases]
    rows.append(["all", "", *summary(every)])
    heads = ["camera", "GSD [mm]", "least shown of what can be shown", "can be shown", "photos", "over the bound: all, most",
             "nearest approach beyond the clearance [m]", "CPU to plan, median [s]", "most [s]"]  # fmt: skip
    print(table(heads, rows))
    if writes:
        told = f"`python -m benchmarks.planning.view_plans`: {len(every)} cases. {machine('numpy', 'scipy', 'embreex')}"
        write_section(TITLES[kind], f"{told}\n\n{table(heads, rows)}")
    return int(any(own.share < SHARES[kind] or own.spare_m < 0.0 for own in every if own.photos))


def summary(cases: list[Measured]) -> list[str]:
    some = [own for own in cases if own.photos]
    taken_s = [own.plan_s + own.flight_s for own in some]
    reachable = [own.reachable for own in cases]
    return [
        f"{min(own.share for own in some):.1%}",
        f"{min(reachable):.0%} to {max(reachable):.0%}",
        str(sum(own.photos for own in some)),
        f"{sum(own.photos for own in some) / sum(own.bound for own in some):.2f}, {max(own.photos / own.bound for own in some):.2f}",
        f"{min(own.spare_m for own in some):+.2f}",
        f"{np.median(taken_s):.1f}",
        f"{max(taken_s):.1f}",
    ]


def warm_up() -> DetailViews:
    """Import and compile what the first plan would."""
    stands = standing(TOWERS["wooden pole, 20 kV"])
    views = detail_views(stands.site, catalogue()[CAMERAS[0]].camera, DetailRules(GSDS_M[0]))
    view_flight(views.poses, stands.keep_out, stands.entry, stands.entry)
    return views


if __name__ == "__main__":
    sys.exit(main())
