"""What is wished of a plan beyond its targets: priorities, ties, sensors, limits, locked runs, bases to land at."""

from dataclasses import replace
from typing import Any

import pytest

from inspection.geodesy import LonLat
from missions.services import (
    BaseRequest,
    InvalidRequest,
    LockRequest,
    PlanRequest,
    TargetRequest,
    UavRequest,
    make_plan,
    refuse_contradictions,
    request_from_json,
    request_to_json,
)
from planning.problem import Objective, Priority
from planning.progress import PlanProgress
from planning.request import EndAction
from tests.missions.worlds import LINE_LAT, TOWER_LONS, UAV_AT, World, island, request, uav, world, zone_around

pytestmark = pytest.mark.django_db

WEST, EAST = uav((10.0, 55.995), name="West"), uav((10.02, 55.995), name="East")


def targets_of(plan: dict[str, Any]) -> list[list[int]]:
    return [route["targets"] for route in plan["routes"]]


def reasons(plan: dict[str, Any]) -> dict[int, tuple[str, str]]:
    return {item["target"]: (item["reason"], item["message"]) for item in plan["unassigned"]}


def towers(here: World, *numbers: int, **wishes: Any) -> list[TargetRequest]:
    return [TargetRequest(here.towers[number].pk, **wishes) for number in numbers]


# --- ties, sensors, limits, priorities --------------------------------------------------------------------------------------------


def test_a_target_that_is_tied_is_flown_by_its_uav_however_far(here: World) -> None:
    plan = make_plan(request=request(*towers(here, 5, uav="West"), *towers(here, 0), uavs=(WEST, EAST)))
    assert targets_of(plan) == [[1, 0], []]


@pytest.mark.parametrize("wanted", ["lidar", " LiDAR "])
def test_a_sensor_is_found_whatever_its_capitals_and_blanks(here: World, wanted: str) -> None:
    lidar = replace(EAST, sensors=("Thermal", "LIDAR "))
    plan = make_plan(request=request(*towers(here, 0, sensor=wanted), uavs=(WEST, lidar)))
    assert targets_of(plan) == [[], [0]]


def test_a_sensor_that_no_uav_has_is_named(here: World) -> None:
    plan = make_plan(request=request(*towers(here, 0, sensor="Lidar"), *towers(here, 1)))
    assert reasons(plan) == {0: ("not_allowed", "No UAV of the plan has the sensor Lidar.")}


def test_a_tie_to_a_uav_without_the_sensor_names_both(here: World) -> None:
    plan = make_plan(request=request(*towers(here, 0, sensor="Lidar", uav="Tern")))
    assert reasons(plan) == {0: ("not_allowed", "It is tied to Tern, which does not have the sensor Lidar.")}


def test_a_tie_to_a_uav_in_a_zone_names_the_uav(here: World) -> None:
    zone_around((10.02, 55.995), half_deg=0.0005)
    plan = make_plan(request=request(*towers(here, 0, uav="East"), uavs=(WEST, EAST)))
    assert reasons(plan) == {0: ("not_allowed", "It is tied to East. East stands inside Airport and cannot take off.")}


def test_a_uav_does_no_more_targets_than_it_may_and_low_ones_are_left_out(here: World) -> None:
    low = towers(here, 0, 1, priority=Priority.LOW)
    plan = make_plan(request=request(*low, *towers(here, 5, priority=Priority.HIGH), uavs=(uav(most_targets=1),)))
    assert targets_of(plan) == [[2]]
    assert {reason for reason, _ in reasons(plan).values()} == {"most_targets"}


def test_who_is_tied_to_a_uav_that_has_enough_is_told_so(here: World) -> None:
    tied = towers(here, 0, 1, uav="West")
    plan = make_plan(request=request(*tied, uavs=(replace(WEST, most_targets=1), EAST)))
    ((reason, message),) = reasons(plan).values()
    assert (reason, message) == ("most_targets", "It is tied to West, which has as many targets as it may have.")


