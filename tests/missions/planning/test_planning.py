"""From a request to a plan on a small world."""

from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from django.contrib.gis.gdal import GDALRaster
from django.contrib.gis.geos import LineString, MultiPolygon, Point, Polygon

from inspection.geodesy import LonLat, path_length_m
from inspection.models import NoFlyZone
from inspection.selectors import NoGraph
from inspection.services import import_terrain
from missions.models import Uav
from missions.services import NO_SHORTFALL, BaseRequest, InvalidRequest, TargetRequest, make_plan
from planning.problem import Objective
from planning.progress import PlanProgress
from planning.request import EndAction
from planning.task import Task, TaskKind
from tests.exact_geometry import segment_meets_polygon
from tests.inspection import ground
from tests.missions.worlds import LINE_LAT, TOWER_LONS, UAV_AT, island, power_line, rebuild, request, uav, world, zone_around

pytestmark = pytest.mark.django_db


def reasons(plan: dict[str, Any]) -> dict[int, str]:
    return {item["target"]: item["reason"] for item in plan["unassigned"]}


def places(route: dict[str, Any], kind: str | None = None) -> list[tuple[float, float]]:
    return [tuple(waypoint["position"]) for waypoint in route["waypoints"] if kind in {None, waypoint["kind"]}]


def assert_clear_of_zones(plan: dict[str, Any]) -> None:
    """No leg of any route, as its waypoints say it, shares a point with a zone: by exact arithmetic."""
    for route in plan["routes"]:
        for start, end in pairwise(places(route)):
            for zone in NoFlyZone.objects.all():
                for rings in zone.geometry.coords:
                    assert not segment_meets_polygon(start, end, rings)


def test_a_route_follows_the_line_to_its_target() -> None:
    towers = world().towers
    plan = make_plan(request=request(towers[5], uavs=(uav((10.0, 55.9999)),)))
    (route,) = plan["routes"]
    assert [waypoint["kind"] for waypoint in route["waypoints"]] == ["start", *["pass"] * 5, "target", "end"]
    assert places(route)[1:7] == [(lon, LINE_LAT) for lon in TOWER_LONS]
    assert [waypoint["asset"] for waypoint in route["waypoints"][1:7]] == [tower.pk for tower in towers]
    assert plan["unassigned"] == plan["warnings"] == []


def test_lengths_are_metres_flown_not_weighted_cost() -> None:
    target = world().towers[5]
    plan = make_plan(request=request(target))
    (route,) = plan["routes"]
    flown_m = path_length_m(np.array(route["geometry"]["coordinates"]))
    assert route["length_m"] == plan["total_length_m"] == plan["longest_route_m"] == pytest.approx(flown_m, abs=0.01)


def test_every_kind_of_asset_can_be_a_target() -> None:
    here = world()
    plan = make_plan(
        request=request(
            here.towers[1],
            here.bridge,
            TargetRequest(here.railway.pk, position=LonLat(10.013, 56.0101)),
            here.line,
            TargetRequest(None, UAV_AT),
        )
    )
    assert plan["unassigned"] == []
    assert sorted(plan["routes"][0]["targets"]) == [0, 1, 2, 3, 4]
    assert [waypoint["target"] for waypoint in plan["routes"][0]["waypoints"] if waypoint["kind"] == "target"] == plan["routes"][0][
        "targets"
    ]


def test_tasks_have_defaults_per_kind_of_target() -> None:
    here = world()
    plan = make_plan(
        request=request(
            here.towers[1], here.line, TargetRequest(here.line.pk, position=LonLat(10.006, 56.0)), TargetRequest(None, UAV_AT),
            TargetRequest(here.bridge.pk, task=Task(TaskKind.HOLD, 42.0)),
        )
    )  # fmt: skip
    tasks = {waypoint["target"]: waypoint["task"] for waypoint in plan["routes"][0]["waypoints"] if waypoint["kind"] == "target"}
    assert tasks == {
        0: {"kind": "photo", "hold_s": 10.0},
        1: {"kind": "look", "hold_s": 0.0},
        2: {"kind": "look", "hold_s": 5.0},
        3: {"kind": "hold", "hold_s": 10.0},
        4: {"kind": "hold", "hold_s": 42.0},
    }


