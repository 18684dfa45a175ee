"""The shapes of the load tests against the article's table."""

import time
from pathlib import Path

import numpy as np
import pytest

from deploy.load.answers import Recorder, Run
from deploy.load.plan_answers import fault_of, plain_fault_of
from deploy.load.scenarios import RAMPS_TO_SCALE_BY, SCENARIOS, Scenario, Stage

# Of the table: second, and how many users there are. A ramp of 20/s from 100 to 200 takes 5 s.
USERS_AT = {
    1: {0: 0, 5: 50, 10: 100, 59: 100, 60: 100, 62: 140, 65: 200, 119: 200, 125: 300, 179: 300, 182: 260, 185: 200, 239: 200, 241: 150,
        242: 100, 299: 100, 300: 0},
    2: {0: 0, 10: 100, 59: 100, 65: 200, 70: 300, 130: 500, 190: 700, 243: 850, 246: 1_000, 299: 1_000, 300: 0},
    3: {246: 1_000, 299: 1_000, 303: 850, 306: 700, 370: 500, 430: 300, 490: 100, 539: 100, 545: 50, 550: 0, 599: 0, 600: 0},
    4: {0: 0, 1: 50, 20: 1_000, 99: 1_000, 110: 1_500, 120: 2_000, 199: 2_000, 220: 3_000, 320: 4_000, 420: 5_000, 499: 5_000, 500: 0},
}  # fmt: skip


@pytest.mark.parametrize("number", SCENARIOS)
def test_users_come_and_go_as_the_table_says(number: int) -> None:
    scenario = SCENARIOS[number]
    assert {at_s: scenario.users_at(at_s) for at_s in USERS_AT[number]} == USERS_AT[number]


def test_scenarios_last_and_wait_as_the_table_says() -> None:
    assert {number: scenario.lasts_s for number, scenario in SCENARIOS.items()} == {1: 300, 2: 300, 3: 600, 4: 500}
    assert {number: scenario.wait_s for number, scenario in SCENARIOS.items()} == {1: (1, 5), 2: (1, 1), 3: (10, 10), 4: (10, 10)}
    assert {number: scenario.most_users for number, scenario in SCENARIOS.items()} == {1: 300, 2: 1_000, 3: 1_000, 4: 5_000}


@pytest.mark.parametrize("scenario", [*SCENARIOS.values(), *RAMPS_TO_SCALE_BY.values()])
def test_no_stage_is_shorter_than_its_ramp(scenario: Scenario) -> None:
    assert all(scenario.ramp_s(index) < stage.lasts_s for index, stage in enumerate(scenario.stages))


def test_a_scaled_scenario_keeps_its_shape() -> None:
    scenario = SCENARIOS[3]
    scaled = scenario.scaled(users=0.1, seconds=0.5)
    for at_s in np.arange(0.0, scenario.lasts_s, 7.0).tolist():
        assert scaled.users_at(at_s * 0.5) == pytest.approx(0.1 * scenario.users_at(at_s))


def test_stages_follow_each_other_and_end() -> None:
    scenario = Scenario(0, (1.0, 1.0), (Stage(4, 2, 10.0), Stage(2, 1, 5.0)), "")
    assert [scenario.stage_at(at_s) for at_s in (0.0, 9.9, 10.0, 15.0)] == [*[scenario.stages[0]] * 2, scenario.stages[1], None]


