"""Assets, zones and the ground's summary over HTTP."""

from typing import Any

import pytest
from django.test import Client
from django.utils import timezone

from inspection.models import Asset, DataImport, GraphSnapshot, TerrainTile, ZoneSet
from inspection.network.snapshot_file import LAYOUT
from inspection.selectors import asset_detail, asset_label
from inspection.services import mark_ground_changed
from tests.accounts.users import a_user, client_of
from tests.inspection.ground import bridge, line, railway, square, tower, zone
from workspace.models import Role

pytestmark = pytest.mark.django_db


@pytest.fixture
def client() -> Client:
    return client_of(a_user(Role.VIEWER))


def found(client: Client, query: str = "") -> list[int]:
    answer = client.get(f"/api/v1/assets?{query}")
    assert answer.status_code == 200, answer.content
    return [feature["id"] for feature in answer.json()["features"]]


def test_an_asset_is_a_geojson_feature(client: Client) -> None:
    asset = line((10.0, 56.0), (10.0000001, 56.00000009), osm_id=7, voltages_v=[380_000, 110_000], operator="Energinet", circuits=2)
    collection = client.get("/api/v1/assets").json()
    assert collection["type"] == "FeatureCollection"
    assert collection["next"] is None
    assert collection["features"] == [
        {
            "type": "Feature",
            "id": asset.pk,
            "geometry": {"type": "LineString", "coordinates": [[10.0, 56.0], [10.0000001, 56.0000001]]},
            "properties": {
                "kind": "line",
                "subtype": "line",
                "label": "Energinet 380 kV",
                "detail": "380 kV, 110 kV",
                "name": "",
                "ref": "",
                "operator": "Energinet",
                "voltages_v": [380_000, 110_000],
                "circuits": 2,
                "height_m": None,
                "length_m": 1_500.0,
                "osm": "w7",
                "is_flyable": True,
                "line": None,
                "line_label": "",
                "region": None,
                "inspected_at": None,
                "inspected_share": None,
                "updated_at": collection["features"][0]["properties"]["updated_at"],
                "centre": [10.0, 56.0],
                "external_id": "",
                "attributes": {},
            },
        }
    ]


def test_a_box_finds_what_it_meets(client: Client) -> None:
    inside, _outside = tower((10.0, 56.0)), tower((11.0, 56.0))
    crossing = line((9.0, 55.9), (10.5, 56.1))
    _beside = line((9.0, 56.1), (9.0, 55.0), (11.0, 55.0))  # its box meets the box, the line does not
    assert found(client, "bbox=9.9,55.9,10.1,56.1") == [inside.pk, crossing.pk]


def test_a_box_over_the_180th_meridian_has_two_halves(client: Client) -> None:
    west, east = tower((179.9, 0.0)), tower((-179.9, 0.0))
    tower((0.0, 0.0))
    assert found(client, "bbox=179,-1,-179,1") == [west.pk, east.pk]


@pytest.mark.parametrize(
    "query",
    [
        *("bbox=1,2,3", "bbox=a,b,c,d", "bbox=nan,0,1,1", "bbox=0,0,1e999,1", "bbox=0,2,1,1", "bbox=-181,0,0,1", "bbox=0,0,1,91"),
        *("kind=dam", "text=" + "x" * 101, "text=a%00b", "limit=0", "cursor=x"),
    ],
)
def test_a_question_that_makes_no_sense_is_refused(client: Client, query: str) -> None:
    answer = client.get(f"/api/v1/assets?{query}")
    assert answer.status_code == 400
    assert answer.json()["error"]["message"]


def test_kinds_can_be_chosen(client: Client) -> None:
    assets = [tower(), line(), railway(), bridge()]
    assert found(client, "kind=tower,bridge") == [assets[0].pk, assets[3].pk]


