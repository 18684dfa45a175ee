"""Random missions among towers and wires of all heights: no leg passes one too near; and what cannot be flown over."""

import random
from collections import Counter
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from django.contrib.gis.geos import MultiPolygon, Polygon

from inspection.geodesy import LonLat, distance_m
from inspection.models import Asset, NoFlyZone
from inspection.selectors import ground_heights_m
from inspection.services import build_graph, import_osm, import_terrain, mark_ground_changed
from missions.services import TargetRequest, make_plan
from planning.energy.performance import Performance
from planning.request import EndAction
from tests.cases import long
from tests.inspection import ground
from tests.inspection.importers.terrain.tiffs import write_geotiff
from tests.missions.oracles.terrain_oracle import Hills
from tests.missions.oracles.wire_oracle import WireJudge
from tests.missions.property_tests.random_flights import ASSETS, HILLY, cut_out
from tests.missions.property_tests.random_missions import Region, put_random_zones
from tests.missions.property_tests.test_random_flights import REAL_REGIONS
from tests.missions.worlds import power_line, rebuild, request, uav, world

pytestmark = pytest.mark.django_db
ZONES = 10
AMPLE = Performance(battery_wh=2_000.0)
A_TUESDAY = datetime(2026, 11, 24, 9, tzinfo=UTC)


@pytest.mark.parametrize("file_name", ["elme-valley.osm.pbf", *long("quillmoor.osm.pbf")])
def test_random_missions_pass_no_tower_and_no_wire_too_near(region_file: Any, file_name: str, tmp_path: Path) -> None:
    _fly(region_file(file_name), tmp_path, missions=60, seed=3)


@pytest.mark.long
@pytest.mark.parametrize("file_name", REAL_REGIONS)
def test_many_random_missions_pass_no_tower_and_no_wire_too_near(region_file: Any, file_name: str, tmp_path: Path) -> None:
    _fly(region_file(file_name), tmp_path, missions=1_500, seed=4)


def _fly(path: Path, folder: Path, *, missions: int, seed: int) -> None:
    import_osm(path=path)
    cut_out(ASSETS)
    if path.name in HILLY:
        Hills().bring_in(folder / "hills.tif")
    draw = random.Random(seed)
    _give_heights(draw)
    put_random_zones(seed)
    NoFlyZone.objects.exclude(pk__in=NoFlyZone.objects.order_by("pk").values_list("pk", flat=True)[:ZONES]).delete()
    for zone in NoFlyZone.objects.order_by("pk"):  # room for flights below most of them, but not for all rises
        NoFlyZone.objects.filter(pk=zone.pk).update(lower_limit_m=draw.choice([None, 90.0, 100.0, 110.0]), lower_reference="AGL")
    mark_ground_changed()
    build_graph()
    region, judge, seen = Region(), WireJudge(ground_heights_m if path.name in HILLY else None), Counter[str]()
    for _ in range(missions):
        asked = region.mission(draw)
        asked = replace(asked, uavs=tuple(replace(one, performance=AMPLE) for one in asked.uavs))
        plan = make_plan(request=asked)
        assert judge.faults(plan) == [], asked
        heights_m = [waypoint["altitude_agl_m"] for route in plan["routes"] for waypoint in route["waypoints"]]
        seen["risen"] += max(heights_m, default=0.0) > 61.0
        seen["visited"] += sum(len(route["targets"]) for route in plan["routes"])
        seen.update(item["reason"] for item in plan["unassigned"])
    print(path.name, dict(seen), judge.passed)
    assert seen["visited"] > missions // 2
    assert seen["risen"] > missions // 10


def _give_heights(draw: random.Random) -> None:
    """Some towers stand taller than what is cleared between targets, a few too tall for any flight."""
    towers = list(Asset.objects.filter(kind="tower").order_by("pk"))
    for tower in towers:
        tower.height_m = draw.choices([None, draw.uniform(15, 105), draw.uniform(106, 160)], [0.7, 0.27, 0.03])[0]
    Asset.objects.bulk_update(towers, ["height_m"])


# --- on a small world ---------------------------------------------------------------------------------------------------------


def crossing(height_m: float) -> None:
    """A line of two towers across the way from the UAV to the line of the world, half way to it, some 500 m long."""
    towers = [ground.tower((lon, 55.9975), height_m=height_m) for lon in (9.997, 10.005)]
    power_line(towers)
    rebuild()


def test_a_leg_rises_over_a_wire_far_from_both_its_towers() -> None:
    here = world()
    crossing(90.0)
    plan = make_plan(request=request(here.towers[0], uavs=(uav((10.001, 55.9965)),)))
    assert plan["unassigned"] == []
    assert max(waypoint["altitude_agl_m"] for waypoint in plan["routes"][0]["waypoints"]) == pytest.approx(105.0)
    assert WireJudge().faults(plan) == []


def test_the_judge_sees_a_leg_through_a_wire() -> None:
    here = world()
    plan = make_plan(request=request(here.towers[0], uavs=(uav((10.001, 55.9965)),)))
    assert WireJudge().faults(plan) == []
    crossing(90.0)
    assert "too low" in WireJudge().faults(plan)[0]