def test_who_has_enough_is_named_and_that_the_others_lack_the_range(here: World) -> None:
    short = replace(EAST, name="Charlie", max_range_m=50.0)
    plan = make_plan(request=request(*towers(here, 0, 1), uavs=(replace(WEST, name="Alpha", most_targets=1), short)))
    ((reason, message),) = reasons(plan).values()
    assert (reason, message) == ("most_targets", "Alpha has as many targets as it may have (1). Other UAVs: range too short (Charlie).")


def test_two_that_have_enough_are_both_named(here: World) -> None:
    plan = make_plan(request=request(*towers(here, 0, 1, 5), uavs=(replace(WEST, most_targets=1), replace(EAST, most_targets=1))))
    ((_, message),) = reasons(plan).values()
    assert message == "West and East have as many targets as they may have."


# --- bases ------------------------------------------------------------------------------------------------------------------------

LANDING = uav(end_action=EndAction.BASE)
NEAR, FAR = BaseRequest("Near", LonLat(10.021, 56.0005)), BaseRequest("Far", LonLat(9.9995, 56.0))


def end_of(plan: dict[str, Any]) -> tuple[float, ...]:
    (route,) = plan["routes"]
    last = route["waypoints"][-1]
    assert last["kind"] == "end"
    return tuple(last["position"])


def test_a_route_ends_at_the_base_that_is_nearest_to_its_last_target(here: World) -> None:
    plan = make_plan(request=request(*towers(here, 5), uavs=(LANDING,), bases=(FAR, NEAR)))
    assert end_of(plan) == NEAR.position
    assert plan["routes"][0]["end_action"] == "base"
    assert plan["routes"][0]["base"] == NEAR.name
    assert plan["is_proven"]


def test_the_base_decides_which_target_is_the_last(here: World) -> None:
    between = uav((10.010, 55.997), end_action=EndAction.BASE)
    west = make_plan(request=request(*towers(here, 0, 5), uavs=(between,), bases=(FAR,)))
    east = make_plan(request=request(*towers(here, 0, 5), uavs=(between,), bases=(NEAR,)))
    assert (targets_of(west), targets_of(east)) == ([[1, 0]], [[0, 1]])


def test_a_base_in_a_zone_is_not_landed_at(here: World) -> None:
    zone_around(tuple(NEAR.position), half_deg=0.0003)
    assert end_of(make_plan(request=request(*towers(here, 4), uavs=(LANDING,), bases=(NEAR, FAR)))) == FAR.position


def test_the_way_to_the_base_counts_against_the_range(here: World) -> None:
    limited = replace(LANDING, max_range_m=2_500.0)
    assert targets_of(make_plan(request=request(*towers(here, 5), uavs=(limited,), bases=(NEAR,)))) == [[0]]
    plan = make_plan(request=request(*towers(here, 5), uavs=(limited,), bases=(FAR,)))
    assert reasons(plan)[0][0] == "beyond_range"
    assert "there and on to the nearest base" in reasons(plan)[0][1]


def test_without_a_way_to_any_base_the_reason_says_so(here: World) -> None:
    plan = make_plan(request=request(*towers(here, 0), uavs=(LANDING,), bases=(BaseRequest("Moon", LonLat(10.0, 57.0)),)))
    assert reasons(plan) == {0: ("no_path", "There is no path from it to a base outside every no-fly zone.")}


def test_all_that_return_need_no_base(here: World) -> None:
    plan = make_plan(request=request(*towers(here, 0), uavs=(LANDING,), return_to_start=True))
    assert end_of(plan) == UAV_AT


# --- locked runs ------------------------------------------------------------------------------------------------------------------


def test_a_locked_run_is_flown_as_it_is_wished_and_its_cost_is_told(here: World) -> None:
    asked = towers(here, 0, 2, 4)
    plan = make_plan(request=request(*asked, locks=(LockRequest("Tern", (2, 0)),)))
    (route,) = plan["routes"]
    places = [route["targets"].index(target) for target in (2, 0)]
    assert places[1] == places[0] + 1
    assert route["locked"] == [2, 0]
    free = make_plan(request=request(*asked))
    wish = plan["wish"]
    assert wish["cost_m"] == pytest.approx(plan["total_length_m"] - free["total_length_m"], abs=0.1)
    assert wish["cost_m"] > 100.0
    assert wish["free_total_m"] == pytest.approx(free["total_length_m"], abs=0.1)
    assert wish["left_out"] == 0
    assert free["wish"] is None
    assert plan["locks"] == [{"uav": "Tern", "targets": [2, 0], "at_start": False, "at_end": False}]


