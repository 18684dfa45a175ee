"""Random missions among zones with heights and times on real regions: no leg in a zone, each refusal true, judged without the planner."""

import random
from collections import Counter
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from django.contrib.gis.db.models import Extent

from inspection.models import Asset, NoFlyZone
from inspection.services import build_graph, import_osm, import_terrain, mark_ground_changed
from missions.flight_plan.conditions import Conditions, WindLayer
from missions.flight_plan.performance import IRIS_BATTERY_WH, IRIS_MAX_AIRSPEED_MPS, Performance
from missions.models import EndAction
from missions.routing.problem import Objective
from missions.services import PlanRequest, TargetRequest, make_plan
from tests.inspection.terrain.tiffs import write_geotiff
from tests.missions.clock_judge import too_near
from tests.missions.flight_judge import Judge, applies_at, sun
from tests.missions.random_missions import Region, put_random_zones
from tests.missions.worlds import request, uav, world, zone_around

pytestmark = pytest.mark.django_db

REGIONS = ["columbus-ohio.osm.pbf", "liechtenstein-2021-infra.osm.pbf", "nepal-power-2025.osm.pbf"]
HILLY = REGIONS[:2]  # the third has no terrain: limits above sea level cannot be compared there
ASSETS = 500  # of each region
ZONES, ZONE_SETS = 16, 2
DEPARTURES = 2  # for each set of zones: the network is cleared anew for all that apply at another time
A_MONDAY = datetime(2026, 11, 23, tzinfo=UTC)
EVENTS = ("BMCT", "SR", "SS", "EECT")


@pytest.mark.parametrize("file_name", REGIONS)
def test_2000_random_missions_keep_clear_of_zones_in_height_and_time(shared_data: Any, file_name: str, tmp_path: Path) -> None:
    _fly(shared_data(f"osm/{file_name}"), tmp_path, missions=667, seed=1)


@pytest.mark.long
@pytest.mark.parametrize("file_name", REGIONS)
def test_20000_random_missions_keep_clear_of_zones_in_height_and_time(shared_data: Any, file_name: str, tmp_path: Path) -> None:
    _fly(shared_data(f"osm/{file_name}"), tmp_path, missions=6_667, seed=2)


