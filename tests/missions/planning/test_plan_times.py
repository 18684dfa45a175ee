"""What the search counts a route to take is what the finished route takes without its turns, or less.

Bound, gap and proof are those of the finished plan.
"""

import random
from dataclasses import replace
from typing import Any
from unittest import mock

import pytest

from inspection.geodesy import LonLat
from inspection.models import Asset
from missions.services import BaseRequest, TargetRequest, make_plan
from planning.assignment.candidate_plan import solve_assignment
from planning.problem import Objective
from planning.request import EndAction
from tests.missions.oracles.clock_oracle import clock_of
from tests.missions.worlds import World, request, uav, world

pytestmark = pytest.mark.django_db
BASE = BaseRequest("North", LonLat(10.012, 56.001))
ENDS = tuple(EndAction)


def longest_s(plan: dict[str, Any]) -> float:
    return max(float(route["duration_s"]) for route in plan["routes"])


def counted_s(asked: Any) -> tuple[dict[str, Any], float]:
    """The plan, and the seconds of its longest route as the search has counted them."""
    solutions = []

    def solve(*args: Any, **options: Any) -> Any:
        solutions.append(solve_assignment(*args, **options))
        return solutions[-1]

    with mock.patch("planning.assignment.candidate_plan.solve_assignment", solve):
        plan = make_plan(request=asked)
    return plan, solutions[0][0].longest_s


@pytest.mark.parametrize("end", ENDS)
def test_over_flat_ground_and_alike_towers_the_search_counts_every_second_but_those_of_turns(end: EndAction) -> None:
    """The seconds of turns are those of the judge of times (turn_judge.py), within its steps of half a metre."""
    here = world()
    fleet = (uav(end_action=end), uav((10.02, 55.995), name="East", end_action=end))
    asked = request(*here.towers, uavs=fleet, objective=Objective.MAKESPAN, bases=(BASE,))
    plan, counted = counted_s(asked)
    turning_s = [clock_of(asked, flying, route).turning_s for flying, route in zip(fleet, plan["routes"], strict=True)]
    straight_s = max(route["duration_s"] - own_s for route, own_s in zip(plan["routes"], turning_s, strict=True))
    assert straight_s == pytest.approx(counted, abs=0.2)
    # Who waits to be kept apart might not have to with other routes, and others might turn less.
    assert plan["is_proven"] is not (any(plan["separation"]["delays"]) or longest_s(plan) > counted + 0.1)
    assert plan["lower_bound_s"] == pytest.approx(counted, abs=0.1)


@pytest.mark.parametrize("seed", range(12))
def test_no_route_takes_less_than_the_search_has_counted(seed: int) -> None:
    draw = random.Random(seed)
    here = world()
    for tower in here.towers:
        Asset.objects.filter(pk=tower.pk).update(height_m=draw.choice([None, 12.0, 30.0, 44.0, 70.0]))
    chosen = [*draw.sample(here.towers, 4), here.bridge]
    fleet = tuple(uav((10.0 + 0.01 * number, 55.995), name=f"U{number}", end_action=draw.choice(ENDS)) for number in range(2))
    plan, counted = counted_s(request(*chosen, uavs=fleet, objective=Objective.MAKESPAN, bases=(BASE,)))
    assert longest_s(plan) >= counted - 0.1
    assert plan["lower_bound_s"] <= longest_s(plan) + 0.1
    if plan["is_proven"]:
        assert plan["gap"] == 0
        assert longest_s(plan) - plan["lower_bound_s"] <= 0.2
    else:
        assert longest_s(plan) > counted + 0.1
        assert plan["gap"] == pytest.approx(1 - plan["lower_bound_s"] / longest_s(plan), abs=2e-3)


@pytest.mark.parametrize("seed", range(8))
def test_a_limit_never_makes_a_proven_plan_quicker(seed: int) -> None:
    draw = random.Random(seed)
    here: World = world()
    targets = [*draw.sample(here.towers, 5), here.bridge]
    fleet = (uav(), uav((10.02, 55.995), name="East", end_action=EndAction.RETURN))
    free = make_plan(request=request(*targets, uavs=fleet, objective=Objective.MAKESPAN))
    for most in (1, 2, 3):
        limited = make_plan(request=request(*targets, uavs=(fleet[0], replace(fleet[1], most_targets=most)), objective=Objective.MAKESPAN))
        if not limited["unassigned"]:
            assert longest_s(limited) >= (longest_s(free) if free["is_proven"] else free["lower_bound_s"]) - 0.1


def test_a_hold_is_counted_once() -> None:
    here = world()
    asked = request(TargetRequest(here.towers[0].pk), objective=Objective.MAKESPAN)
    plan, counted = counted_s(asked)
    assert longest_s(plan) == pytest.approx(counted, abs=0.1)
