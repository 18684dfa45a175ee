"""What a plan says of a target that it leaves out is true of every UAV of the request."""

import random
from collections import Counter
from dataclasses import replace
from typing import Any

import pytest

from inspection.services import import_osm
from missions.selectors.planning_context import current_airspace
from missions.services import LockRequest, PlanRequest, TargetRequest, make_plan
from planning.energy.performance import Performance
from planning.problem import Objective
from planning.request import EndAction
from tests.cases import long
from tests.missions.oracles.reason_oracle import ReasonOracle
from tests.missions.property_tests.random_missions import Region, put_random_zones
from tests.missions.property_tests.test_random_missions import MissionModel
from tests.missions.worlds import World, island, request, uav, zone_around

pytestmark = pytest.mark.django_db

MISSIONS = 60  # of each region


def message_of(plan: dict[str, Any]) -> str:
    (item,) = plan["unassigned"]
    return str(item["message"])


def test_a_uav_without_a_range_and_without_a_way_is_named_beside_the_one_that_lacks_range(here: World) -> None:
    far = island()
    short = uav((10.3, 55.995), name="Kite", max_range_m=500.0, end_action=EndAction.RETURN)
    plan = make_plan(request=request(far[0], uavs=(short, uav(name="Osprey"))))
    assert " more than the range of Kite: " in message_of(plan)
    assert message_of(plan).endswith(" Other UAVs: no permitted route (Osprey).")


def test_a_uav_without_the_sensor_and_one_on_the_ground_are_told_apart(here: World) -> None:
    zone_around((10.02, 55.995), half_deg=0.0005)
    able = uav(name="Kite", max_range_m=200.0, sensors=("lidar",))
    grounded = uav((10.02, 55.995), name="Owl", sensors=("lidar",))
    plan = make_plan(request=request(TargetRequest(here.towers[0].pk, sensor="lidar"), uavs=(able, grounded, uav(name="Tern"))))
    assert message_of(plan).endswith(" Other UAVs: cannot take off (Owl); without the sensor (Tern).")


def test_nobody_is_said_to_find_no_way_who_only_stays_on_the_ground(here: World) -> None:
    zone_around((10.02, 55.995), half_deg=0.0005)
    plan = make_plan(request=request(island()[0], uavs=(uav(name="West"), uav((10.02, 55.995), name="East"))))
    stated = "There is no permitted route for West. It is not connected to the network of any UAV: the nearest stands 18.7 km away."
    assert message_of(plan) == f"{stated} Other UAVs: cannot take off (East)."


def test_who_is_the_only_one_and_stays_on_the_ground_is_told_why(here: World) -> None:
    zone_around((10.02, 55.995), half_deg=0.0005)
    plan = make_plan(request=request(here.towers[0], uavs=(uav((10.02, 55.995), name="East"),)))
    assert message_of(plan) == "There is no UAV that can take off. East stands inside Airport and cannot take off."


def test_no_charging_is_spoken_of_where_nobody_charges(here: World) -> None:
    weak = uav(name="Kite", performance=Performance(battery_wh=1.0))
    plan = make_plan(request=request(here.towers[5], uavs=(weak, uav(name="Osprey", max_range_m=100.0))))
    assert "charges" not in message_of(plan)
    assert message_of(plan).endswith(" Other UAVs: range too short (Osprey).")


@pytest.mark.parametrize("file_name", ["quillmoor.osm.pbf", *long("elme-valley.osm.pbf")])
def test_an_oracle_finds_the_same_reason_for_every_uav(region_file: Any, file_name: str) -> None:
    import_osm(path=region_file(file_name))
    put_random_zones(7)
    region, draw, seen = Region(), random.Random(f"reasons {file_name}"), Counter[str]()
    preferred, shortest = current_airspace(), current_airspace(is_by_length=True)
    untrue = []
    for _ in range(MISSIONS):
        asked = _with_wishes(region.mission(draw), draw)
        plan = make_plan(request=asked)
        oracle = ReasonOracle(asked, [MissionModel(asked, scene) for scene in (preferred, shortest)])
        untrue += oracle.untrue(plan)
        seen.update(item["reason"] for item in plan["unassigned"])
        seen["others named"] += sum("Other UAVs" in item["message"] for item in plan["unassigned"])
    print(file_name, dict(seen))
    assert not untrue, "\n".join(untrue)
    assert min(seen["beyond_range"], seen["beyond_energy"], seen["not_allowed"], seen["others named"]) > 0


def _with_wishes(asked: PlanRequest, draw: random.Random) -> PlanRequest:
    """Up to four UAVs with short ranges, small batteries, sensors, ties and locks."""
    uavs = [
        replace(
            one,
            name=f"U{number}",
            max_range_m=draw.choice([None, 3_000.0, 12_000.0, 40_000.0]),
            performance=Performance(battery_wh=draw.choice([None, None, 15.0, 60.0, 400.0])),
            sensors=draw.choice([(), ("lidar",)]),
        )
        for number, one in enumerate(draw.choices(asked.uavs, k=draw.randint(1, 4)))
    ]
    names = [one.name for one in uavs]
    targets = tuple(
        replace(target, sensor=draw.choice(["", "", "", "lidar"]), uav=draw.choice([*names, *[""] * 8])) for target in asked.targets
    )
    locks: tuple[LockRequest, ...] = ()
    if len(targets) > 1 and draw.random() < 0.3:
        run = (0, 1)
        locks = (LockRequest(draw.choice(names), run, at_start=draw.random() < 0.3),)
        targets = tuple(replace(target, sensor="", uav="") if number in run else target for number, target in enumerate(targets))
    objective = asked.objective if asked.objective is not Objective.ENERGY else Objective.TOTAL
    return replace(asked, uavs=tuple(uavs), targets=targets, locks=locks, objective=objective)