def _fly(path: Path, folder: Path, *, missions: int, seed: int) -> None:
    import_osm(path=path)
    _cut_out(ASSETS)
    if path.name in HILLY:
        _put_hills(folder / "hills.tif")
    seen: Counter[str] = Counter()
    for number in range(ZONE_SETS):
        draw = random.Random(seed * 1_000 + number)
        put_random_zones(seed * 100 + number)
        _give_heights_and_times(draw)
        region, judge = Region(), Judge()
        departures = [None, *(A_MONDAY + timedelta(minutes=draw.randrange(7 * 24 * 60)) for _ in range(DEPARTURES))]
        for _ in range(missions // ZONE_SETS + 1):
            asked = _in_the_wind(replace(region.mission(draw), departs_at=draw.choice(departures)), draw)
            plan = make_plan(request=asked)
            assert judge.faults(asked, plan) == [], asked
            seen.update(item["reason"] for item in plan["unassigned"])
            seen["visited"] += sum(len(route["targets"]) for route in plan["routes"])
            seen["put off or higher"] += any((*plan["separation"]["delays"], *plan["separation"]["layers"]))
            seen["not kept apart"] += bool(plan["separation"]["unresolved"])
        seen["over or under a zone"] += judge.seen_beside_height
        seen["before or after its time"] += judge.seen_beside_time
    print(path.name, dict(seen))
    assert seen["visited"] > missions
    for reason in ("inside_zone", "beyond_range", "beyond_energy", "put off or higher", "over or under a zone", "before or after its time"):
        assert seen[reason] > 0, reason


def _cut_out(most: int) -> None:
    """Leaves the assets nearest to the middle of the region: a small network is cleared of zones in no time."""
    rows = [(key, *centre.coords) for key, centre in Asset.objects.values_list("pk", "centre")]
    places = np.array([row[1:3] for row in rows])
    away = np.hypot(*((places - np.median(places, axis=0)) * (np.cos(np.radians(places[:, 1].mean())), 1.0)).T)
    Asset.objects.filter(pk__in=[rows[row][0] for row in np.argsort(away)[most:].tolist()]).delete()
    mark_ground_changed()


def _put_hills(path: Path) -> None:
    """Rolling ground between 100 m and 500 m above the sea under all of the region."""
    west, south, east, north = Asset.objects.aggregate(extent=Extent("centre"))["extent"]
    posts = 500
    step = max(east - west, north - south, 0.5) * 1.4 / posts
    east_of, south_of = np.meshgrid(np.arange(posts), np.arange(posts))
    heights = 300 + 120 * np.sin(east_of / 9.0) + 80 * np.cos(south_of / 13.0)
    middle = (west + east) / 2, (south + north) / 2
    origin = middle[0] - step * posts / 2, middle[1] + step * posts / 2
    import_terrain(path=write_geotiff(path, heights.astype("f4"), srid=9707, origin=origin, step=step))


def _give_heights_and_times(draw: random.Random) -> None:
    """Of the random zones, those that a small network leaves room for."""
    zones = draw.sample(list(NoFlyZone.objects.order_by("pk")), ZONES)
    NoFlyZone.objects.exclude(pk__in=[zone.pk for zone in zones]).delete()
    for zone in zones:
        for name, value in _band(draw).items():
            setattr(zone, name, value)
        zone.schedule = _schedule(draw)
    NoFlyZone.objects.bulk_update(zones, ["lower_limit_m", "lower_reference", "upper_limit_m", "upper_reference", "schedule"])
    mark_ground_changed()
    build_graph()


def _band(draw: random.Random) -> dict[str, Any]:
    """None, from the ground up, aloft, above the sea, or in a reference that cannot be compared."""
    kind = draw.choice(["none", "none", "low", "aloft", "aloft", "sea", "pressure"])
    if kind == "low":
        return {"upper_limit_m": draw.uniform(5, 200), "upper_reference": "AGL"}
    if kind == "aloft":
        lower_m = draw.uniform(20, 250)
        return {
            "lower_limit_m": lower_m, "lower_reference": "AGL",
            "upper_limit_m": lower_m + draw.uniform(10, 500), "upper_reference": "AGL",
        }  # fmt: skip
    if kind == "sea":
        lower_m = draw.uniform(0, 900)
        return {
            "lower_limit_m": lower_m, "lower_reference": "AMSL",
            "upper_limit_m": lower_m + draw.uniform(20, 900), "upper_reference": "AMSL",
        }  # fmt: skip
    if kind == "pressure":
        return {"lower_limit_m": 1_000.0, "lower_reference": "STD", "upper_limit_m": draw.choice([None, 3_000.0]), "upper_reference": "STD"}
    return {}


def _schedule(draw: random.Random) -> list[dict[str, Any]] | None:
    kind = draw.choice(["always", "always", "hours", "hours", "sun", "dates", "long ago"])
    if kind == "always":
        return None
    if kind == "long ago":
        return [_period([], end="2020-01-01T00:00:00Z")]
    if kind == "dates":
        start = A_MONDAY + timedelta(hours=draw.randrange(0, 150))
        return [_period([], start=_text(start), end=_text(start + timedelta(hours=draw.randrange(1, 40))))]
    days = draw.choice([["ANY"], draw.sample(["MON", "TUE", "WED", "THU", "FRI", "SAT", "SUN"], 3)])
    entry: dict[str, Any] = {"day": days, "startTime": None, "startEvent": None, "endTime": None, "endEvent": None}
    for side in ("start", "end"):
        if kind == "sun" and draw.random() < 0.7:
            entry[f"{side}Event"] = draw.choice(EVENTS)
        elif draw.random() < 0.9:
            entry[f"{side}Time"] = f"{draw.randrange(24):02}:{draw.randrange(60):02}:00Z"
    return [_period([entry])]


def _period(entries: list[dict[str, Any]], start: str | None = None, end: str | None = None) -> dict[str, Any]:
    return {"startDateTime": start, "endDateTime": end, "schedule": entries}


def _text(moment: datetime) -> str:
    return f"{moment:%Y-%m-%dT%H:%M:%SZ}"


def _in_the_wind(asked: PlanRequest, draw: random.Random) -> PlanRequest:
    """Half of the missions in wind, half of the UAVs with a battery, some with a limit of airspeed that the wind stays below."""
    wind = (WindLayer(10.0, draw.uniform(0, 6), draw.uniform(0, 359)), WindLayer(100.0, draw.uniform(0, 8), draw.uniform(0, 359)))
    air = Conditions(wind if draw.random() < 0.5 else (), draw.uniform(-10, 35))
    return replace(asked, conditions=air, uavs=tuple(replace(uav, performance=_performance(asked, draw)) for uav in asked.uavs))


def _performance(asked: PlanRequest, draw: random.Random) -> Performance:
    """Where the least energy is wished for, every UAV has a battery."""
    batteries_wh = [IRIS_BATTERY_WH, 200.0]
    return Performance(
        battery_wh=draw.choice(batteries_wh if asked.objective is Objective.ENERGY else [None, None, *batteries_wh]),
        max_airspeed_mps=draw.choice([None, None, IRIS_MAX_AIRSPEED_MPS, 15.0]),
        reserve_percent=draw.choice([0.0, 20.0]),
    )


# --- the judge sees what is plain to see --------------------------------------------------------------------------------------


def judged(zone: NoFlyZone, plan: dict[str, Any], asked: PlanRequest, **facts: Any) -> list[str]:
    """Of a plan that was made without the zone."""
    NoFlyZone.objects.filter(pk=zone.pk).update(**facts)
    return Judge().faults(asked, plan)


def test_the_judge_finds_a_crossing_at_its_height_and_time() -> None:
    here = world()
    asked = request(here.towers[5], departs_at=A_MONDAY + timedelta(hours=12))
    plan = make_plan(request=asked)
    zone = zone_around((10.010, 56.0), name="Air show", with_graph=False)
    hours = [{"day": ["MON"], "startTime": "11:00:00Z", "startEvent": None, "endTime": "13:00:00Z", "endEvent": None}]
    assert "meets Air show" in judged(zone, plan, asked)[0]
    assert judged(zone, plan, asked, lower_limit_m=81.0, lower_reference="AGL") == []
    assert "meets Air show" in judged(zone, plan, asked, lower_limit_m=79.0)[0]
    assert judged(zone, plan, asked, schedule=[_period(hours)])
    assert judged(zone, plan, asked, schedule=[_period([hours[0] | {"day": ["TUE"]}])]) == []
    timeless = replace(asked, departs_at=None)
    assert judged(zone, plan, timeless)


def test_the_judge_finds_a_false_refusal_and_a_forgotten_target() -> None:
    here = world()
    zone_around((10.2, 56.2), name="elsewhere")
    asked = request(
        TargetRequest(here.towers[2].pk), uavs=(uav(), uav(name="Gull", end_action=EndAction.RETURN)), objective=Objective.TOTAL
    )
    plan = make_plan(request=asked)
    assert Judge().faults(asked, plan) == []
    refused = {"target": 0, "reason": "inside_zone", "message": ""}
    empty = [route | {"targets": [], "waypoints": [], "length_m": 0.0, "arrival_s": []} for route in plan["routes"]]
    assert Judge().faults(asked, plan | {"routes": empty, "unassigned": [refused]}) == ["target 0 is not inside_zone: no zone is there"]
    assert Judge().faults(asked, plan | {"routes": empty}) == ["a target is visited twice or forgotten"]
    no_path = Judge().faults(asked, plan | {"routes": empty, "unassigned": [refused | {"reason": "no_path"}]})
    assert [fault.split(",")[0] for fault in no_path] == [
        "target 0 is not no_path: Tern is idle and could fly there straight",
        "target 0 is not no_path: Gull is idle and could fly there straight",
    ]


def test_the_judge_counts_seconds_and_watt_hours_for_itself() -> None:
    here = world()
    zone_around((10.2, 56.2), name="elsewhere")
    wind = (WindLayer(10.0, 5.0, 250.0), WindLayer(100.0, 8.0, 300.0))
    battery = Performance(battery_wh=IRIS_BATTERY_WH, max_airspeed_mps=IRIS_MAX_AIRSPEED_MPS)
    asked = request(here.towers[5], here.bridge, uavs=(uav(performance=battery),), conditions=Conditions(wind, -5.0))
    plan = make_plan(request=asked)
    [route] = plan["routes"]
    assert Judge().faults(asked, plan) == []
    frugal = plan | {"routes": [route | {"energy_wh": route["energy_wh"] * 0.97}]}
    assert [fault.split(" takes ")[0] for fault in Judge().faults(asked, frugal)] == ["Tern"]
    hasty = plan | {"routes": [route | {"arrival_s": [0.98 * arrival_s for arrival_s in route["arrival_s"]]}]}
    assert [fault.split(" takes ")[0] for fault in Judge().faults(asked, hasty)] == ["Tern"]
    small = replace(asked, uavs=(uav(performance=replace(battery, battery_wh=route["energy_wh"] * 1.2)),))
    assert any(" Wh of " in fault for fault in Judge().faults(small, plan))


def test_the_judge_sees_uavs_that_pass_one_place_together() -> None:
    here = world()
    zone_around((10.2, 56.2), name="elsewhere")
    asked = request(here.towers[5], uavs=(uav(end_action=EndAction.RETURN),))
    plan = make_plan(request=asked)
    [route] = plan["routes"]

    def beside(later_s: float) -> list[str]:
        late = {"departs_s": later_s, "arrival_s": [arrival_s + later_s for arrival_s in route["arrival_s"]]}
        return list(too_near(plan | {"routes": [route, route | {"uav": "Gull"} | late]}))

    assert beside(0.0)
    assert beside(40.0)
    assert beside(2 * route["duration_s"]) == []


def test_the_judge_reads_schedules_by_the_minute() -> None:
    night = [_period([{"day": ["SUN"], "startTime": "22:00:00Z", "startEvent": None, "endTime": "05:00:00Z", "endEvent": None}])]
    assert applies_at(night, A_MONDAY - timedelta(hours=1), 10.0, 56.0)
    assert applies_at(night, A_MONDAY + timedelta(hours=4, minutes=59), 10.0, 56.0)
    assert not applies_at(night, A_MONDAY + timedelta(hours=5), 10.0, 56.0)
    assert not applies_at(night, A_MONDAY + timedelta(hours=23), 10.0, 56.0)
    rise = sun("SR", A_MONDAY.date(), 12.57, 55.68)  # timeanddate.com: 8:02 in Copenhagen, UTC+1
    assert rise is not None
    assert abs(rise - datetime(2026, 11, 23, 7, 2, tzinfo=UTC)) < timedelta(minutes=3)