@pytest.mark.parametrize(
    ("text", "expected"),
    [("north", "North ring"), ("RING", "North ring"), ("138 kV", "A-138"), ("138kv aep", "A-138"), ("12.47 kV", "L1"), ("w7000077", "L1")],
)
def test_text_finds_name_ref_operator_voltage_and_osm_id(client: Client, text: str, expected: str) -> None:
    line(name="North ring", voltages_v=[69_000])
    line(ref="A-138", operator="AEP Ohio", voltages_v=[345_000, 138_000])
    line(ref="L1", osm_id=7_000_077, voltages_v=[12_470])
    [asset_id] = found(client, f"text={text}")
    assert asset_label(Asset.objects.get(pk=asset_id)) == expected


@pytest.mark.parametrize("text", ["north 138 kV", "%", "_", "\\", "'"])
def test_text_that_nothing_matches_finds_nothing(client: Client, text: str) -> None:
    line(name="North ring", voltages_v=[69_000])
    assert found(client, f"text={text}") == []


def named_h133() -> list[int]:
    """Supports first, as an import stores them; the ids in the order in which a search for their line has them."""
    supports = [tower((10.0 + index / 100, 56.0), ref=f"H133-{index}").pk for index in range(3)]
    exact_tower = tower(name="h133").pk
    branch = line(ref="H133-B").pk
    return [line(ref="H133").pk, bridge(name="H133").pk, exact_tower, branch, *supports]


def test_what_is_called_exactly_so_comes_first_and_lines_before_their_supports(client: Client) -> None:
    expected = named_h133()
    assert found(client, "text=H133") == expected
    assert found(client, "text=H133&kind=tower") == [pk for pk in expected if pk not in {expected[0], expected[1], expected[3]}]


def test_pages_of_a_search_follow_one_another_in_the_order_of_matches(client: Client) -> None:
    expected = named_h133()
    for limit in (1, 2, 3):
        seen, address = [], f"/api/v1/assets?text=H133&limit={limit}"
        while address:
            page = client.get(address).json()
            seen += [feature["id"] for feature in page["features"]]
            address = page["next"]
        assert seen == expected


def test_a_cursor_of_a_list_is_refused_by_a_search(client: Client) -> None:
    named_h133()
    address = client.get("/api/v1/assets?limit=1").json()["next"]
    answer = client.get(f"{address}&text=H133")
    assert (answer.status_code, answer.json()["error"]["code"]) == (400, "invalid_cursor")


def test_pages_follow_one_another(client: Client) -> None:
    towers = [tower((10.0 + index / 100, 56.0)).pk for index in range(5)]
    line()
    seen, address = [], "/api/v1/assets?kind=tower&limit=2"
    while address:
        page = client.get(address).json()
        seen += [feature["id"] for feature in page["features"]]
        address = page["next"]
    assert seen == towers


def test_a_vanished_asset_is_left_out_of_lists_and_still_there_by_its_id(client: Client) -> None:
    asset = tower(vanished_at=timezone.now())
    assert found(client) == []
    assert client.get(f"/api/v1/assets/{asset.pk}").json()["properties"]["vanished_at"] is not None


def test_one_asset_comes_with_tags_and_source(client: Client) -> None:
    source = DataImport.objects.create(
        kind="osm", file_name="north.osm.pbf", sha256="0", attribution="© OpenStreetMap contributors, ODbL 1.0"
    )
    asset = tower(tags={"power": "tower", "material": "steel"}, data_import=source)
    properties = client.get(f"/api/v1/assets/{asset.pk}").json()["properties"]
    assert properties["tags"] == {"power": "tower", "material": "steel"}
    assert properties["source"]["attribution"] == "© OpenStreetMap contributors, ODbL 1.0"


@pytest.mark.parametrize("address", ["assets/1", "assets/99999999999999999999", "zones/1"])
def test_what_is_not_there_is_not_found(client: Client, address: str) -> None:
    assert client.get(f"/api/v1/{address}").status_code == 404