@pytest.mark.parametrize("start_lon", [10.0, 10.02])
def test_a_whole_line_is_flown_end_to_end_from_the_nearer_end(start_lon: float) -> None:
    here = world()
    (route,) = make_plan(request=request(here.line, uavs=(uav((start_lon, 55.995)),)))["routes"]
    flown = [tuple(waypoint["position"]) for waypoint in route["waypoints"] if waypoint["target"] == 0]
    line = [(lon, LINE_LAT) for lon in TOWER_LONS]
    assert flown == (line if start_lon == 10.0 else line[::-1])
    assert len(places(route, "target")) == 1


def test_a_stretch_begins_and_ends_where_it_was_picked() -> None:
    here = world()
    stretch = TargetRequest(here.line.pk, stretch=(LonLat(10.014, 56.0), LonLat(10.006, 56.0)))
    (route,) = make_plan(request=request(stretch))["routes"]
    flown = [waypoint["position"] for waypoint in route["waypoints"] if waypoint["target"] == 0]
    assert np.array(flown) == pytest.approx(np.array([[10.006, 56.0], [10.008, 56.0], [10.012, 56.0], [10.014, 56.0]]), abs=1e-9)


def test_a_picked_point_is_put_on_the_line_and_reached_along_it() -> None:
    here = world()
    (route,) = make_plan(request=request(TargetRequest(here.line.pk, position=LonLat(10.014, 56.0005))))["routes"]
    assert places(route, "target")[0] == pytest.approx((10.014, 56.0), abs=1e-9)
    assert places(route)[-3] == (10.012, 56.0)


def test_points_far_from_their_asset_and_unknown_assets_are_refused_with_their_places() -> None:
    here = world()
    far = TargetRequest(here.line.pk, position=LonLat(10.01, 56.01))
    stretch = TargetRequest(here.towers[0].pk, stretch=(UAV_AT, UAV_AT))
    with pytest.raises(InvalidRequest) as caught:
        make_plan(request=request(far, TargetRequest(999_999), stretch, here.towers[0]))
    assert set(caught.value.faults) == {"targets.0.position", "targets.1.asset", "targets.2.stretch"}
    assert "1,113 m" in caught.value.faults["targets.0.position"]


def test_a_detour_leads_around_a_zone_and_the_target_in_it_is_left_out() -> None:
    """The line goes on behind the zone: the route leaves it at the tower before, and joins it again at the tower behind."""
    here = world()
    zone_around((10.008, 56.0))
    plan = make_plan(request=request(here.towers[2], here.towers[4], uavs=(uav((10.0, 55.9999)),)))
    assert reasons(plan) == {0: "inside_zone"}
    assert plan["unassigned"][0]["message"] == "It stands inside Airport."
    (route,) = plan["routes"]
    assert route["targets"] == [1]
    assert_clear_of_zones(plan)
    bends = [waypoint for waypoint in route["waypoints"] if waypoint["kind"] == "pass" and waypoint["asset"] is None]
    assert len(bends) == 2
    assert {waypoint["altitude_agl_m"] for waypoint in bends} == {60.0}
    assert route["length_m"] == pytest.approx(path_length_m(np.array(route["geometry"]["coordinates"])), abs=0.01)


def test_a_line_that_runs_through_a_zone_cannot_be_flown_end_to_end() -> None:
    here = world()
    zone_around((10.008, 56.0))
    plan = make_plan(request=request(here.line, TargetRequest(here.line.pk, stretch=(LonLat(10.013, 56.0), LonLat(10.019, 56.0)))))
    assert reasons(plan) == {0: "inside_zone"}
    assert plan["unassigned"][0]["message"] == "It runs through Airport."