def test_a_run_tells_what_was_served_and_what_failed(tmp_path: Path) -> None:
    """Ten users, 1 s wait and answers of 1 s: five a second; one answer in the hold was wrong, one in the ramp was slow."""
    scenario = Scenario(0, (1.0, 1.0), (Stage(10, 10, 20.0),), "")
    recorder = Recorder(scenario)
    recorder.users = [(0.0, 0), (1.0, 10), (20.0, 10)]
    for at_s in np.arange(0.5, 20.0, 0.2).tolist():
        recorder.at_s.append(at_s)
        recorder.took_ms.append(3_000.0 if at_s < 2.9 else 1_000.0)
        recorder.is_plan.append(1)
        recorder.is_fault.append(0)
    recorder.is_fault[50] = 1
    recorder.faults["plan: no plan"] = 1
    recorder.write(tmp_path / "run.npz")
    run = Run.read(tmp_path / "run.npz")
    stage = run.stage(scenario, 0)
    assert stage.hold_s == pytest.approx(17.0)
    assert stage.plans_per_s == pytest.approx(5.0, abs=0.1)
    assert stage.demand_per_s == pytest.approx(5.0)
    assert 97.0 < stage.served_percent < 102.0
    assert (stage.median_ms, stage.p95_ms, stage.ramp_median_ms) == (1_000.0, 1_000.0, 3_000.0)
    assert (stage.failures, run.failures, run.faults) == (1, 1, {"plan: no plan": 1})
    assert (stage.users, stage.users_there) == (10, 10)
    series = run.by_second(20.0, window_s=5.0)
    assert series["users"].tolist() == [10, 10, 10, 10]
    assert series["plans_per_s"].sum() * 5 == len(run.at_s) - 1


def test_demand_does_not_fall_with_the_answers_that_take_long(tmp_path: Path) -> None:
    scenario = Scenario(9, (1.0, 1.0), (Stage(10, 100, 20.0), Stage(20, 100, 20.0)), "")
    recorder = Recorder(scenario)
    recorder.users = [(0.0, 10), (21.0, 20), (40.0, 20)]
    for at_s, took_ms in [
        *((at_s, 1_000.0) for at_s in np.arange(0.5, 20.0, 0.2)),
        *((at_s, 3_000.0) for at_s in np.arange(20.0, 40.0, 0.2)),
    ]:
        recorder.at_s.append(float(at_s))
        recorder.took_ms.append(took_ms)
        recorder.is_plan.append(1)
        recorder.is_fault.append(0)
    recorder.write(tmp_path / "run.npz")
    later = Run.read(tmp_path / "run.npz").stage(scenario, 1)
    assert later.demand_per_s == pytest.approx(10.0)  # and not 20 / (1 + 3), which would be served
    assert later.served_percent == pytest.approx(50.0, abs=2.0)


def test_users_are_counted_from_the_begin_of_a_run(tmp_path: Path) -> None:
    scenario = Scenario(9, (1.0, 1.0), (Stage(10, 10, 20.0),), "")
    recorder = Recorder(scenario)
    recorder.note_users(0)  # Locust's first look at the shape, before it says that the test starts
    recorder.begin(time.time() - 18.0)
    recorder.note_users(10)
    recorder.begin(recorder.began_s - 2.0)
    recorder.note_users(10)
    recorder.write(tmp_path / "run.npz")
    assert Run.read(tmp_path / "run.npz").stage(scenario, 0).users_there == 10


ASKED = {"uavs": [{}, {}], "targets": [{}, {}]}
ROUTE = b'{"uav":"UAV %d","end_action":"stay","waypoints":[{"target":null,"task":null},{"target":%d,"task":{"kind":"photo"}}]}'


def plan(*, routes: bytes, unassigned: bytes = b"[]", unresolved: bytes = b"[]", warnings: bytes = b"[]") -> bytes:
    return b'{"separation":{"unresolved":%s},"warnings":%s,"routes":[%s],"unassigned":%s}' % (unresolved, warnings, routes, unassigned)


WHOLE = ROUTE % (1, 0) + b"," + ROUTE % (2, 1)


@pytest.mark.parametrize("look", [fault_of, plain_fault_of])
@pytest.mark.parametrize(
    "answer",
    [
        plan(routes=WHOLE, unassigned=b'[{"target":1}]'),
        plan(routes=ROUTE % (1, 0)),
        plan(routes=ROUTE % (1, 0) + b"," + ROUTE % (2, 0)),
        plan(routes=WHOLE, unresolved=b'[{"routes":[0,1]}]'),
        plan(routes=WHOLE, warnings=b'[{"code":"uav_inside_zone"}]'),
        b'{"error":{"code":"unavailable"}}',
        b"<html>",
    ],
)  # fmt: skip
def test_what_is_not_a_whole_safe_plan_is_a_failure(look: type(fault_of), answer: bytes) -> None:  # type: ignore[valid-type]
    assert look(answer, ASKED)
    assert look(plan(routes=WHOLE), ASKED) == ""
