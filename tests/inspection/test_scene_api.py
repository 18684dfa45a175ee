"""The scene of the 3D view over HTTP: what it says is what rows, terrain and planners say."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from django.contrib.gis.geos import GEOSGeometry
from django.core.management import call_command
from django.test import Client

from inspection.models import Asset, NoFlyZone
from inspection.network.build.network import network
from inspection.network.inspection_graph import EdgeKind
from inspection.network.rules import LinkingRules
from inspection.network.spans import hung_between
from inspection.scene.overhead import CATENARY_M
from inspection.selectors import scene as selector
from inspection.selectors.ground_data import ground_data
from inspection.selectors.terrain import ground_heights_m
from inspection.services import import_osm, import_terrain, import_zones, mark_ground_changed
from tests.accounts.users import a_user, client_of
from tests.inspection import ground
from tests.inspection.importers.terrain.tiffs import write_geotiff
from workspace.models import Role

pytestmark = pytest.mark.django_db

BOX = "9.98,55.99,10.03,56.02"
WITHIN_M = 0.5


@pytest.fixture
def client() -> Client:
    return client_of(a_user(Role.VIEWER))


def scene(client: Client, bbox: str = BOX) -> dict[str, Any]:
    response = client.get(f"/api/v1/scene?bbox={bbox}")
    assert response.status_code == 200, response.content
    return dict(response.json())


def by_id(things: list[dict[str, Any]]) -> dict[int, dict[str, Any]]:
    return {thing["id"]: thing for thing in things}


@pytest.mark.long
def test_the_demo_region_in_3d_is_that_of_rows_terrain_and_planners(client: Client, tmp_path: Path) -> None:
    """Every support and wire that planners know, where and as high as they count it; wires hang from slots that are not higher."""
    call_command("make_demo_region", tmp_path, verbosity=0)
    import_osm(path=tmp_path / "demo.osm.pbf", is_synthetic=True)
    import_terrain(path=tmp_path / "demo-terrain.tif", is_synthetic=True)
    import_zones(path=tmp_path / "demo-zones.json", is_synthetic=True)
    places = np.array([tower.centre.coords for tower in Asset.objects.filter(kind="tower")])
    middle = np.median(places, axis=0)
    west, south, east, north = *(middle - 0.04), *(middle + 0.04)
    shown = scene(client, f"{west},{south},{east},{north}")
    supports, spans = shown["supports"], shown["spans"]
    assert len(spans) > 30
    assert shown["left_out"] == {"supports": 0, "spans": 0, "railways": 0, "bridges": 0, "zones": 0}

    planned = network(ground_data(), LinkingRules())
    pairs, _, heights_m, _, _ = hung_between(planned)
    is_wire = pairs[:, 0] != pairs[:, 1]
    along_lines = {tuple(sorted(edge)) for edge in planned.edge[planned.edge_kind == EdgeKind.LINE].tolist()}
    counted = {
        frozenset(((*planned.position[one].round(6), heights[0]), (*planned.position[other].round(6), heights[1])))
        for (one, other), heights in zip(pairs[is_wire].tolist(), heights_m[is_wire].tolist(), strict=True)
        if tuple(sorted((one, other))) in along_lines
        and (
            (planned.position[[one, other]].min(axis=0) <= (east, north)) & (planned.position[[one, other]].max(axis=0) >= (west, south))
        ).all()
    }
    drawn = {
        frozenset((*np.round(supports[span[end]]["position"], 6), supports[span[end]]["height_m"]) for end in ("from", "to"))
        for span in spans
    }
    assert drawn == counted

    positions = np.array([support["position"] for support in supports])
    reported = np.array([support["ground_amsl_m"] for support in supports])
    assert shown["ground"]["kind"] == "terrain"
    assert np.abs(reported - ground_heights_m(positions)).max() < WITHIN_M
    for support in supports:
        assert max(slot[1] for slot in support["slots"] + support["earth"]) <= support["likely_m"] <= support["height_m"]
    for span in spans:
        lowest_m = min(slot[1] for end in ("from", "to") for slot in supports[span[end]]["slots"])
        assert span["sag_m"] == pytest.approx(min(span["length_m"] ** 2 / (8 * CATENARY_M), lowest_m / 2), abs=0.02)

    grid = shown["ground"]
    lon = grid["west_deg"] + np.arange(grid["columns"]) * grid["step_lon_deg"]
    lat = grid["north_deg"] - np.arange(grid["rows"]) * grid["step_lat_deg"]
    posts = np.stack(np.meshgrid(lon, lat), axis=-1).reshape(-1, 2)
    assert np.abs(np.array(grid["altitude_amsl_m"]) - ground_heights_m(posts)).max() < WITHIN_M

    for zone in shown["zones"]:
        row = NoFlyZone.objects.get(pk=zone["id"])
        for limit, value_m, reference in (
            (zone["lower"], row.lower_limit_m, row.lower_reference),
            (zone["upper"], row.upper_limit_m, row.upper_reference),
        ):
            stated = {"AGL": "ground", "AMSL": "sea"}.get(reference, "open") if value_m is not None else "open"
            assert limit == {"above": stated, "m": value_m if stated != "open" else None}
    assert shown["zones"] and shown["railways"] and shown["bridges"]


def test_heights_say_whether_a_tag_a_line_or_a_rule_told_them(client: Client) -> None:
    tagged = ground.tower((10.0, 56.0), height_m=31.5)
    plain = ground.tower((10.004, 56.0))
    tall = ground.tower((10.008, 56.0))
    ground.line((10.0, 56.0), (10.004, 56.0), (10.006, 56.0005), voltages_v=[110_000])
    ground.line((10.008, 56.0), (10.012, 56.0), voltages_v=[380_000], tags={"cables": "6"})
    shown = scene(client)
    supports = by_id(shown["supports"])
    assert [(supports[row.pk]["height_m"], supports[row.pk]["height_source"]) for row in (tagged, plain, tall)] == [
        (31.5, "tag"),
        (45.0, "assumed"),
        (60.0, "line"),
    ]
    assert supports[tall.pk]["voltage_v"] == 380_000
    assert sorted(span["phases"] for span in shown["spans"]) == [3, 3, 6]
    assert supports[None]["kind"] == "vertex"
    assert supports[plain.pk]["bearing_deg"] % 180 == pytest.approx(77, abs=4)


def test_a_pole_without_a_height_is_drawn_as_is_likely_and_counted_as_planners_do(client: Client) -> None:
    pole = ground.tower((10.0, 56.0), subtype="pole")
    ground.line((10.0, 56.0), (10.002, 56.0005), voltages_v=[20_000])
    tower = ground.tower((10.01, 56.0))
    ground.line((10.01, 56.0), (10.014, 56.0), voltages_v=[110_000])
    shown = scene(client)
    reported = [(one["id"], one["kind"], one["height_m"], one["likely_m"]) for one in shown["supports"]]
    assert (pole.pk, "pole", 45.0, 10.4) in reported
    assert (tower.pk, "tower", 45.0, 45.0) in reported
    assert sorted(one[1:] for one in reported if one[0] is None) == [("vertex", 45.0, 10.4), ("vertex", 45.0, 45.0)]
    assert max(slot[1] for one in shown["supports"] if one["voltage_v"] == 20_000 for slot in one["slots"]) <= 10.4


def test_a_span_across_the_edge_of_the_box_comes_with_both_its_ends(client: Client) -> None:
    outside = ground.tower((10.06, 56.0), height_m=55.0)
    inside = ground.tower((10.02, 56.0))
    alone = ground.tower((10.05, 56.01))
    ground.line((10.02, 56.0), (10.06, 56.0), voltages_v=[110_000])
    shown = scene(client)
    supports = by_id(shown["supports"])
    assert {outside.pk, inside.pk} == set(supports)
    assert supports[outside.pk]["height_m"] == 55.0
    assert alone.pk not in supports


def test_two_lines_on_the_same_towers_are_one_span_with_the_wires_of_both(client: Client) -> None:
    for lon in (10.0, 10.004):
        ground.tower((lon, 56.0))
    for _ in range(2):
        ground.line((10.0, 56.0), (10.004, 56.0), voltages_v=[110_000])
    (span,) = scene(client)["spans"]
    assert (len(span["lines"]), span["phases"], span["earth"]) == (2, 6, 1)


def test_without_terrain_the_ground_is_flat_and_says_so(client: Client) -> None:
    ground.tower()
    shown = scene(client)
    assert shown["ground"]["kind"] == "flat"
    assert set(shown["ground"]["altitude_amsl_m"]) == {0.0}
    assert shown["supports"][0]["ground_amsl_m"] == 0.0


def test_limits_above_the_sea_are_open_where_the_ground_is_not_known(client: Client, tmp_path: Path) -> None:
    ground.zone(upper_limit_m=500.0, upper_reference="AMSL", lower_limit_m=10.0, lower_reference="AGL")
    (zone,) = scene(client)["zones"]
    assert (zone["lower"], zone["upper"]) == ({"above": "ground", "m": 10.0}, {"above": "open", "m": None})
    heights = np.tile(100 + np.arange(300, dtype="f4"), (300, 1))
    import_terrain(path=write_geotiff(tmp_path / "hills.tif", heights, srid=9707, origin=(9.9, 56.15)))
    (zone,) = scene(client)["zones"]
    assert zone["upper"] == {"above": "sea", "m": 500.0}
    assert zone["upper_limit"] == {"value_m": 500.0, "reference": "AMSL"}


def test_zones_are_cut_and_bridges_are_whole(client: Client) -> None:
    ground.zone(half_deg=0.5)
    ground.bridge((10.0, 56.0), tags={"bridge": "yes", "highway": "primary", "layer": "2"})
    shown = scene(client)
    outline = np.array(shown["zones"][0]["polygons"][0][0])
    west, south, east, north = shown["clip"]
    assert np.allclose(sorted(set(outline[:, 0])), [west, east]) and np.allclose(sorted(set(outline[:, 1])), [south, north])
    (bridge,) = shown["bridges"]
    assert (bridge["deck_amsl_m"], bridge["deck_source"], bridge["height_m"], bridge["height_source"]) == (13.0, "layer", 30.0, "assumed")
    assert bridge["carries"] == "a road"


def test_a_zone_with_very_many_corners_comes_with_bounded_ones_and_hardly_another_area(client: Client) -> None:
    angle = np.linspace(0.0, 2 * np.pi, 30_001)[:-1]
    reach = 0.01 * (1 + 0.001 * np.sin(4_000 * angle))
    ring = np.column_stack([10.005 + reach * np.cos(angle), 56.005 + 0.6 * reach * np.sin(angle)])
    area = shapely.Polygon(ring)
    NoFlyZone.objects.create(identifier="jagged", name="Jagged", geometry=GEOSGeometry(shapely.MultiPolygon([area]).wkt, srid=4326))
    (zone,) = scene(client)["zones"]
    corners = sum(len(one) for polygon in zone["polygons"] for one in polygon)
    drawn = shapely.MultiPolygon([(polygon[0], polygon[1:]) for polygon in zone["polygons"]])
    assert corners <= selector.MAX_CORNERS
    assert drawn.is_valid
    assert drawn.symmetric_difference(area).area < 0.005 * area.area


def test_what_goes_beyond_a_limit_is_left_out_from_the_edge_and_counted(client: Client, monkeypatch: pytest.MonkeyPatch) -> None:
    near = ground.tower((10.005, 56.005))
    for step in range(3):
        ground.tower((9.981 + 0.001 * step, 55.991))
    ground.zone(), ground.zone((10.028, 56.018), half_deg=0.0005)
    monkeypatch.setattr(selector, "MAX_SUPPORTS", 1)
    monkeypatch.setattr(selector, "MAX_ZONES", 1)
    shown = scene(client)
    assert [support["id"] for support in shown["supports"]] == [near.pk]
    assert (shown["left_out"]["supports"], shown["left_out"]["zones"]) == (3, 1)
    assert len(shown["zones"]) == 1


def test_a_scene_that_has_not_changed_is_not_sent_again(client: Client) -> None:
    ground.tower()
    mark_ground_changed()
    first = client.get(f"/api/v1/scene?bbox={BOX}")
    again = client.get(f"/api/v1/scene?bbox={BOX}", headers={"If-None-Match": first["ETag"]})
    assert (again.status_code, again.content) == (304, b"")
    ground.tower((10.001, 56.0))
    mark_ground_changed()
    later = client.get(f"/api/v1/scene?bbox={BOX}", headers={"If-None-Match": first["ETag"]})
    assert (later.status_code, len(later.json()["supports"])) == (200, 2)
    elsewhere = client.get("/api/v1/scene?bbox=9.98,55.99,10.03,56.03", headers={"If-None-Match": later["ETag"]})
    assert elsewhere.status_code == 200


@pytest.mark.parametrize(
    "bbox",
    [
        "", "1,2,3", "a,b,c,d", "nan,55,10,56", "inf,55,10,56", "-inf,-90,inf,90", "10,56,10,56", "10,56,9,57", "10,57,11,56",
        "-180,-90,180,90", "10,55,11,56", "0,86,0.01,86.01", "170,10,-170,10.1", "1e308,0,1e308,1", "10.0,56.0,10.0001,56.5",
        "9.98,55.99,10.03,56.02,1", "9.98,55.99,10.03,56.02' OR 1=1", "181,0,182,1",
    ],
)  # fmt: skip
def test_a_box_that_is_none_or_too_large_is_refused_with_the_reason(client: Client, bbox: str) -> None:
    response = client.get("/api/v1/scene", {"bbox": bbox})
    assert response.status_code == 400
    error = response.json()["error"]
    assert error["message"].startswith("bbox: ") and "bbox" in error["details"]


def test_the_scene_is_for_those_who_have_signed_in() -> None:
    assert Client().get(f"/api/v1/scene?bbox={BOX}").status_code in {401, 403}


def test_hostile_tags_come_through_as_text_or_not_at_all(client: Client) -> None:
    ground.tower((10.0, 56.0), tags={"design": "<script>", "structure": "\u0000" * 0 + "x" * 500, "line_management": "'"}, ref="<b>7</b>")
    ground.tower((10.004, 56.0))
    ground.line((10.0, 56.0), (10.004, 56.0), tags={"cables": "9" * 40, "frequency": "²"})
    ground.railway(tags={"tracks": "٣", "electrified": "{}"})
    ground.bridge(tags={"layer": "-" * 50 + "1"})
    shown = scene(client)
    assert shown["spans"][0]["phases"] == 12
    assert shown["railways"][0]["tracks"] == 1
    assert "<b>7</b>" in json.dumps(shown)