@pytest.mark.parametrize(
    ("kind", "facts", "label"),
    [
        (tower, {"ref": "18", "name": "Big"}, "18"),
        (tower, {"name": "Big"}, "Big"),
        (tower, {"osm_id": 5}, "Tower n5"),
        (tower, {"osm_id": 5, "subtype": "pole"}, "Pole n5"),
        (line, {"operator": "AEP", "voltages_v": [138_000]}, "AEP 138 kV"),
        (line, {"voltages_v": [12_470]}, "12.47 kV"),
        (line, {"operator": "AEP"}, "AEP"),
        (line, {"osm_id": 5, "subtype": "minor_line"}, "Line w5"),
        (railway, {"operator": "CSX"}, "CSX railway"),
        (railway, {"osm_id": 5}, "Railway w5"),
        (bridge, {"osm_id": 5}, "Bridge w5"),
    ],
)
def test_everything_has_a_name(kind: Any, facts: dict[str, Any], label: str) -> None:
    assert asset_label(kind(**facts)) == label


@pytest.mark.parametrize(
    ("subtype", "of_the_line", "label", "detail"),
    [
        ("tower", {"operator": "AEP", "voltages_v": [138_000, 69_000]}, "Tower 18 of 41", "138 kV AEP"),
        ("pole", {"ref": "L1", "name": "North", "operator": "AEP", "voltages_v": [12_470]}, "Pole 18 of 41", "12.47 kV L1"),
        ("portal", {"name": "North", "operator": "AEP"}, "Portal 18 of 41", "North, voltage not stated"),
        ("tower", {}, "Tower 18 of 41", "voltage not stated"),
    ],
)
def test_a_support_is_called_by_its_place_on_its_line(subtype: str, of_the_line: dict[str, Any], label: str, detail: str) -> None:
    asset = tower(subtype=subtype, line=line(**of_the_line), place_on_line=18, places_on_line=41)
    assert (asset_label(asset), asset_detail(asset)) == (label, detail)
    asset.ref = "A7"
    assert (asset_label(asset), asset_detail(asset)) == ("A7", detail)


@pytest.mark.parametrize(
    ("kind", "facts", "detail"),
    [
        (tower, {}, ""),
        (tower, {"operator": "AEP", "voltages_v": [138_000]}, "138 kV AEP"),
        (line, {"operator": "AEP", "voltages_v": [138_000]}, ""),
        (line, {"ref": "L1", "operator": "AEP", "voltages_v": [138_000, 69_000]}, "138 kV, 69 kV AEP"),
        (line, {"ref": "L1", "operator": "AEP"}, "AEP, voltage not stated"),
        (line, {"operator": "AEP"}, "voltage not stated"),
        (railway, {"operator": "CSX"}, ""),
        (railway, {"ref": "12", "name": "Buckeye Line", "operator": "CSX"}, "Buckeye Line, CSX"),
        (bridge, {"ref": "I 270", "tags": {"highway": "motorway"}}, "carries a road"),
        (bridge, {"tags": {"highway": "cycleway", "railway": "abandoned"}}, "carries a path"),
        (bridge, {"tags": {"man_made": "bridge"}, "parts": [{"tags": {"railway": "rail"}}]}, "carries a railway"),
        (bridge, {"parts": [{"tags": {"railway": "tram"}}, {"tags": {"highway": "primary"}}]}, "carries a road and a railway"),
        (bridge, {"tags": {"waterway": "canal"}}, "carries water"),
        (bridge, {"tags": {"man_made": "bridge"}}, ""),
    ],
)
def test_a_second_fact_says_what_the_name_does_not(kind: Any, facts: dict[str, Any], detail: str) -> None:
    assert asset_detail(kind(**facts)) == detail


def test_a_list_reads_all_lines_of_its_supports_at_once(client: Client, django_assert_num_queries: Any) -> None:
    for place in range(1, 6):
        tower((10.0 + place / 100, 56.0), line=line(operator="AEP", voltages_v=[138_000]), place_on_line=place, places_on_line=9)
    client.get("/api/v1/account")  # once a minute it is noted that somebody was here
    with django_assert_num_queries(5):  # session, user, assets, what the organisation keeps with them, inspections
        answer = client.get("/api/v1/assets?kind=tower").json()
    names = [(feature["properties"]["label"], feature["properties"]["detail"]) for feature in answer["features"]]
    assert names == [(f"Tower {place} of 9", "138 kV AEP") for place in range(1, 6)]
    with django_assert_num_queries(5):
        client.get(f"/api/v1/assets/{answer['features'][0]['id']}")