def test_an_access_leg_goes_round_a_zone_between_the_uav_and_the_nearest_tower() -> None:
    here = world()
    zone_around((10.0005, 55.9975), half_deg=0.0012)
    plan = make_plan(request=request(here.towers[0]))
    (route,) = plan["routes"]
    assert route["targets"] == [0]
    assert places(route)[1] != (TOWER_LONS[0], LINE_LAT)
    assert_clear_of_zones(plan)


def test_a_target_behind_a_wide_zone_is_reached_round_it_and_the_way_home_too() -> None:
    """A wall of 6 km between the UAV and the whole network, but for its western end."""
    here = world()
    wall = MultiPolygon(Polygon.from_bbox((9.99, 55.9972, 10.09, 55.9978)), srid=4326)
    NoFlyZone.objects.create(identifier="wall", name="wall", geometry=wall)
    rebuild()
    plan = make_plan(request=request(here.towers[0], uavs=(uav(end_action=EndAction.RETURN),)))
    (route,) = plan["routes"]
    assert route["targets"] == [0]
    assert_clear_of_zones(plan)
    assert route["length_m"] == pytest.approx(path_length_m(np.array(route["geometry"]["coordinates"])), abs=0.01)
    assert sum(waypoint["asset"] is None and waypoint["kind"] == "pass" for waypoint in route["waypoints"]) >= 4


def test_a_bare_position_behind_a_zone_is_reached_round_it() -> None:
    """Nearer than the network: a direct leg with bends, in both directions."""
    world()
    zone_around((10.001, 55.985), half_deg=0.002)
    asked = request(TargetRequest(None, LonLat(10.001, 55.980)), uavs=(uav((10.001, 55.990), end_action=EndAction.RETURN),))
    plan = make_plan(request=asked)
    (route,) = plan["routes"]
    assert route["targets"] == [0]
    assert_clear_of_zones(plan)
    straight_m = 2 * 0.010 * 111_360
    assert straight_m < route["length_m"] < 1.1 * straight_m


def test_an_island_out_of_reach_has_no_path() -> None:
    here = world()
    far = island()
    plan = make_plan(request=request(here.towers[0], far[0]))
    assert reasons(plan) == {1: "no_path"}
    expected = "No permitted route from any base. It is not connected to the network of any UAV: the nearest stands 18.7 km away."
    assert plan["unassigned"][0]["message"] == expected


def test_targets_on_another_continent_are_not_connected_whatever_zones_there_are() -> None:
    here = world()
    zone_around((10.05, 56.05))
    plan = make_plan(request=request(here.towers[0], *island(lon=-75.0)))
    assert {tuple(reason["code"] for reason in item["why"]) for item in plan["unassigned"]} == {("no_path", "not_connected")}
    assert all(item["why"][1]["params"]["away_km"] > 4_000 for item in plan["unassigned"])


def test_the_zone_that_bars_every_path_is_named() -> None:
    """A line of 45 km through a zone of 17 by 31 km."""
    here = world()
    towers = [here.towers[-1], *(ground.tower((10.05 + 0.05 * place, LINE_LAT)) for place in range(14))]
    power_line(towers)
    barrier = zone_around((10.35, 56.0), half_deg=0.14, name="Firing range")
    plan = make_plan(request=request(here.towers[0], towers[-1]))
    assert reasons(plan) == {1: "no_path"}
    (left_out,) = plan["unassigned"]
    assert [reason["code"] for reason in left_out["why"]] == ["no_path", "barred_by_zone"]
    assert left_out["why"][1]["params"] == {"zone": "Firing range", "zone_id": barrier.pk}
    assert left_out["message"] == "No permitted route from any base. Firing range is in the way."