def test_a_run_at_the_start_or_the_end_is_there(here: World) -> None:
    asked = towers(here, 0, 1, 2, 3)
    plan = make_plan(request=request(*asked, locks=(LockRequest("Tern", (2,), at_start=True), LockRequest("Tern", (1, 0), at_end=True))))
    assert targets_of(plan) == [[2, 3, 1, 0]]


def test_a_wish_that_costs_nothing_costs_nothing(here: World) -> None:
    plan = make_plan(request=request(*towers(here, 0, 5), uavs=(WEST, EAST), locks=(LockRequest("West", (0,)),)))
    assert (plan["wish"]["cost_m"], plan["wish"]["cost_s"]) == (0.0, 0.0)


def test_a_run_of_a_uav_that_cannot_take_off_is_left_out_as_a_whole(here: World) -> None:
    zone_around((10.02, 55.995), half_deg=0.0005)
    plan = make_plan(request=request(*towers(here, 0, 1, 2), uavs=(WEST, EAST), locks=(LockRequest("East", (0, 1)),)))
    assert targets_of(plan) == [[2], []]
    assert reasons(plan) == dict.fromkeys((0, 1), ("not_allowed", "It is locked to East. East stands inside Airport and cannot take off."))
    assert (plan["wish"]["left_out"], plan["wish"]["cost_m"]) == (2, None)


def test_a_run_with_a_target_in_a_zone_is_left_out_as_a_whole(here: World) -> None:
    zone_around((TOWER_LONS[5], LINE_LAT), half_deg=0.0005)
    plan = make_plan(request=request(*towers(here, 0, 5), locks=(LockRequest("Tern", (0, 1)),)))
    assert targets_of(plan) == [[]]
    assert {target: reason for target, (reason, _) in reasons(plan).items()} == {0: "not_allowed", 1: "inside_zone"}
    assert plan["wish"]["left_out"] == 1


def test_a_run_beyond_the_range_is_left_out_as_a_whole_and_says_so(here: World) -> None:
    plan = make_plan(request=request(*towers(here, 0, 5), uavs=(uav(max_range_m=1_200.0),), locks=(LockRequest("Tern", (0, 1)),)))
    assert targets_of(plan) == [[]]
    assert {reason for reason, _ in reasons(plan).values()} == {"beyond_range"}
    assert all(message.endswith("the run is left out as a whole.") for _, message in reasons(plan).values())


@pytest.mark.long
def test_with_more_targets_than_are_proven_the_cost_of_the_locks_is_told_too(here: World) -> None:
    points = [TargetRequest(here.line.pk, LonLat(10.0 + 0.0014 * number, 56.0)) for number in range(14)]
    reported: list[PlanProgress] = []
    asked = request(*points, uavs=(WEST, EAST), objective=Objective.MAKESPAN, locks=(LockRequest("East", (3, 2)),))
    plan = make_plan(request=asked, on_progress=reported.append)
    assert plan["wish"]["cost_s"] >= 0.0
    assert plan["wish"]["left_out"] == 0
    assert plan["lower_bound_m"] is None
    assert 0.0 < plan["lower_bound_s"] <= max(route["duration_s"] for route in plan["routes"])
    assert [item.share for item in reported] == sorted(item.share for item in reported)
    assert {str(item.message) for item in reported if item.draw is None} >= {"Working out what the locked parts cost"}


# --- bound and gap ----------------------------------------------------------------------------------------------------------------


def test_a_small_plan_is_proven(here: World) -> None:
    plan = make_plan(request=request(*towers(here, 0, 5), uavs=(WEST, EAST)))
    assert (plan["is_proven"], plan["gap"], plan["method"]) == (True, 0.0, "exact")
    assert plan["lower_bound_m"] == pytest.approx(plan["total_length_m"], abs=0.01)
    assert plan["lower_bound_m"] <= plan["total_length_m"]
    assert plan["lower_bound_s"] is None