def test_a_zone_states_facts_and_keeps_not_stated_apart_from_zero(client: Client) -> None:
    source = DataImport.objects.create(kind="zones", file_name="zones.json", sha256="0", attribution="Authority")
    stored = zone(
        zone_set=ZoneSet.objects.create(name="Denmark", data_import=source),
        lower_limit_m=0.0,
        lower_reference="AGL",
        schedule=[{"permanent": "NO"}],
        properties={"contact": "tower"},
    )
    feature = client.get(f"/api/v1/zones/{stored.pk}").json()
    assert feature["geometry"]["type"] == "MultiPolygon"
    properties = feature["properties"]
    assert properties["lower_limit"] == {"value_m": 0.0, "reference": "AGL"}
    assert properties["upper_limit"] is None
    assert properties["schedule"] == [{"permanent": "NO"}]
    assert properties["properties"] == {"contact": "tower"}
    assert properties["zone_set"] == "Denmark"
    assert properties["source"]["attribution"] == "Authority"


def test_zones_are_found_by_box(client: Client) -> None:
    near, _far = zone((10.0, 56.0)), zone((12.0, 56.0))
    collection = client.get("/api/v1/zones?bbox=9.9,55.9,10.1,56.1").json()
    assert [feature["id"] for feature in collection["features"]] == [near.pk]


def test_the_ground_is_summed_up(client: Client) -> None:
    source = DataImport.objects.create(kind="osm", file_name="demo.osm.pbf", sha256="0", attribution="made by Spanwise", is_synthetic=True)
    DataImport.objects.create(kind="osm", file_name="old.osm.pbf", sha256="1", attribution="nothing left of it")
    tower((10.0, 56.0), data_import=source)
    tower((10.5, 56.5), data_import=source)
    tower((50.0, 50.0), data_import=source, vanished_at=timezone.now())
    zone()
    revision = mark_ground_changed()
    none = dict.fromkeys(["edges", "excluded_nodes", "excluded_edges"], 0)
    graph = GraphSnapshot.objects.create(
        ground_revision=revision, rules={"layout": LAYOUT}, nodes=2, components=2, arrays=b"", arrays_sha256="", build_s=0.1, **none
    )
    summary = client.get("/api/v1/ground").json()
    assert summary.pop("graph").items() >= {"version": graph.version, "nodes": 2, "edges": 0, "is_current": True}.items()
    assert summary == {
        "revision": revision,
        "extent": [10.0, 56.0, 10.5, 56.5],
        "counts": {"tower": 2, "line": 0, "railway": 0, "bridge": 0, "zone": 1},
        "attribution": ["made by Spanwise"],
        "is_synthetic": True,
        "has_terrain": False,
    }
    mark_ground_changed()
    assert client.get("/api/v1/ground").json()["graph"]["is_current"] is False


def test_the_ground_knows_of_terrain(client: Client) -> None:
    source = DataImport.objects.create(kind="terrain", file_name="hills.tif", sha256="0")
    steps = {"west_deg": 10.0, "north_deg": 56.0, "step_lon_deg": 0.1, "step_lat_deg": 0.1, "columns": 1, "rows": 1}
    TerrainTile.objects.create(data_import=source, extent=square((10.0, 56.0), 0.1), heights_amsl_m=b"", **steps)
    assert client.get("/api/v1/ground").json()["has_terrain"] is True


def test_nothing_on_the_ground_is_said_so(client: Client) -> None:
    summary = client.get("/api/v1/ground").json()
    assert (summary["graph"], summary["extent"], summary["attribution"]) == (None, None, [])
