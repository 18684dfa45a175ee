"""Vector tiles: what is in them, at which zoom, and when they are asked for again."""

import json
import math
from typing import Any

import pytest
from django.contrib.gis.geos import MultiPolygon, Polygon
from django.test import Client
from django.utils import timezone, translation

from inspection.models import Asset, DataImport, Ground, NoFlyZone
from inspection.selectors import asset_detail, asset_label, tile_of_version, tiles_version, vector_tile
from inspection.services import mark_ground_changed
from inspection.services.imports.regions import join_region
from tests.accounts.users import a_user, client_of
from tests.inspection.ground import bridge, line, railway, tower, zone
from tests.inspection.vector_tile import Feature, read_tile
from workspace.models import Role

pytestmark = pytest.mark.django_db


def tile_at(zoom: int, lon: float = 10.0, lat: float = 56.0) -> tuple[int, int, int]:
    column = (lon + 180.0) / 360.0 * 2**zoom
    row = (1.0 - math.asinh(math.tan(math.radians(lat))) / math.pi) / 2.0 * 2**zoom
    return zoom, int(column), int(row)


def layers_at(zoom: int, lon: float = 10.0, lat: float = 56.0) -> dict[str, list[Feature]]:
    return read_tile(vector_tile(*tile_at(zoom, lon, lat)))


def test_all_layers_are_in_a_near_tile() -> None:
    made = {"towers": tower(), "lines": line(), "railways": railway(), "bridges": bridge(), "zones": zone()}
    layers = layers_at(14)
    assert set(layers) == {*made, "bridge_points", "zone_labels"}
    for name, row in made.items():
        assert [feature.id for feature in layers[name]] == [row.pk], name
        assert layers[name][0].properties["id"] == row.pk
    types = {name: features[0].type for name, features in layers.items()}
    assert types == {"towers": 1, "bridge_points": 1, "zone_labels": 1, "lines": 2, "railways": 2, "bridges": 3, "zones": 3}


def test_a_line_says_what_the_map_needs() -> None:
    row = line(name="Ring", ref="R1", operator="AEP", voltages_v=[380_000, 12_470])
    [feature] = layers_at(14)["lines"]
    assert feature.properties == {
        "id": row.pk,
        "kind": "line",
        "subtype": "line",
        "label": "R1",
        "detail": "380 kV, 12.47 kV AEP",
        "ref": "R1",
        "name": "Ring",
        "operator": "AEP",
        "flyable": True,
        "voltage": 380,
        "voltages": "380 kV, 12.47 kV",
        "length_m": 1500,
    }


def test_what_is_not_stated_is_absent() -> None:
    row = line(osm_id=9)
    [feature] = layers_at(14)["lines"]
    stated = {"id": row.pk, "kind": "line", "subtype": "line", "label": "Line w9", "flyable": True}
    assert feature.properties == stated | {"detail": "voltage not stated", "length_m": 1500}


@pytest.mark.parametrize(
    ("kind", "facts"),
    [
        (tower, {"ref": "18", "name": "Big"}),
        (tower, {"name": "Big"}),
        (tower, {"ref": "18", "operator": "AEP", "voltages_v": [138_000]}),
        (tower, {"ref": "AEP", "operator": "AEP"}),
        (tower, {}),
        (tower, {"subtype": "pole"}),
        (tower, {"subtype": "portal", "osm_id": None, "osm_type": ""}),
        (line, {"operator": "AEP", "voltages_v": [138_000]}),
        (line, {"voltages_v": [12_470]}),
        (line, {"operator": "AEP"}),
        (line, {"operator": "AEP", "voltages_v": [138_000, 69_000]}),
        (line, {"ref": "L1", "operator": "AEP"}),
        (line, {"name": "AEP", "operator": "AEP"}),
        (line, {"ref": "L1", "name": "North", "voltages_v": [138_000, 69_000]}),
        (line, {"subtype": "minor_line"}),
        (line, {"subtype": "cable"}),
        (railway, {"operator": "CSX"}),
        (railway, {"ref": "12", "name": "Buckeye Line", "operator": "CSX"}),
        (railway, {"name": "Buckeye Line", "operator": "CSX"}),
        (railway, {"name": "CSX", "operator": "CSX"}),
        (railway, {"subtype": "tram"}),
        (railway, {"subtype": "subway"}),
        (railway, {"subtype": "light_rail"}),
        (bridge, {}),
        (bridge, {"tags": {"railway": "rail"}}),
    ],
)
def test_the_map_and_the_api_call_an_asset_alike(kind: Any, facts: dict[str, Any]) -> None:
    asset = kind(**facts)
    [feature, *_] = [feature for features in layers_at(14).values() for feature in features]
    assert feature.properties["label"] == asset_label(asset)
    assert feature.properties.get("detail", "") == asset_detail(asset)


