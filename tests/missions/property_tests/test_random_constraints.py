"""Random missions with every wish there is: each is kept, no leg meets a zone, and what is left out is the least that can be."""

import random
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import shapely

from inspection.geodesy import LonLat, path_length_m
from inspection.selectors import zones_in_force
from missions.selectors.planning_context import current_airspace
from missions.selectors.resolved_targets import resolved_targets
from missions.services import BaseRequest, LockRequest, PlanRequest, TargetRequest, UavRequest, make_plan
from planning.connection_points import Terminal, paths_between
from planning.problem import End, Objective, Priority, Problem, Routes, UavStart, Visit
from planning.request import NO_BATTERY, EndAction
from tests.exact_geometry import segment_meets_polygon
from tests.missions.property_tests.random_missions import AMPLE
from tests.missions.property_tests.test_random_missions import is_on_shortest_ways
from tests.missions.worlds import LINE_LAT, TOWER_LONS, World, island, world, zone_around
from tests.planning.solver.random_problems import every_plan

pytestmark = pytest.mark.django_db

MISSIONS = 90
ENDS = {EndAction.RETURN: End.RETURN, EndAction.BASE: End.ANY_BASE}


@pytest.mark.long
def test_random_missions_keep_every_wish() -> None:
    here = world()
    island(10.05)
    zone_around((10.0015, 55.9975), half_deg=0.0006)
    zone_around((10.012, 56.004), half_deg=0.0012, name="Heath")
    zone_around((10.0185, 55.9985), half_deg=0.0007, name="Fair")
    draw = random.Random(5)
    seen = {"locked": 0, "left out": 0, "bases": 0, "not allowed": 0, "most": 0}
    for _ in range(MISSIONS):
        asked = _mission(draw, here)
        plan = make_plan(request=asked)
        _assert_no_leg_meets_a_zone(plan)
        _assert_wishes_are_kept(asked, plan)
        _assert_nothing_better_is_possible(asked, plan)
        reasons = [item["reason"] for item in plan["unassigned"]]
        seen["locked"] += sum(len(route["locked"]) for route in plan["routes"])
        seen["left out"] += len(reasons)
        seen["bases"] += sum(route["end_action"] == "base" and bool(route["targets"]) for route in plan["routes"])
        seen["not allowed"] += reasons.count("not_allowed")
        seen["most"] += reasons.count("most_targets")
    assert min(seen.values()) > 5, seen


def _mission(draw: random.Random, here: World) -> PlanRequest:
    """One or two UAVs, two to four targets, and wishes as the dice fall, of which none contradicts another."""
    objective = draw.choice(list(Objective))
    uavs = tuple(
        UavRequest(
            name,
            LonLat(draw.uniform(9.998, 10.022), draw.uniform(55.995, 55.999)),
            draw.choice([None, None, 1_500.0, 4_000.0]),
            draw.choice([8.0, 12.0]),
            draw.choice(list(EndAction)),
            most_targets=draw.choice([None, None, 1, 2]),
            sensors=tuple(draw.sample(["Lidar", "Thermal"], draw.randint(0, 2))),
            performance=AMPLE if objective is Objective.ENERGY else NO_BATTERY,
        )
        for name in ["West", "East"][: draw.randint(1, 2)]
    )
    targets = tuple(_target(draw, here, uavs) for _ in range(draw.randint(2, 4)))
    bases = tuple(BaseRequest(str(number), LonLat(draw.uniform(9.998, 10.022), draw.uniform(55.997, 56.001))) for number in range(2))
    asked = PlanRequest(uavs, targets, objective, draw.random() < 0.2, bases=bases)
    return replace(asked, locks=_locks(draw, asked)) if draw.random() < 0.5 else asked


def _target(draw: random.Random, here: World, uavs: tuple[UavRequest, ...]) -> TargetRequest:
    lon = draw.uniform(TOWER_LONS[0], TOWER_LONS[-1])
    place = draw.choice(
        [
            TargetRequest(draw.choice(here.towers).pk),
            TargetRequest(draw.choice(here.towers).pk),
            TargetRequest(here.bridge.pk),
            TargetRequest(here.line.pk, LonLat(lon, LINE_LAT)),
            TargetRequest(here.line.pk, stretch=(LonLat(lon, LINE_LAT), LonLat(lon + 0.003, LINE_LAT))),
            TargetRequest(None, LonLat(lon, draw.uniform(55.996, 56.008))),
        ]
    )
    return replace(
        place,
        priority=draw.choice(list(Priority)),
        uav=draw.choice([uav.name for uav in uavs]) if draw.random() < 0.2 else "",
        sensor=draw.choice(["lidar", " Thermal"]) if draw.random() < 0.2 else "",
    )


