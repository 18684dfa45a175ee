"""Campaigns over all lines of a voltage: sites, days, kilometres and time of planning, beside bounds.

    .venv/bin/python benchmarks/campaigns.py [--voltage 100] [--reach 2000 3000 5000] [--crews 1 2] [--day 8] [--write]

Plans on the map data of the database, such as the demo region's after ./run: every line of at least so many kV in parts of about 1 km, one
UAV of 12 km a battery, six flights a site. Bounds: the fewest sites by integer programming (HiGHS in SciPy) over the same candidates, and
the fewest days as work, set-up and one shortest drive there and back over the working day. Exits with 1 where a day is too long, a part is
in two missions, or a part is lost.
"""

import argparse
import math
import os
import resource
import sys
from pathlib import Path
from time import perf_counter
from typing import Any

import django
import numpy as np
from scipy.optimize import Bounds, LinearConstraint, milp

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
django.setup()

from benchmarks.report import machine, table, write_section  # noqa: E402 (Django first)
from config.compiled.compiled_core import use_compiled_directory  # noqa: E402
from inspection.geodesy import LonLat, distance_m  # noqa: E402
from inspection.models import Asset, AssetKind  # noqa: E402
from inspection.selectors.picking import NotOneLine, parts_of_asset  # noqa: E402
from missions.selectors.planning_context import current_airspace  # noqa: E402
from missions.selectors.resolved_targets import resolved_targets  # noqa: E402
from missions.services import PlanRequest, TargetRequest, UavRequest, make_plan  # noqa: E402
from planning.campaigns.campaign import PlannedCampaign, plan_campaign  # noqa: E402
from planning.campaigns.crew_days import ROAD_FACTOR, Crews  # noqa: E402
from planning.campaigns.launch_sites import places_beside  # noqa: E402
from planning.campaigns.rules import CampaignRules  # noqa: E402
from planning.problem import Objective  # noqa: E402
from planning.request import EndAction  # noqa: E402
from planning.solver.solver import never  # noqa: E402

TITLE = "Campaigns over several days"
PART_M = 1_000.0
SEARCH_S = 1.0  # as missions/services/campaigns.py


def targets_of(voltage_v: int) -> list[TargetRequest]:
    targets = []
    for line in Asset.objects.filter(kind=AssetKind.LINE, is_flyable=True, vanished_at=None).order_by("pk").iterator():
        if max(line.voltages_v or [0]) < voltage_v:
            continue
        try:
            parts = parts_of_asset(line, PART_M)
        except NotOneLine:
            targets.append(TargetRequest(line.pk))
        else:
            targets += [TargetRequest(line.pk, stretch=(part.start, part.end)) for part in parts]
    return targets


def fewest_sites(courses: list[tuple[LonLat, ...]], candidates: list[LonLat], reach_m: float) -> int:
    """Return the least number of candidates that cover what any of them covers."""
    at = np.array(candidates)
    covers = np.array([
        np.max([distance_m(np.broadcast_to(np.array(point), at.shape), at) for point in course], axis=0) <= reach_m for course in courses
    ])  # fmt: skip
    covers = covers[covers.any(axis=1)].astype(float)
    solution = milp(np.ones(len(at)), constraints=LinearConstraint(covers, lb=1.0), integrality=np.ones(len(at)), bounds=Bounds(0, 1))
    return round(solution.fun)


def fewest_days(planned: PlannedCampaign, crews: Crews) -> int:
    """Return a bound: all work, a set-up at each site, and for each crew and day one drive to the nearest site and back."""
    if not planned.missions:
        return 0
    work_s = sum(mission.work_s for mission in planned.missions) + crews.set_up_s * len(planned.sites)
    sites = np.array([site.position for site in planned.sites])
    nearest_s = float(distance_m(np.broadcast_to(np.array(crews.start), sites.shape), sites).min()) * ROAD_FACTOR / crews.drive_mps
    return math.ceil(work_s / (crews.day_s - 2.0 * nearest_s) / crews.count)


def faults_of(planned: PlannedCampaign, targets: int, crews: Crews) -> list[str]:
    flown = [target for mission in planned.missions for target in mission.flown]
    lost = set(range(targets)) - set(flown) - {one.target for one in planned.unassigned}
    return [
        *(["a part is in two missions"] if len(flown) != len(set(flown)) else []),
        *([f"parts are lost: {sorted(lost)}"] if lost else []),
        *(["a day is too long"] if any(day.ends_s > crews.day_s for day in planned.schedule.days) else []),
    ]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--voltage", type=float, default=100.0, help="kV")
    parser.add_argument("--reach", type=float, nargs="+", default=[2_000.0, 3_000.0, 5_000.0], help="metres")
    parser.add_argument("--crews", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--day", type=float, default=8.0, help="hours")
    parser.add_argument("--write", action="store_true", help="into docs/performance.md")
    options = parser.parse_args()
    use_compiled_directory()
    targets = targets_of(int(1_000 * options.voltage))
    places, _ = resolved_targets(targets)
    courses = [place.course for place in places]
    start = courses[0][0]
    uav = UavRequest("UAV", start, 12_000.0, 10.0, EndAction.RETURN)
    request = PlanRequest((uav,), tuple(targets), Objective.TOTAL, True)
    airspace = current_airspace(request)
    candidates = places_beside(courses, airspace)

    def make(asked: PlanRequest, share: float) -> dict[str, Any]:
        return make_plan(request=asked, search_s=SEARCH_S)

    make(PlanRequest((uav,), tuple(targets[:1]), Objective.TOTAL, True), 1.0)  # loads the graph and its indices
    rows, faults = [], []
    for reach_m in options.reach:
        bound = fewest_sites(courses, candidates, reach_m)
        for count in options.crews:
            crews = Crews(start, count, day_s=options.day * 3_600.0)
            began_s = perf_counter()
            planned = plan_campaign(courses, request, CampaignRules(crews, reach_m, 6), airspace=airspace, make_plan=make, stop=never)
            took_s = perf_counter() - began_s
            faults += faults_of(planned, len(targets), crews)
            driven_km = sum(sum(visit.drive_m for visit in day.visits) + day.back_m for day in planned.schedule.days) / 1_000.0
            rows.append([
                f"{reach_m / 1_000.0:g}", str(count), f"{len(planned.sites)} ({bound})", str(len(planned.missions)),
                str(sum(mission.flights for mission in planned.missions)),
                f"{sum(mission.plan['total_length_m'] for mission in planned.missions) / 1_000.0:.0f}",
                f"{max((day.day + 1 for day in planned.schedule.days), default=0)} ({fewest_days(planned, crews)})", f"{driven_km:.0f}",
                str(len(planned.unassigned)), f"{took_s:.1f}",
            ])  # fmt: skip
            print(*rows[-1], sep="  ", flush=True)
    length_km = sum(float(distance_m(np.array(course[:-1]), np.array(course[1:])).sum()) for course in courses if len(course) > 1) / 1_000.0
    heads = ["reach [km]", "crews", "sites (fewest)", "missions", "flights", "flown [km]", "days (bound)", "driven [km]", "parts left out",
             "planned in [s]"]  # fmt: skip
    memory_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1_024.0
    said = f"{len(targets)} parts of {length_km:.0f} km of lines; at most {memory_mb:.0f} MB."
    print(table(heads, rows), said, *faults, sep="\n")
    if options.write:
        write_section(TITLE, f"`python benchmarks/campaigns.py`, demo region. {machine('numpy', 'scipy')} {said}\n\n{table(heads, rows)}")
    return int(bool(faults) or not rows)


if __name__ == "__main__":
    sys.exit(main())