def test_nothing_to_fly_has_a_bound_too() -> None:
    world()
    plan = make_plan(request=request(TargetRequest(island()[0].pk)))
    assert (plan["lower_bound_m"], plan["gap"], plan["is_proven"]) == (0.0, 0.0, True)


# --- the request ------------------------------------------------------------------------------------------------------------------


def wishful() -> PlanRequest:
    return PlanRequest(
        uavs=(UavRequest("Tern", UAV_AT, None, 12.0, EndAction.BASE, None, 3, ("Lidar",)),),
        targets=(TargetRequest(7, priority=Priority.HIGH, uav="Tern", sensor="Lidar"), TargetRequest(None, UAV_AT)),
        objective=Objective.TOTAL,
        return_to_start=False,
        locks=(LockRequest("Tern", (1, 0), at_end=True),),
        bases=(NEAR,),
    )


def test_a_request_comes_back_from_a_job_as_it_was() -> None:
    assert request_from_json(request_to_json(wishful())) == wishful()


def test_a_job_from_before_there_were_wishes_can_still_be_read() -> None:
    stored = request_to_json(replace(wishful(), locks=(), bases=()))
    del stored["locks"], stored["bases"]
    for uav_asked in stored["uavs"]:
        del uav_asked["most_targets"], uav_asked["sensors"]
    for target in stored["targets"]:
        del target["priority"], target["uav"], target["sensor"]
    read = request_from_json(stored)
    assert (read.locks, read.bases, read.uavs[0].most_targets, read.uavs[0].sensors) == ((), (), None, ())
    assert read.targets[0] == TargetRequest(7)


POINTS = (TargetRequest(None, UAV_AT),) * 3


@pytest.mark.parametrize(
    ("asked", "place"),
    [
        (request(TargetRequest(None, UAV_AT, uav="Kite")), "targets.0.uav"),
        (request(TargetRequest(None, UAV_AT, uav="Tern"), uavs=(uav(), uav())), "targets.0.uav"),
        (request(*POINTS, locks=(LockRequest("Kite", (0,)),)), "locks.0.uav"),
        (request(*POINTS, locks=(LockRequest("Tern", (0,)),), uavs=(uav(), uav())), "locks.0.uav"),
        (request(*POINTS, locks=(LockRequest("Tern", (3,)),)), "locks.0.targets"),
        (request(*POINTS, locks=(LockRequest("Tern", (0, 0)),)), "locks.0.targets"),
        (request(*POINTS, locks=(LockRequest("Tern", (0,)), LockRequest("Tern", (1, 0)))), "locks.1.targets"),
        (request(*POINTS, locks=(LockRequest("Tern", (0,), at_start=True), LockRequest("Tern", (1,), at_start=True))), "locks.1.at_start"),
        (request(*POINTS, locks=(LockRequest("Tern", (0,), at_end=True), LockRequest("Tern", (1,), at_end=True))), "locks.1.at_end"),
        (request(*POINTS, locks=(LockRequest("Tern", (0,), at_start=True, at_end=True), LockRequest("Tern", (1,)))), "locks.1.uav"),
        (request(TargetRequest(None, UAV_AT, uav="West"), uavs=(WEST, EAST), locks=(LockRequest("East", (0,)),)), "locks.0.targets"),
        (request(TargetRequest(None, UAV_AT, sensor="Lidar"), locks=(LockRequest("Tern", (0,)),)), "locks.0.targets"),
        (request(*POINTS, uavs=(uav(most_targets=1),), locks=(LockRequest("Tern", (0, 1)),)), "uavs.0.most_targets"),
    ],
)
def test_wishes_that_no_plan_could_keep_are_refused_where_they_stand(asked: PlanRequest, place: str) -> None:
    with pytest.raises(InvalidRequest) as refused:
        refuse_contradictions(asked)
    assert list(refused.value.faults) == [place]


def test_two_uavs_of_one_name_are_fine_while_nothing_names_them() -> None:
    refuse_contradictions(request(*POINTS, uavs=(uav(), uav())))