def test_an_island_within_an_access_leg_of_a_uav_is_reached() -> None:
    world()
    far = island()
    plan = make_plan(request=request(far[1], uavs=(uav((10.25, 55.99)),)))
    assert plan["unassigned"] == []


def test_a_line_that_stands_alone_is_reached_over_an_access_leg_of_its_own() -> None:
    """8 km of open land between the UAV's network and a short line: longer than a direct leg, shorter than an access leg."""
    world()
    alone = [ground.tower((10.14, LINE_LAT)), ground.tower((10.144, LINE_LAT))]
    power_line(alone)
    rebuild()
    plan = make_plan(request=request(alone[1], uavs=(uav((9.95, LINE_LAT)),)))
    assert plan["unassigned"] == []


def test_a_bare_position_far_from_everything_is_too_far_from_the_network() -> None:
    here = world()
    plan = make_plan(request=request(here.towers[0], TargetRequest(None, LonLat(10.0, 56.3))))
    assert reasons(plan) == {1: "too_far_from_network"}


def test_a_bare_position_is_reached_straight_when_that_is_short_and_clear() -> None:
    world()
    (route,) = make_plan(request=request(TargetRequest(None, LonLat(10.001, 55.980))))["routes"]
    assert [waypoint["kind"] for waypoint in route["waypoints"] if waypoint["asset"] is not None] == []
    assert [waypoint["kind"] for waypoint in route["waypoints"] if waypoint["kind"] != "pass"] == ["start", "target", "end"]


def test_a_place_walled_in_by_zones_has_no_path_although_the_network_is_near() -> None:
    world()
    hole = (10.05, 56.05)
    for east, north, half_deg in ((-0.02, 0, 0.0195), (0.02, 0, 0.0195), (0, -0.04, 0.035), (0, 0.04, 0.035)):
        zone_around((hole[0] + east, hole[1] + north), half_deg=half_deg, with_graph=False)
    rebuild()
    plan = make_plan(request=request(TargetRequest(None, LonLat(*hole))))
    assert reasons(plan) == {0: "no_path"}
    assert "meets a no-fly zone" in plan["unassigned"][0]["message"]


def test_a_target_beyond_the_range_is_left_out_with_the_missing_metres() -> None:
    here = world()
    plan = make_plan(request=request(here.towers[5], uavs=(uav(max_range_m=1_200.0),)))
    assert reasons(plan) == {0: "beyond_range"}
    assert "more than the range" in plan["unassigned"][0]["message"]
    assert plan["routes"][0]["geometry"] is None


def test_the_range_counts_the_way_back_when_uavs_return() -> None:
    here = world()
    one_way = make_plan(request=request(here.towers[5], uavs=(uav(max_range_m=2_500.0),)))
    both_ways = make_plan(request=request(here.towers[5], uavs=(uav(max_range_m=2_500.0),), return_to_start=True))
    assert reasons(one_way) == {}
    assert reasons(both_ways) == {0: "beyond_range"}


def test_a_tower_above_the_height_limit_is_neither_inspected_nor_flown_over() -> None:
    here = world()
    tall = here.towers[2]
    tall.height_m = 150.0
    tall.save()
    rebuild()
    plan = make_plan(request=request(tall, here.towers[5], here.line))
    assert reasons(plan) == {0: "above_height_limit", 2: "above_height_limit"}
    assert tuple(tall.centre.coords) not in places(plan["routes"][0])


def test_a_deleted_asset_is_named_as_gone() -> None:
    world()
    assert reasons(make_plan(request=request(TargetRequest()))) == {0: "asset_gone"}


def test_a_vanished_asset_can_still_be_visited() -> None:
    here = world()
    gone = here.towers[5]
    gone.vanished_at = "2026-01-01T00:00Z"
    gone.save()
    rebuild()
    assert make_plan(request=request(gone))["routes"][0]["targets"] == [0]


