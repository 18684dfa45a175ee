"""Threads of a process work their plans out by turns; nobody waits for the database, or after the last look, within one."""

import threading
import time
from concurrent.futures import ThreadPoolExecutor
from typing import Any
from unittest import mock

import pytest
from django.db import connections

from missions.services import make_plan, planning
from missions.services.turns import one_at_a_time
from tests.missions.worlds import World, request, uav, world

PLANNERS = 4


def asked(here: World) -> Any:
    return request(here.towers[5], here.bridge, uavs=(uav((10.0, 55.9999)),))


@pytest.mark.django_db(transaction=True)
def test_plans_of_several_threads_are_worked_out_one_after_another() -> None:
    here = world()
    inside, most, best_on = [0], [0], planning._Planner.best_on
    together = threading.Barrier(PLANNERS)

    def noted(planner: Any, ground: Any) -> Any:
        inside[0] += 1
        most[0] = max(most[0], inside[0])
        time.sleep(0.02)  # room for another one to come in
        found = best_on(planner, ground)
        inside[0] -= 1
        return found

    def plan() -> float:
        try:
            together.wait(60.0)
            return float(make_plan(request=asked(here))["total_length_m"])
        finally:
            connections.close_all()

    with mock.patch.object(planning._Planner, "best_on", noted), ThreadPoolExecutor(PLANNERS) as planners:
        lengths_m = [made.result() for made in [planners.submit(plan) for _ in range(PLANNERS)]]
    assert most == [1]
    assert len(set(lengths_m)) == 1


@pytest.mark.django_db
def test_the_zones_of_now_are_asked_for_outside_of_turns_and_nothing_waits_afterwards() -> None:
    here = world()
    told: list[str] = []

    def edition_now() -> Any:
        told.append("held" if one_at_a_time.locked() else "free")
        return now()

    def written(*args: Any, **kwargs: Any) -> Any:
        told.append("written")
        return write(*args, **kwargs)

    now, write = planning.edition_now, planning.plan_to_json
    with mock.patch.object(planning, "edition_now", edition_now), mock.patch.object(planning, "plan_to_json", written):
        make_plan(request=asked(here))
    assert told == ["written", "free"]


@pytest.mark.django_db
def test_a_plan_that_fails_gives_its_turn_up() -> None:
    here = world()
    with mock.patch.object(planning._Planner, "best_on", side_effect=RuntimeError), pytest.raises(RuntimeError):
        make_plan(request=asked(here))
    assert not one_at_a_time.locked()
