"""Random missions among zones with heights and times on real regions: no leg in a zone, each refusal true, judged without the planner."""

import random
from collections import Counter
from pathlib import Path
from typing import Any

import pytest

from missions.services import PlanRequest, make_plan
from tests.missions.flight_judge import Judge
from tests.missions.hand_judge import HandJudge
from tests.missions.random_flights import airs, approve_some, bring_in, departures, flight, put_zones
from tests.missions.random_missions import Region
from tests.missions.refusal_judge import first_of_all, missing
from tests.workspace.people import somebody

pytestmark = pytest.mark.django_db

REGIONS = ["columbus-ohio.osm.pbf", "liechtenstein-2021-infra.osm.pbf", "nepal-power-2025.osm.pbf"]
ZONE_SETS = 2
DEPARTURES = 2  # for each set of zones
MORE_AS_DRAWN = 0.15  # of the energy that a route over hills and tall things may take more than is counted on the network
AS_DRAWN = "As drawn"  # of one route with the target and others, not the least
FLOWN_SHARE = 0.2  # of the missions with such refusals are planned again with what is missing
BY_HAND_EVERY = 20  # of so many missions one is kept and changed by hand
SEEN = (
    "inside_zone", "beyond_range", "beyond_energy", "put off or higher", "several flights", "charges", "returns that fail",
    "beside approved ones", "changed by hand", "by hand refused", "refusals flown", "over or under a zone", "before or after its time",
)  # fmt: skip


@pytest.mark.parametrize("file_name", REGIONS)
def test_2000_random_missions_keep_every_promise_of_safety(shared_data: Any, file_name: str, tmp_path: Path) -> None:
    _fly(shared_data(f"osm/{file_name}"), tmp_path, missions=667, seed=1)


@pytest.mark.long
@pytest.mark.parametrize("file_name", REGIONS)
def test_20000_random_missions_keep_every_promise_of_safety(shared_data: Any, file_name: str, tmp_path: Path) -> None:
    _fly(shared_data(f"osm/{file_name}"), tmp_path, missions=6_667, seed=2)


def _fly(path: Path, folder: Path, *, missions: int, seed: int) -> None:
    hills = bring_in(path, folder, random.Random(seed))
    author = somebody()
    seen: Counter[str] = Counter()
    faults: list[str] = []
    for number in range(ZONE_SETS):
        draw = random.Random(seed * 1_000 + number)
        put_zones(seed * 100 + number, draw)
        region, judge = Region(), Judge(hills)
        by_hand = HandJudge(judge, author)
        times = departures(draw, DEPARTURES)
        every_air = airs(draw)
        for departs_at in times[1:]:
            approve_some(region, draw, draw.choice(every_air), departs_at, author)
        for place in range(missions // ZONE_SETS + 1):
            asked = flight(region, draw, draw.choice(every_air), draw.choice(times), author)
            try:
                found = _judged(asked, judge, draw, seen, by_hand if place % BY_HAND_EVERY == 0 else None)
            except Exception as error:  # a plan that breaks down is a fault like others, and the rest is still judged
                found = [f"{type(error).__name__}: {error}"]
            faults += [f"{fault} (zones {number}, mission {place}: {asked})" for fault in found]
        seen["over or under a zone"] += judge.zones.seen_beside_height
        seen["before or after its time"] += judge.zones.seen_beside_time
        seen["returns that fail"] += judge.returns.seen
    print(path.name, len(faults), "faults", dict(seen), *faults, sep="\n")
    assert faults == []
    assert seen["visited"] > missions // 2
    for kind in SEEN:
        assert seen[kind] > 0, kind


def _judged(asked: PlanRequest, judge: Judge, draw: random.Random, seen: Counter[str], by_hand: HandJudge | None) -> list[str]:
    plan = make_plan(request=asked)
    _count(seen, plan)
    found = [*judge.faults(asked, plan), *_refusals_that_can_be_flown(asked, plan, draw, seen)]
    return found if by_hand is None else [*found, *judge.wires.faults(plan), *by_hand.faults(asked, plan, draw, seen)]


def _count(seen: Counter[str], plan: dict[str, Any]) -> None:
    seen.update(item["reason"] for item in plan["unassigned"])
    seen[plan["objective"]] += 1
    seen["put off or higher"] += any((*plan["separation"]["delays"], *plan["separation"]["layers"]))
    seen["not kept apart"] += bool(plan["separation"]["unresolved"])
    closest = plan["separation"]["closest"]
    seen["beside approved ones"] += closest is not None and closest["missions"] != [None, None]
    for route in plan["routes"]:
        seen["visited"] += len(route["targets"])
        seen["several flights"] += any(point["kind"] == "base" for point in route["waypoints"])
        seen["charges"] += bool(route["charging"])
        seen[f"ends: {route['end_action']}"] += bool(route["waypoints"])


def _refusals_that_can_be_flown(asked: Any, plan: dict[str, Any], draw: random.Random, seen: Counter[str]) -> list[str]:
    """Of a target that is refused for range or battery: not to be had before all others, and with what is said to be missing it is."""
    refused = [item for item in plan["unassigned"] if item["reason"] in {"beyond_range", "beyond_energy"}]
    if not refused or asked.charging_w is not None or draw.random() > FLOWN_SHARE:
        return []
    item = draw.choice(refused)
    target, lacks = item["target"], missing(item)
    if lacks is None:
        return []
    seen["refusals flown"] += 1
    half = make_plan(request=first_of_all(asked, target, lacks[0] / 2, lacks[1] / 2))
    faults = []
    if target not in _left_out(half) and AS_DRAWN not in item["message"]:
        faults.append(f"target {target} is flown with half of what is missing: {item['message']}")
    for drawn in (0.0, MORE_AS_DRAWN):
        more_wh = lacks[1] * 1.01 + 0.1 + drawn * (lacks[1] + max(uav.performance.usable_wh or 0.0 for uav in asked.uavs))
        whole = make_plan(request=first_of_all(asked, target, lacks[0] * 1.001 + 60.0, more_wh))
        again = _left_out(whole).get(target)
        if again is None or again["reason"] != item["reason"] or "alone" in again["message"]:
            return faults  # alone: what is said to be missing is the least, by way of another target there and back
    return [*faults, f"target {target} is not flown with all that is missing: {item['message']}"]


def _left_out(plan: dict[str, Any]) -> dict[int, Any]:
    return {item["target"]: item for item in plan["unassigned"]}