def test_a_uav_inside_a_zone_stays_on_the_ground_and_the_plan_says_so() -> None:
    here = world()
    zone = zone_around((10.001, 55.990))
    plan = make_plan(request=request(here.towers[0], uavs=(uav((10.001, 55.990), name="Kite"), uav())))
    assert [route["targets"] for route in plan["routes"]] == [[], [0]]
    (warning,) = plan["warnings"]
    assert (warning["code"], warning["uav"]) == ("uav_inside_zone", 0)
    assert warning["message"] == "Kite stands inside Airport and cannot take off."
    assert warning["why"] == [{"code": "uav_inside_zone", "params": {"uav": "Kite", "zone": "Airport", "zone_id": zone.pk}}]


@pytest.mark.parametrize(
    ("state", "words"), [("retired", "Kite is retired and flies no more."), ("maintenance", "Kite is in maintenance and does not fly.")]
)
def test_a_uav_out_of_service_is_given_nothing(state: str, words: str) -> None:
    here = world()
    stored = Uav.objects.create(organisation_id=1, name="Kite", location=Point(*UAV_AT, srid=4326), state=state)
    kite = replace(uav(name="Kite"), uav=stored.pk)
    plan = make_plan(request=request(here.towers[0], uavs=(kite, uav())))
    assert [route["targets"] for route in plan["routes"]] == [[], [0]]
    (warning,) = plan["warnings"]
    assert (warning["code"], warning["uav"], warning["message"]) == ("uav_out_of_service", 0, words)


def test_when_no_uav_can_take_off_every_target_says_so() -> None:
    here = world()
    zone_around(UAV_AT)
    plan = make_plan(request=request(here.towers[0]))
    message = "There is no UAV that can take off. Tern stands inside Airport and cannot take off."
    (left_out,) = plan["unassigned"]
    assert (left_out["reason"], left_out["message"]) == ("no_path", message)
    assert [reason["code"] for reason in left_out["why"]] == ["no_uav_takes_off", "uav_inside_zone"]
    assert left_out.items() >= NO_SHORTFALL.items()


@pytest.mark.parametrize("action", list(EndAction))
def test_the_end_of_a_route_is_what_the_uav_does_at_the_end(action: EndAction) -> None:
    here = world()
    base = BaseRequest("North", LonLat(10.02, 56.001))
    (route,) = make_plan(request=request(here.towers[3], uavs=(uav(end_action=action),), bases=(base,)))["routes"]
    assert route["end_action"] == action
    elsewhere = {EndAction.RETURN: UAV_AT, EndAction.BASE: base.position}
    assert places(route)[-1] == elsewhere.get(action, (TOWER_LONS[3], LINE_LAT))
    assert route["waypoints"][-1]["kind"] == "end"


def test_two_uavs_share_the_targets_when_the_longest_route_counts() -> None:
    here = world()
    uavs = (uav((10.0, 55.995)), uav((10.02, 55.995), name="Kite"))
    plan = make_plan(request=request(here.towers[0], here.towers[5], uavs=uavs, objective=Objective.MAKESPAN))
    assert [route["targets"] for route in plan["routes"]] == [[0], [1]]
    assert [route["uav"] for route in plan["routes"]] == ["Tern", "Kite"]


def test_without_terrain_data_flat_ground_is_assumed() -> None:
    plan = make_plan(request=request(world().towers[0]))
    assert plan["flat_ground_assumed"]
    assert plan["terrain"] == "flat ground assumed"
    for waypoint in plan["routes"][0]["waypoints"]:
        assert waypoint["altitude_amsl_m"] is None
        assert waypoint["altitude_relative_m"] == waypoint["altitude_agl_m"] == 60.0


