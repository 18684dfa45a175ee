"""Random missions of complete UAV types in the demo region, planned, and rehearsed in calm air as planned."""

import random
from dataclasses import dataclass
from io import StringIO
from pathlib import Path

from django.contrib.gis.measure import D
from django.core.management import call_command

from inspection.geodesy import LonLat
from inspection.models import Asset, AssetKind
from inspection.selectors.planning import heights_at, planning_read
from missions.models import Mission
from missions.services import PlanRequest, TargetRequest, UavRequest, create_mission, plan_mission
from missions.services.commands.refused import Refused
from planning.energy.performance import Performance
from planning.problem import Objective
from planning.request import EndAction
from planning.task import Task, TaskKind
from simulation.assessment.judging import Assessment, judge
from simulation.rehearsing.flying import fly
from simulation.services.plan_to_fly import plan_to_fly, surroundings_of
from simulation.services.rehearsals import limits_of_settings, vehicle_maker
from tests.simulation.rehearsals.rehearsed import loaded, scenarios
from workspace.models import User

INSPECTOR = Performance(battery_wh=263.2, mass_kg=3.77, max_airspeed_mps=19.0, rotor_disk_m2=0.5188, hover_power_w=430.0)
IRIS = Performance(battery_wh=56.6, mass_kg=1.545, max_airspeed_mps=11.0)
TASKS = (None, None, Task(TaskKind.PHOTO, 5.0), Task(TaskKind.LOOK, 20.0), Task(TaskKind.HOLD, 30.0))
OFF_DEG = 0.003
TURNAROUND_S = 600.0  # from a landing to the next take-off, which planned times contain


@dataclass(frozen=True)
class Rehearsed:
    """A mission's assessment, and for each UAV that flew what was planned for what was flown, in time and energy."""

    assessment: Assessment
    time: tuple[float, ...]
    energy: tuple[float, ...]


def bring_in_demo_region(folder: Path) -> None:
    """Infrastructure, zones and hills, by the importers that ./run uses."""
    for command in (
        ["make_demo_region", str(folder)],
        ["import_osm", str(folder / "demo.osm.pbf"), "--synthetic"],
        ["import_zones", str(folder / "demo-zones.json"), "--synthetic"],
        ["import_terrain", str(folder / "demo-terrain.tif"), "--synthetic"],
        ["build_graph"],
    ):
        call_command(*command, stdout=StringIO())


def random_request(draw: random.Random) -> PlanRequest:
    """One or two UAVs beside a random tower, with one to five targets within some kilometres, that return."""
    is_large = draw.random() < 0.75
    within_m = 4_000.0 if is_large else 900.0
    assets = Asset.objects.filter(vanished_at=None, is_flyable=True).order_by("pk")
    centre = draw.choice(list(assets.filter(kind=AssetKind.TOWER))).centre
    near = list(assets.filter(kind__in=[AssetKind.TOWER, AssetKind.BRIDGE], centre__distance_lt=(centre, D(m=within_m))))
    performance, speeds_mps = (INSPECTOR, (8.0, 10.0, 12.0, 14.0)) if is_large else (IRIS, (4.0, 5.0, 6.0, 8.0))
    uavs = tuple(
        UavRequest(
            f"UAV {number}",
            LonLat(centre.x + draw.uniform(-OFF_DEG, OFF_DEG), centre.y + draw.uniform(-OFF_DEG, OFF_DEG)),
            None,
            draw.choice(speeds_mps),
            EndAction.RETURN,
            performance=performance,
        )
        for number in range(draw.randint(1, 2))
    )
    chosen = draw.sample(near, min(draw.randint(1, 5), len(near)))
    targets = tuple(TargetRequest(asset.pk, task=draw.choice(TASKS)) for asset in chosen)
    return PlanRequest(uavs, targets, draw.choice([Objective.TOTAL, Objective.MAKESPAN]), return_to_start=True)


def rehearse(request: PlanRequest, person: User, seed: int) -> Rehearsed | None:
    """None where nothing of it can be flown."""
    mission = create_mission(organisation=person.organisation, author=person, name=f"Random {seed}", request=request)
    return rehearse_mission(plan_mission(mission=mission, actor=person), seed)


def rehearse_mission(mission: Mission, seed: int, scenario: str = "calm") -> Rehearsed | None:
    """None where nothing of it can be flown."""
    try:
        plan = plan_to_fly(loaded(mission))
    except Refused:
        return None
    ground = planning_read().ground()
    (conditions,) = scenarios(mission, scenario)
    maker = vehicle_maker(plan.stand_ins, conditions, heights_at(ground.dataset_version))
    flown = fly(plan.routes, maker, turnaround_s=TURNAROUND_S, seed=seed, on_progress=_unacknowledged)
    assessment = judge(flown, surroundings_of(plan, ground), limits_of_settings())
    return Rehearsed(
        assessment,
        tuple(((route.planned_s or 0.0) - TURNAROUND_S * (len(route.endings) - 1)) / route.flown_s for route in assessment.routes),
        tuple((route.planned_wh or 0.0) / route.used_wh for route in assessment.routes),
    )


def _unacknowledged(share: float) -> None:
    """Progress that nobody follows."""