def _locks(draw: random.Random, asked: PlanRequest) -> tuple[LockRequest, ...]:
    """One run of targets that its UAV may fly."""
    uav = draw.choice(asked.uavs)
    free = [number for number, target in enumerate(asked.targets) if _may(uav, target)]
    run = tuple(draw.sample(free, min(len(free), uav.most_targets or 3, draw.randint(1, 3))))
    return (LockRequest(uav.name, run, draw.random() < 0.3, draw.random() < 0.3),) if run else ()


def _may(uav: UavRequest, target: TargetRequest) -> bool:
    known = {sensor.lower() for sensor in uav.sensors}
    return target.uav in {"", uav.name} and (not target.sensor or target.sensor.strip().lower() in known)


def _assert_no_leg_meets_a_zone(plan: dict[str, Any]) -> None:
    zones = [list(polygon.exterior.coords) for polygon in shapely.get_parts(zones_in_force().polygons).tolist()]
    for route in plan["routes"]:
        places = [tuple(waypoint["position"]) for waypoint in route["waypoints"]]
        assert not any(segment_meets_polygon(start, end, [zone]) for start, end in pairwise(places) for zone in zones)


def _assert_wishes_are_kept(asked: PlanRequest, plan: dict[str, Any]) -> None:
    flown_by = {target: uav for uav, route in enumerate(plan["routes"]) for target in route["targets"]}
    assert sorted([*flown_by, *(item["target"] for item in plan["unassigned"])]) == list(range(len(asked.targets)))
    assert all(_may(asked.uavs[uav], asked.targets[target]) for target, uav in flown_by.items())
    for number, (uav, route) in enumerate(zip(asked.uavs, plan["routes"], strict=True)):
        assert len(route["targets"]) <= (uav.most_targets or 9)
        assert route["length_m"] <= (uav.max_range_m or float("inf"))
        if route["targets"]:
            last = route["waypoints"][-1]
            ends = {EndAction.RETURN: [uav.position], EndAction.BASE: [base.position for base in asked.bases]}
            assert last["kind"] == "end"
            assert tuple(last["position"]) in ends.get(asked.end_action(number), [tuple(route["waypoints"][-2]["position"])])
            assert route["length_m"] == pytest.approx(path_length_m(np.array(route["geometry"]["coordinates"])), abs=0.002)
    for lock in asked.locks:
        order = next(route["targets"] for uav, route in zip(asked.uavs, plan["routes"], strict=True) if uav.name == lock.uav)
        assert _is_flown(lock, order) or not any(target in flown_by for target in lock.targets)
    value, bound = {
        Objective.TOTAL: (plan["total_length_m"], plan["lower_bound_m"]),
        Objective.MAKESPAN: (max(route["duration_s"] for route in plan["routes"]), plan["lower_bound_s"]),
        Objective.TIME: (plan["total_duration_s"], plan["lower_bound_s"]),
        Objective.ENERGY: (plan["total_energy_wh"] or 0.0, plan["lower_bound_wh"]),
    }[asked.objective]
    assert 0.0 <= bound <= value
    assert (plan["wish"] is not None) == bool(asked.locks)
    if asked.locks and plan["wish"]["cost_m"] is not None and asked.objective in {Objective.TOTAL, Objective.MAKESPAN}:
        assert plan["wish"]["cost_m" if asked.objective is Objective.TOTAL else "cost_s"] >= 0.0


def _is_flown(lock: LockRequest, order: list[int]) -> bool:
    """In its order with nothing between, and at the end of the route where it is wished to be."""
    places = [place for place in range(len(order)) if tuple(order[place : place + len(lock.targets)]) == lock.targets]
    return bool(places) and (not lock.at_start or places[0] == 0) and (not lock.at_end or places[0] + len(lock.targets) == len(order))


@dataclass(frozen=True)
class _Model:
    """The mission once more, put together from the request without the planner's own assembly."""

    problem: Problem
    numbers: list[int]  # of the open places, in the request


