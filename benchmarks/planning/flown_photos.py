"""Photos of towers as they are flown in simulation: how near the UAV comes to wires, how far photos are from their plan, what they show.

    python -m benchmarks.planning.flown_photos [--towers N] [--camera KEY] [--gsd MM] [--write]

Each of twenty models of towers is planned, turned into a route with mission items, and flown by the simulated UAV in calm air and in a
fresh breeze with gusts of 2 m/s and turbulence. Its true place, every 0.04 s, is measured from the triangles of the tower and from wires
with and without sag, still and swung, by plain formulas that share nothing with the planner. Photos are compared with their poses in
the plan, and what they show with what the plan shows. --write puts the table into docs/performance.md. Exits with 1 where a flight
comes nearer than the clearance, or does not end as planned.
"""

import argparse
import sys

from benchmarks.report import machine, table, write_section
from planning.views.catalogue import catalogue
from planning.views.limits import DetailRules
from planning.views.view_plan import ViewSpeeds, detail_plan
from simulation.rehearsing.weather_scenario import Named
from tests.planning.views.flown_photos import Flown, flown
from tests.planning.views.towers import TOWERS, standing

TITLE = "Photos of towers, flown"
WEATHERS = (Named.CALM, Named.STRONG_WIND)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--towers", type=int, default=len(TOWERS))
    parser.add_argument("--camera", default="dji-m30t-zoom")
    parser.add_argument("--gsd", type=float, default=2.0, help="millimetres")
    parser.add_argument("--write", action="store_true")
    arguments = parser.parse_args()
    camera = catalogue()[arguments.camera].camera
    found: dict[Named, list[Flown]] = {code: [] for code in WEATHERS}
    for name in list(TOWERS)[: arguments.towers]:
        stands = standing(TOWERS[name])
        plan = detail_plan(stands.site, camera, DetailRules(arguments.gsd / 1_000.0), ViewSpeeds())
        if not len(plan.poses):
            print(name, "nothing can be shown", flush=True)
            continue
        for code in WEATHERS:
            own = flown(stands, plan, camera, code)
            found[code].append(own)
            print(name, code, *(f"{value:.3f}" if isinstance(value, float) else value for value in own), flush=True)
    heads = ["weather", "flights", "nearest approach beyond the clearance [m]", "photos taken", "farthest from its planned place [m]",
             "most beside its planned axis [deg]", "share of the surface shown, flown less planned"]  # fmt: skip
    rows = [
        [
            str(code), str(len(cases)), f"{min(own.spare_m for own in cases):+.2f}",
            f"{sum(own.taken for own in cases)} of {sum(own.photos for own in cases)}", f"{max(own.away_m for own in cases):.2f}",
            f"{max(own.off_deg for own in cases):.2f}",
            f"{min(own.flown_share - own.planned_share for own in cases):+.2%} to "
            f"{max(own.flown_share - own.planned_share for own in cases):+.2%}",
        ]
        for code, cases in found.items()
    ]  # fmt: skip
    print(table(heads, rows))
    if arguments.write:
        command = f"`python -m benchmarks.planning.flown_photos`: {arguments.camera}, {arguments.gsd:g} mm. {machine('numpy', 'jsbsim')}"
        write_section(TITLE, f"{command}\n\n{table(heads, rows)}")
    every = [own for cases in found.values() for own in cases]
    return int(any(own.spare_m < 0.0 or own.taken != own.photos for own in every))


if __name__ == "__main__":
    sys.exit(main())