def test_wires_too_tall_for_any_flight_are_gone_round() -> None:
    here = world()
    free = make_plan(request=request(here.towers[0], uavs=(uav((10.001, 55.9965)),)))
    crossing(110.0)
    plan = make_plan(request=request(here.towers[0], uavs=(uav((10.001, 55.9965)),)))
    assert plan["unassigned"] == []
    assert plan["total_length_m"] > free["total_length_m"] + 100.0
    places = np.array([waypoint["position"] for waypoint in plan["routes"][0]["waypoints"]])
    for end in ((9.997, 55.9975), (10.005, 55.9975)):
        assert distance_m(places, np.broadcast_to(end, places.shape)).min() > 25.0
    assert WireJudge().faults(plan) == []


def test_a_uav_under_wires_too_tall_for_any_flight_stays_on_the_ground() -> None:
    here = world()
    crossing(110.0)
    plan = make_plan(request=request(here.towers[0], uavs=(uav((10.001, 55.9975)),)))
    assert "cannot be flown over" in plan["warnings"][0]["message"]
    assert plan["routes"][0]["targets"] == []


def test_a_leg_does_not_rise_into_a_zone() -> None:
    here = world()
    crossing(90.0)
    zone = ground.zone((10.001, 55.9975), 0.0008, name="Approach")
    NoFlyZone.objects.filter(pk=zone.pk).update(lower_limit_m=100.0, lower_reference="AGL")
    rebuild()
    plan = make_plan(request=request(here.towers[0], uavs=(uav((10.001, 55.9965)),), departs_at=A_TUESDAY))
    assert plan["unassigned"] == []
    inside = [
        waypoint["altitude_agl_m"]
        for waypoint in plan["routes"][0]["waypoints"]
        if abs(waypoint["position"][0] - 10.001) < 0.0008 and abs(waypoint["position"][1] - 55.9975) < 0.0008
    ]
    assert all(height_m <= 60.0 for height_m in inside)
    assert WireJudge().faults(plan) == []


def valley(path: Path) -> None:
    """Ground at 100 m above the sea along 10.001° east, and 50 m higher 260 m to both sides of it."""
    step = 0.0005
    lons = 9.985 + step * (np.arange(90) + 0.5)
    heights = 100.0 + 50.0 * np.minimum(np.abs(lons - 10.001) / 0.004, 1.0)
    import_terrain(path=write_geotiff(path, np.tile(heights, (90, 1)).astype("f4"), srid=9707, origin=(9.985, 56.02), step=step))


def test_over_a_valley_a_leg_rises_over_where_the_wire_hangs(tmp_path: Path) -> None:
    here = world()
    valley(tmp_path / "valley.tif")
    crossing(45.0)
    plan = make_plan(request=request(here.towers[0], uavs=(uav((10.001, 55.9965)),)))
    assert plan["unassigned"] == []
    assert 100.0 < max(waypoint["altitude_agl_m"] for waypoint in plan["routes"][0]["waypoints"]) <= 120.0
    assert WireJudge(ground_heights_m).faults(plan) == []


def test_what_would_rise_into_a_zone_over_a_valley_goes_round_it(tmp_path: Path) -> None:
    here = world()
    valley(tmp_path / "valley.tif")
    crossing(45.0)
    zone = ground.zone((10.001, 55.9975), 0.0012, name="Approach")
    NoFlyZone.objects.filter(pk=zone.pk).update(lower_limit_m=125.0, lower_reference="AGL")
    rebuild()
    plan = make_plan(request=request(here.towers[0], uavs=(uav((10.001, 55.9961)),)))
    assert plan["unassigned"] == []
    places = np.array([waypoint["position"] for waypoint in plan["routes"][0]["waypoints"]])
    assert not ((np.abs(places - (10.001, 55.9975)) < 0.0012).all(axis=1)).any()
    assert WireJudge(ground_heights_m).faults(plan) == []


def test_a_wire_too_high_over_a_valley_is_gone_round_or_the_target_left_out(tmp_path: Path) -> None:
    here = world()
    valley(tmp_path / "valley.tif")
    crossing(70.0)
    plan = make_plan(request=request(here.towers[0], uavs=(uav((10.001, 55.9965)),)))
    assert WireJudge(ground_heights_m).faults(plan) == []
    assert all(waypoint["altitude_agl_m"] <= 120.0 for route in plan["routes"] for waypoint in route["waypoints"])
    assert plan["unassigned"] == []
    assert plan["total_length_m"] > 500.0  # straight it is some 400 m


def viaduct(**facts: Any) -> Asset:
    """A bridge from bank to bank of the valley, 500 m long and 12 m wide, across the way from the UAV to the line of the world."""
    area = Polygon.from_bbox((9.997, 55.99745, 10.005, 55.99755))
    bridge = ground.bridge((10.001, 55.9975), **facts)
    Asset.objects.filter(pk=bridge.pk).update(geometry=MultiPolygon(area, srid=4326))
    rebuild()
    return bridge