@pytest.mark.parametrize(
    "facts",
    [
        {"operator": "AEP", "voltages_v": [138_000, 69_000]},
        {"ref": "L1", "name": "North", "operator": "AEP", "voltages_v": [138_000]},
        {"operator": "AEP"},
        {},
    ],
)
def test_the_map_and_the_api_call_a_support_of_a_line_alike(facts: dict[str, Any]) -> None:
    asset = tower(line=line((11.0, 56.0), (11.1, 56.0), **facts), place_on_line=18, places_on_line=41)
    [feature] = layers_at(14)["towers"]
    assert (feature.properties["label"], feature.properties["detail"]) == (asset_label(asset), asset_detail(asset))


@pytest.mark.parametrize(
    ("make", "named"),
    [
        (lambda: tower(osm_id=42), ("Mast n42", "")),
        (lambda: tower(line=line(), place_on_line=18, places_on_line=41), ("Mast 18 von 41", "Spannung nicht angegeben")),
        (lambda: railway(ref="12", operator="CSX"), ("12", "CSX")),
        (lambda: bridge(name="Weir", tags={"railway": "rail"}), ("Weir", "trägt eine Bahn")),
    ],
)
def test_a_tile_speaks_the_readers_language(make: Any, named: tuple[str, str]) -> None:
    key = make().pk
    asset = Asset.objects.select_related("line").get(pk=key)
    with translation.override("de"):
        [feature, *_] = [feature for features in layers_at(14).values() for feature in features if feature.id == key]
        assert (feature.properties["label"], feature.properties.get("detail", "")) == named == (asset_label(asset), asset_detail(asset))


def test_a_tower_has_the_voltage_of_its_line() -> None:
    tower(line=line(voltages_v=[345_000, 138_000]), place_on_line=1, places_on_line=1, voltages_v=[138_000])
    assert layers_at(10)["towers"][0].properties["voltage"] == 345


@pytest.mark.parametrize(
    ("kind", "facts", "layer", "zoom"),
    [
        (line, {"voltages_v": [50_000]}, "lines", 8),
        (line, {"voltages_v": [20_000]}, "lines", 10),
        (line, {}, "lines", 8),
        (line, {"subtype": "minor_line"}, "lines", 10),
        (line, {"voltages_v": [380_000], "is_flyable": False}, "lines", 13),
        (railway, {}, "railways", 8),
        (bridge, {}, "bridge_points", 10),
        (tower, {}, "towers", 10),
    ],
)
def test_things_appear_at_their_zoom(kind: Any, facts: dict[str, Any], layer: str, zoom: int) -> None:
    kind(**facts)
    assert layers_at(zoom).get(layer)
    assert not layers_at(zoom - 1).get(layer)


def test_high_voltage_is_on_every_map() -> None:
    line((9.0, 56.0), (11.0, 56.0), voltages_v=[100_000])
    assert all(layers_at(zoom).get("lines") for zoom in (0, 3, 7))


def test_zones_are_on_every_map() -> None:
    zone(half_deg=1.0)
    assert all(layers_at(zoom).get("zones") for zoom in (0, 5, 10))
    assert not layers_at(8).get("zone_labels")
    assert layers_at(9)["zone_labels"][0].properties["name"] == "Airport"


def test_a_vanished_asset_is_not_on_the_map() -> None:
    tower(vanished_at=timezone.now())
    assert "towers" not in layers_at(14)


def test_a_position_is_where_it_belongs() -> None:
    """A tower a quarter of the way into the tile from the west and the north."""
    zoom, column, row = tile_at(14)
    lon = (column + 0.25) / 2**14 * 360.0 - 180.0
    lat = math.degrees(math.atan(math.sinh(math.pi * (1.0 - 2.0 * (row + 0.25) / 2**14))))
    tower((lon, lat))
    [feature] = read_tile(vector_tile(zoom, column, row))["towers"]
    assert feature.first_position == (1024, 1024)


def test_a_line_has_fewer_vertices_from_afar() -> None:
    path = [(10.0 + index / 1e4, 56.0 + (index % 2) / 1e4) for index in range(500)]
    line(*path, voltages_v=[380_000])
    assert layers_at(12, *path[250])["lines"][0].vertex_count > layers_at(6)["lines"][0].vertex_count


def test_what_reaches_in_from_next_door_is_drawn_up_to_the_edge() -> None:
    line((9.0, 56.0), (11.0, 56.0), voltages_v=[380_000])
    assert layers_at(12, 10.5)["lines"]
    assert not layers_at(12, 11.5).get("lines")


def test_a_zone_up_to_the_pole_and_round_the_earth_can_be_drawn() -> None:
    cap = Polygon.from_bbox((-180.0, 80.0, 180.0, 90.0))
    NoFlyZone.objects.create(identifier="pole", name="Pole", geometry=MultiPolygon(cap, srid=4326))
    assert read_tile(vector_tile(0, 0, 0))["zones"]
    assert read_tile(vector_tile(3, 7, 0))["zones"]


def test_a_zone_says_when_it_applies_unless_that_is_very_long() -> None:
    period = {"startDateTime": None, "endDateTime": "2026-06-01T00:00:00Z", "schedule": []}
    always, seasonal, long = (zone(schedule=schedule) for schedule in (None, [period], [period] * 99))
    reported = {feature.id: feature.properties.get("schedule") for feature in layers_at(14)["zones"]}
    assert (reported[always.pk], json.loads(reported[seasonal.pk]), reported[long.pk]) == (None, [period], None)