def _model(asked: PlanRequest, plan: dict[str, Any]) -> _Model:
    scene = current_airspace(is_by_length=is_on_shortest_ways(plan))
    near_m = scene.access.zone_clearance_m

    def is_clear(place: LonLat) -> bool:
        return not scene.zones.contains([place], near_m)[0]

    places = [place for place in resolved_targets(asked.targets)[0] if all(map(is_clear, place.course))]
    visits, courses = [], []
    for number, place in enumerate(places):
        for course in (place.course, place.course[::-1])[: 2 if len(place.course) > 1 else 1]:
            visits.append(Visit(number, False, path_length_m(np.array(course)), place.task.hold_s))
            courses.append((place.asset, course))
    uavs = [number for number, uav in enumerate(asked.uavs) if is_clear(uav.position)]
    ways = paths_between(
        scene.graph,
        scene.zones,
        [Terminal(asked.uavs[uav].position) for uav in uavs],
        [Terminal(course[0], asset) for asset, course in courses],
        [Terminal(course[-1], asset) for asset, course in courses],
        scene.access,
        [Terminal(base.position) for base in asked.bases if is_clear(base.position)],
    )
    numbers = [place.target for place in places]
    may = [[_may(asked.uavs[uav], asked.targets[numbers[visit.target]]) for visit in visits] for uav in uavs]
    problem = Problem(
        uavs=tuple(
            UavStart(
                asked.uavs[uav].max_range_m,
                ENDS.get(asked.end_action(uav), End.OPEN),
                asked.uavs[uav].cruise_speed_mps,
                asked.uavs[uav].most_targets,
            )
            for uav in uavs
        ),
        visits=tuple(visits),
        target_count=len(places),
        from_start_m=ways.from_start_m,
        between_m=ways.between_m,
        to_start_m=ways.to_start_m,
        objective=Objective.TOTAL if asked.objective is Objective.ENERGY else asked.objective,  # who is left out is the same
        to_base_m=np.repeat(ways.to_base_m[:, None], len(uavs), axis=1),
        allowed=np.array(may, dtype=bool).reshape(len(uavs), len(visits)),
    )
    return _Model(problem, numbers)


def _assert_nothing_better_is_possible(asked: PlanRequest, plan: dict[str, Any]) -> None:
    """No plan flies more of the high targets, of the normal ones, of the low ones, of each the locked ones first, then fewer metres."""
    model = _model(asked, plan)
    if not model.problem.uavs or not model.numbers:
        assert not any(route["targets"] for route in plan["routes"])
        return
    names = [uav.name for uav in asked.uavs if _flies(uav)]
    best = min(
        _rank(asked, _targets(model, routes), model.problem, routes)
        for routes in every_plan(model.problem)
        if _honours(asked, names, _targets(model, routes))
    )
    done = [route["targets"] for route in plan["routes"]]
    assert _missed(asked, done) == best[:6]
    if asked.objective is Objective.TOTAL:
        assert plan["total_length_m"] == pytest.approx(best[6], rel=1e-5, abs=0.01)


def _flies(uav: UavRequest) -> bool:
    scene = current_airspace()
    return not scene.zones.contains([uav.position], scene.access.zone_clearance_m)[0]


def _targets(model: _Model, routes: Routes) -> list[list[int]]:
    return [[model.numbers[model.problem.visits[visit].target] for visit in route] for route in routes]


def _honours(asked: PlanRequest, names: list[str], orders: list[list[int]]) -> bool:
    """Whether each locked run is flown as it is wished by its UAV, or left out whole."""
    flown = {target for order in orders for target in order}
    return all(
        any(name == lock.uav and _is_flown(lock, order) for name, order in zip(names, orders, strict=True))
        or not any(target in flown for target in lock.targets)
        for lock in asked.locks
    )


def _missed(asked: PlanRequest, orders: list[list[int]]) -> tuple[int, ...]:
    """How many targets of each priority are left out, the highest first, and of each those in locked runs first."""
    flown = {target for order in orders for target in order}
    locked = {target for lock in asked.locks for target in lock.targets}
    left_out = [number for number in range(len(asked.targets)) if number not in flown]
    of = [
        [number for number in left_out if asked.targets[number].priority == level]
        for level in (Priority.HIGH, Priority.NORMAL, Priority.LOW)
    ]
    return tuple(number for level in of for number in (len(locked.intersection(level)), len(set(level) - locked)))


def _rank(asked: PlanRequest, orders: list[list[int]], problem: Problem, routes: Routes) -> tuple[float, ...]:
    return (*_missed(asked, orders), sum(problem.route_length_m(uav, route) for uav, route in enumerate(routes)))