def test_over_a_valley_a_leg_beside_the_middle_of_a_bridge_rises_over_its_deck(tmp_path: Path) -> None:
    """The deck lies 50 m over the valley, and counts as 20 m over its banks: 85 m over the ground are needed in the middle."""
    here = world()
    valley(tmp_path / "valley.tif")
    way = request(here.towers[0], uavs=(uav((10.0005, 55.9965)),))
    plain = make_plan(request=way)
    viaduct()
    assert any("too low over a bridge" in fault for fault in WireJudge(ground_heights_m).faults(plain))
    plan = make_plan(request=way)
    assert plan["unassigned"] == []
    assert WireJudge(ground_heights_m).faults(plan) == []
    assert max(waypoint["altitude_agl_m"] for waypoint in plan["routes"][0]["waypoints"]) > 70.0


def test_a_bridge_with_pylons_of_unknown_height_is_gone_round_until_it_is_stated() -> None:
    here = world()
    tagged = viaduct(tags={"bridge:structure": "suspension"})
    way = request(here.towers[0], uavs=(uav((10.001, 55.9965)),))
    plan = make_plan(request=way)
    assert plan["unassigned"] == []
    assert plan["total_length_m"] > 600.0  # straight it is some 400 m
    Asset.objects.filter(pk=tagged.pk).update(height_m=80.0)
    rebuild()
    plan = make_plan(request=way)
    assert plan["total_length_m"] < 500.0
    assert WireJudge().faults(plan) == []
    assert max(waypoint["altitude_agl_m"] for waypoint in plan["routes"][0]["waypoints"]) == pytest.approx(95.0)


@pytest.mark.parametrize(("volts", "least_m"), [(380_000, 75.0), (110_000, 60.0)])
def test_lines_of_the_highest_voltages_are_taken_to_be_taller_and_their_towers_too(volts: int, least_m: float) -> None:
    """No height is tagged. The line is crossed on the way, and one of its towers is inspected."""
    here = world()
    towers = [ground.tower((lon, 55.998)) for lon in (10.006, 10.011)]
    power_line(towers, voltages_v=[volts])
    rebuild()
    tern = uav((10.009, 55.995), end_action=EndAction.RETURN)
    crossing = make_plan(request=request(here.towers[2], uavs=(tern,)))
    assert max(waypoint["altitude_agl_m"] for waypoint in crossing["routes"][0]["waypoints"]) == least_m
    inspecting = make_plan(request=request(towers[0], uavs=(tern,)))
    (at_tower,) = [waypoint for waypoint in inspecting["routes"][0]["waypoints"] if waypoint["kind"] == "target"]
    assert at_tower["altitude_agl_m"] == least_m


@pytest.mark.parametrize("end_action", [EndAction.HOVER, EndAction.RETURN])
def test_a_pole_that_a_taller_line_passes_right_over_is_inspected_from_above_that(end_action: EndAction) -> None:
    """Its wires hang 0.6 m beside the pole's middle."""
    here = world(height_m=14.0, subtype="pole")
    power_line([ground.tower((lon, lat), height_m=45.0) for lon, lat in ((10.0071, 55.9994), (10.0089, 56.00061))], voltages_v=[110_000])
    rebuild()
    plan = make_plan(request=request(here.towers[2], uavs=(uav(end_action=end_action),)))
    (at_pole,) = [waypoint for waypoint in plan["routes"][0]["waypoints"] if waypoint["kind"] == "target"]
    assert at_pole["altitude_agl_m"] == pytest.approx(60.0, abs=0.1)
    assert WireJudge().faults(plan) == []


def slope(path: Path) -> None:
    """Ground that rises by 1 in 7 to the east."""
    step = 0.0005
    lons = 9.985 + step * (np.arange(90) + 0.5)
    heights = 100.0 + 9_000.0 * (lons - 9.985)
    import_terrain(path=write_geotiff(path, np.tile(heights, (90, 1)).astype("f4"), srid=9707, origin=(9.985, 56.02), step=step))


def test_a_tower_too_tall_on_its_slope_between_two_targets_is_gone_round(tmp_path: Path) -> None:
    """Each of them can be flown to alone, without passing it."""
    here = world()
    slope(tmp_path / "slope.tif")
    here.towers[2].height_m = 104.9
    here.towers[2].save()
    rebuild()
    plan = make_plan(request=request(here.towers[1], here.towers[3]))
    assert plan["unassigned"] == []
    assert WireJudge(ground_heights_m).faults(plan) == []


def test_a_uav_keeps_to_its_first_targets_where_the_way_on_leads_over_what_is_too_tall(tmp_path: Path) -> None:
    """What is inspected right beside the tower keeps it from being gone round."""
    here = world()
    slope(tmp_path / "slope.tif")
    here.towers[2].height_m = 104.9
    here.towers[2].save()
    rebuild()
    beside = TargetRequest(None, LonLat(10.008, 56.0004))
    plan = make_plan(request=request(here.towers[1], here.towers[3], beside))
    stated = {item["target"]: item["message"] for item in plan["unassigned"]}
    assert plan["routes"][0]["targets"] == [0]
    assert stated[1] == "From its other targets Tern would have to pass a mast, wires or a bridge that cannot be flown over."
    assert WireJudge(ground_heights_m).faults(plan) == []