def test_a_far_tile_is_kept_until_the_ground_changes_and_a_near_one_is_not() -> None:
    viewer = client_of(a_user(Role.VIEWER))
    addresses = ["/".join(map(str, tile_at(zoom))) for zoom in (10, 14)]
    mark_ground_changed()
    assert [get(viewer, address).content for address in addresses] == [b"", b""]
    row = line()
    far, near = (read_tile(get(viewer, address).content) for address in addresses)
    assert (far, [feature.id for feature in near["lines"]]) == ({}, [row.pk])
    mark_ground_changed()
    assert [feature.id for feature in read_tile(get(viewer, addresses[0]).content)["lines"]] == [row.pk]


def test_tiles_are_made_without_the_cache_while_it_is_away(settings: Any) -> None:
    nowhere = settings.CACHES["default"] | {"LOCATION": "unix:///nowhere/redis.sock"}
    settings.CACHES = {"default": nowhere}
    line()
    mark_ground_changed()
    assert tile_of_version(*tile_at(10), "no-cache") == vector_tile(*tile_at(10))


def get(client: Client, address: str, **headers: str) -> Any:
    return client.get(f"/api/v1/tiles/{address}", headers=headers)


def test_a_tile_needs_somebody_who_is_signed_in() -> None:
    assert get(Client(), "0/0/0").status_code == 401


def test_an_empty_tile_is_an_empty_body() -> None:
    answer = get(client_of(a_user(Role.VIEWER)), "14/0/0")
    assert (answer.status_code, answer.content) == (200, b"")
    assert answer["Content-Type"] == "application/vnd.mapbox-vector-tile"


@pytest.mark.parametrize("address", ["0/1/0", "0/0/1", "23/0/0", "4/16/0", "99999999999999999999/0/0", "-1/0/0", "a/b/c"])
def test_a_tile_outside_the_pyramid_is_not_found(address: str) -> None:
    answer = get(client_of(a_user()), address)
    assert answer.status_code == 404
    assert answer.json()["error"]["code"] == "not_found"


def test_a_tile_is_kept_until_the_ground_changes() -> None:
    client = client_of(a_user())
    tower()
    address = "/".join(map(str, tile_at(14)))
    first = get(client, address)
    assert first["Cache-Control"] == "private, no-cache"
    again = get(client, address, **{"If-None-Match": first["ETag"]})
    assert (again.status_code, again.content, again["ETag"]) == (304, b"", first["ETag"])
    mark_ground_changed()
    assert get(client, address, **{"If-None-Match": first["ETag"]}).status_code == 200


def version_in_english() -> str:
    with translation.override("en"):
        return tiles_version()


def test_a_tile_of_the_present_edition_is_kept_for_minutes_and_of_another_one_revalidated() -> None:
    client = client_of(a_user())
    mark_ground_changed()
    version = version_in_english()
    assert get(client, f"0/0/0?of={version}")["Cache-Control"] == "private, max-age=600"
    mark_ground_changed()
    assert version_in_english() != version
    assert get(client, f"0/0/0?of={version}")["Cache-Control"] == "private, no-cache"
    assert get(client, "0/0/0?of=3")["Cache-Control"] == "private, no-cache"


def test_a_page_with_a_map_names_the_edition_of_its_tiles() -> None:
    client = client_of(a_user())
    mark_ground_changed()
    assert f'<meta name="tiles" content="{version_in_english()}">' in client.get("/missions/new").content.decode()


def test_a_tile_of_another_database_with_as_many_changes_is_not_taken_for_this_ones() -> None:
    client = client_of(a_user())
    revision = mark_ground_changed()
    first = get(client, "0/0/0")
    Ground.objects.all().delete()
    assert mark_ground_changed() == revision
    assert get(client, "0/0/0", **{"If-None-Match": first["ETag"]}).status_code == 200


def test_a_far_tile_counts_what_it_does_not_draw() -> None:
    for place in ((10.0, 56.0), (10.1, 56.05), (10.2, 56.1)):
        tower(place)
    line((10.0, 56.0), (10.1, 56.0), voltages_v=[132_000])
    line((10.0, 56.0), (10.1, 56.0), voltages_v=[20_000])
    assert sum(feature.properties["count"] for feature in layers_at(6, 10.1, 56.05)["counts"]) == 4
    assert "counts" not in layers_at(8, 10.1, 56.05)


def test_a_region_that_is_a_dot_on_the_map_has_no_numbers_in_its_tiles() -> None:
    source = DataImport.objects.create(kind="osm", file_name="small.osm.pbf", sha256="0")
    tower((10.0, 56.0), data_import=source)
    tower((10.7, 56.3), data_import=source)
    join_region(source)
    assert "counts" not in layers_at(4, 10.1, 56.05)
    assert sum(feature.properties["count"] for feature in layers_at(7, 10.1, 56.05)["counts"]) == 2
