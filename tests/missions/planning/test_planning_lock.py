"""Threads of a process make small plans by turns; what waits for the database, or after the last look, is held up by nobody's."""

import threading
import time
from concurrent.futures import ThreadPoolExecutor
from typing import Any
from unittest import mock

import pytest
from django.db import connections

from missions.services import make_plan
from missions.services.planning import planner
from tests.missions.worlds import World, request, uav, world
from workspace.jobs import planning_lock
from workspace.jobs.planning_lock import hold_planning_lock
from workspace.prepared_statements import prepared_rows

PLANNERS = 4


def asked(here: World) -> Any:
    return request(here.towers[5], here.bridge, uavs=(uav((10.0, 55.9999)),))


def has_room() -> bool:
    """Whether another thread could have a turn now."""
    had = []

    def look() -> None:
        with mock.patch.object(planning_lock, "TIMEOUT_S", 0.0), hold_planning_lock() as is_held:
            had.append(is_held)

    another = threading.Thread(target=look)
    another.start()
    another.join()
    return had[0]


@pytest.mark.django_db(transaction=True)
def test_plans_of_several_threads_are_worked_out_one_after_another(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(planning_lock, "TIMEOUT_S", 60.0)
    here = world()
    inside, most, plan_of_context = [0], [0], planner.plan
    together = threading.Barrier(PLANNERS)

    def noted(*args: Any, **kwargs: Any) -> Any:
        inside[0] += 1
        most[0] = max(most[0], inside[0])
        time.sleep(0.02)  # room for another one to come in
        found = plan_of_context(*args, **kwargs)
        inside[0] -= 1
        return found

    def plan_length_m() -> float:
        try:
            together.wait(60.0)
            return float(make_plan(request=asked(here))["total_length_m"])
        finally:
            connections.close_all()

    with mock.patch.object(planner, "plan", noted), ThreadPoolExecutor(PLANNERS) as planners:
        lengths_m = [made.result() for made in [planners.submit(plan_length_m) for _ in range(PLANNERS)]]
    assert most == [1]
    assert len(set(lengths_m)) == 1


@pytest.mark.django_db
def test_the_zones_of_now_are_asked_for_outside_of_turns_and_nothing_waits_afterwards() -> None:
    here = world()
    reported: list[str] = []

    def current_dataset_version() -> Any:
        reported.append("room" if has_room() else "held")
        return now()

    def written(*args: Any, **kwargs: Any) -> Any:
        reported.append("written")
        return write(*args, **kwargs)

    now, write = planner.current_dataset_version, planner.plan_to_json
    with (
        mock.patch.object(planner, "current_dataset_version", current_dataset_version),
        mock.patch.object(planner, "plan_to_json", written),
    ):
        make_plan(request=asked(here))
        with hold_planning_lock():  # the caller's, as for a small plan
            make_plan(request=asked(here))
            assert has_room()
    assert reported == ["written", "room"] * 2


@pytest.mark.django_db(transaction=True)
def test_another_has_the_turn_while_one_waits_for_the_database() -> None:
    reported: list[bool] = []
    asks = threading.Thread(target=ask_slowly, args=(reported,))
    with hold_planning_lock():
        asks.start()
        asks.join(0.05)
        assert (has_room(), asks.is_alive()) == (False, True)  # it waits for its turn, with its question unasked
    time.sleep(0.3)
    assert (has_room(), asks.is_alive()) == (True, True)  # it had its turn, and the database has its question
    asks.join(60.0)
    assert reported == [True, False]  # and its turn again with the answer
    assert has_room()


def ask_slowly(reported: list[bool]) -> None:
    try:
        with hold_planning_lock() as is_held:
            prepared_rows("SELECT pg_sleep(1.0)::text")
            reported += [is_held, has_room()]
    finally:
        connections.close_all()


@pytest.mark.django_db
def test_a_plan_that_fails_gives_its_turn_up() -> None:
    here = world()
    with mock.patch.object(planner, "plan", side_effect=RuntimeError), pytest.raises(RuntimeError):
        make_plan(request=asked(here))
    assert has_room()


def test_who_waits_too_long_goes_on_without_a_turn_and_gives_none_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(planning_lock, "TIMEOUT_S", 0.05)
    holds, over = threading.Event(), threading.Event()

    def hold() -> None:
        with hold_planning_lock():
            holds.set()
            over.wait(60.0)

    holder = threading.Thread(target=hold)
    holder.start()
    holds.wait(60.0)
    with hold_planning_lock() as is_held:
        assert not is_held
    assert not has_room()
    over.set()
    holder.join()
    assert has_room()


def test_a_turn_within_a_turn_is_the_same_one() -> None:
    with hold_planning_lock() as outer, hold_planning_lock() as inner:
        assert (outer, inner) == (True, True)
    assert has_room()