def test_with_terrain_data_all_three_heights_agree(tmp_path: Path) -> None:
    """Ground that rises 2.5 m per 0.001 degree to the east, from 100 m at 9.9 E."""
    here = world()
    columns, rows = 300, 300
    heights = np.tile(100 + 2.5 * np.arange(columns, dtype=np.float32), (rows, 1))
    raster = GDALRaster(
        {
            "driver": "GTiff", "name": str(tmp_path / "slope.tif"), "srid": 4326, "width": columns, "height": rows, "origin": (9.9, 56.15),
            "scale": (0.001, -0.001), "datatype": 6, "bands": [{"data": heights.tobytes(), "nodata_value": -9999.0}],
        }
    )  # fmt: skip
    raster._flush()
    import_terrain(path=tmp_path / "slope.tif", vertical_datum="EGM96")

    plan = make_plan(request=request(here.towers[5]))
    assert not plan["flat_ground_assumed"]
    assert plan["terrain"] == "terrain model"

    def ground_m(lon: float) -> float:
        return 100 + 2.5 * (lon - 9.9005) / 0.001

    take_off_m = ground_m(UAV_AT.lon)
    for waypoint in plan["routes"][0]["waypoints"]:
        amsl_m = ground_m(waypoint["position"][0]) + waypoint["altitude_agl_m"]
        assert waypoint["altitude_amsl_m"] == pytest.approx(amsl_m, abs=0.05)
        assert waypoint["altitude_relative_m"] == pytest.approx(amsl_m - take_off_m, abs=0.05)


def test_a_saved_zone_is_in_force_before_the_graph_is_built_anew() -> None:
    here = world()
    before = make_plan(request=request(here.towers[5]))
    zone_around((10.010, 56.0), half_deg=0.0005, with_graph=False, name="Fire brigade")
    after = make_plan(request=request(here.towers[5]))
    assert after["routes"][0]["targets"] == [0]
    assert after["graph_version"] == before["graph_version"]
    assert after["ground_revision"] > before["ground_revision"]
    assert_clear_of_zones(after)


def test_a_zone_saved_while_a_plan_is_made_is_kept_clear_of() -> None:
    here = world()
    zones: list[NoFlyZone] = []

    def save_a_zone(progress: PlanProgress) -> None:
        if progress.message.code == "working_out_heights" and not zones:
            zones.append(zone_around((10.010, 56.0), half_deg=0.0005, with_graph=False))

    plan = make_plan(request=request(here.towers[5]), on_progress=save_a_zone)
    assert zones
    assert not LineString(plan["routes"][0]["geometry"]["coordinates"]).intersects(zones[0].geometry)


def test_without_a_graph_there_is_no_plan() -> None:
    with pytest.raises(NoGraph):
        make_plan(request=request(TargetRequest(None, UAV_AT)))


def test_the_plan_names_the_graph_and_the_ground_that_it_was_made_on() -> None:
    here = world()
    first = make_plan(request=request(here.towers[0]))
    rebuild()
    second = make_plan(request=request(here.towers[0]))
    assert second["graph_version"] > first["graph_version"]
    assert second["ground_revision"] == first["ground_revision"] + 1


def test_what_is_out_of_range_along_the_line_is_flown_straight_and_the_plan_says_so() -> None:
    """1.3 km straight; 1.5 km by the preferred way, most of it along the line."""
    here = world()
    far = here.towers[-1]
    along = make_plan(request=request(far, uavs=(uav(max_range_m=2_500.0),)))
    straight = make_plan(request=request(far, uavs=(uav(max_range_m=1_400.0),)))
    assert along["total_length_m"] > 1_400.0 > straight["total_length_m"]
    assert (along["unassigned"], along["warnings"], straight["unassigned"]) == ([], [], [])
    assert [(warning["code"], warning["uav"]) for warning in straight["warnings"]] == [("shortest_ways", None)]
    [left_out] = make_plan(request=request(far, uavs=(uav(max_range_m=1_200.0),)))["unassigned"]
    assert left_out["reason"] == "beyond_range"
    assert left_out["message"].startswith(f"It is {straight['total_length_m'] / 1_000:.1f} km there")
