"""ED-318, both envelopes of ED-269, and the faults that published feeds are known to have."""

import json
import random
from collections.abc import Callable
from copy import deepcopy
from pathlib import Path
from typing import Any

import pytest

from inspection.importers.zones.zone_file import ZoneFile, ZoneFileError, read_zones

RING = [[24.0, 60.0], [24.1, 60.0], [24.1, 60.1], [24.0, 60.1], [24.0, 60.0]]
AREA = {"type": "Polygon", "coordinates": [RING]}
AUTHORITY = [{"name": [{"text": "Authority", "lang": "en"}], "purpose": "INFORMATION"}]


def read(document: Any) -> ZoneFile:
    return read_zones(json.dumps(document).encode())


def faults_of(document: Any) -> list[str]:
    with pytest.raises(ZoneFileError) as refused:
        read(document)
    return [fault.place for fault in refused.value.faults]


def collection(*features: dict[str, Any], **members: Any) -> dict[str, Any]:
    return {"type": "FeatureCollection", "features": list(features)} | members


def feature(geometry: Any = AREA, **properties: Any) -> dict[str, Any]:
    return {"type": "Feature", "geometry": geometry, "properties": properties}


def ed318(geometry: Any = AREA, **properties: Any) -> dict[str, Any]:
    facts = {"identifier": "A1", "country": "FIN", "type": "PROHIBITED", "variant": "COMMON", "zoneAuthority": AUTHORITY}
    return feature(geometry, **facts | properties)


def ed269(**facts: Any) -> dict[str, Any]:
    return {
        "identifier": "A1",
        "country": "CHE",
        "name": "Zone",
        "restriction": "PROHIBITED",
        "geometry": [{"horizontalProjection": AREA}],
    } | facts


@pytest.mark.parametrize(
    ("name", "zones", "layers", "circles", "valid_from"),
    [
        ("ed318-collection", 2, 3, 1, "2026-01-01T06:00:00Z"),
        ("ed318-Example_Collection", 2, 3, 1, "2018-12-31T15:59:59Z"),
        ("ed318-Example_GeoZone_Circle", 1, 1, 1, "2018-12-31T15:59:59Z"),
        ("ed318-Example_GeoZone_2_Layers", 1, 2, 0, "2018-12-31T15:59:59Z"),
    ],
)
def test_ed_318_files_are_read_whole(
    name: str, zones: int, layers: int, circles: int, valid_from: str, zone_file: Callable[[str], Path]
) -> None:
    found = read_zones(zone_file(f"{name}.json").read_bytes())
    assert (found.source_format, found.zone_count, len(found.zones)) == ("ED-318", zones, layers)
    assert sum(zone.circle is not None for zone in found.zones) == circles
    assert found.valid_from == valid_from


def test_layers_schedules_and_names_of_a_file_are_as_stated(zone_file: Callable[[str], Path]) -> None:
    found = read_zones(zone_file("ed318-collection.json").read_bytes())
    upper, lower, circle = found.zones
    assert found.provider == "Elme Valley Demo Authority"
    assert (upper.identifier, upper.layer, lower.layer, upper.name) == ("ELM0001", 0, 1, "Elmsgard Airport")
    assert (upper.band.lower_limit_m, upper.band.lower_reference, upper.band.upper_limit_m) == (60.0, "AGL", 120.0)
    assert lower.band.upper_limit_m == pytest.approx(60.96)  # 200 ft
    assert upper.schedule is not None
    assert [(entry["day"], entry["startTime"], entry["startEvent"]) for entry in upper.schedule[0]["schedule"]] == [
        (["ANY"], "15:00:00Z", None), (["SUN"], None, "SR"),
    ]  # fmt: skip
    assert (circle.circle, circle.schedule, circle.reason) == (
        {"centre": [26.69, 25.71], "radius_m": 750.0},
        None,
        "POPULATION, NATURE",
    )


def test_layers_schedules_and_names_of_a_published_example_are_as_stated(shared_data: Callable[[str], Path]) -> None:
    upper, lower, circle = read_zones(shared_data("zones/ed318-Example_Collection.json").read_bytes()).zones
    assert (upper.identifier, upper.layer, lower.layer, upper.name) == ("NFZ6547", 0, 1, "LFPG-2")
    assert (upper.band.lower_limit_m, upper.band.lower_reference, upper.band.upper_limit_m) == (50.0, "AGL", 150.0)
    assert upper.schedule is not None and upper.schedule[0]["schedule"][1]["day"] == ["SUN"]
    assert (circle.circle, circle.schedule, circle.reason) == (
        {"centre": [2.636866, 50.122901], "radius_m": 3500.0},
        None,
        "POPULATION, NATURE",
    )


@pytest.mark.parametrize("name", ["ed318-invalid.json", "ed318-InvalidExample_GeoZone_2_Layers.json"])
def test_an_invalid_file_is_refused_with_its_places(name: str, zone_file: Callable[[str], Path]) -> None:
    with pytest.raises(ZoneFileError) as refused:
        read_zones(zone_file(name).read_bytes())
    assert [fault.place for fault in refused.value.faults] == ["metadata.validFrom", "features[0].properties.type"]


def test_enaires_nesting_empty_texts_and_heights_are_read(zone_file: Callable[[str], Path]) -> None:
    """Zone, layer and times are members of the properties, and what is not known is an empty text."""
    found = read_zones(zone_file("enaire.json").read_bytes())
    tower, plant = found.zones
    assert (found.source_format, found.zone_count) == ("ED-318", 2)
    assert (tower.identifier, tower.name, tower.restriction) == ("ZZELME01_CTR", "CTR ELMSGARD", "REQ_AUTHORIZATION")
    assert (tower.band.lower_limit_m, tower.band.upper_limit_m, tower.band.upper_reference) == (0.0, 60.0, "AGL")
    assert tower.schedule is None
    assert (tower.properties["message"], tower.properties["reasons"]) == (
        "<b>Espacio aéreo controlado.</b><br>Consulte con la torre antes de volar.",
        "AIR_TRAFFIC",
    )
    assert (plant.name, len(plant.geometry.geoms)) == ("ZZELME02", 2)
    assert (plant.band.upper_limit_m, plant.band.upper_reference) == (pytest.approx(1371.6), "AMSL")  # 4500 ft
    assert plant.schedule is not None and plant.schedule[0]["schedule"][0]["day"] == ["MON", "TUE", "WED", "THU", "FRI"]


def test_both_envelopes_of_ed_269_are_read() -> None:
    plain = read({"title": "Zones", "description": "", "features": [ed269()]})
    listed = read({"formatVersion": "1.0.0", "createdAt": "2026-10-01T00:00:00Z", "UASZoneList": [ed269()]})
    assert plain.source_format == listed.source_format == "ED-269"
    assert plain.zones == listed.zones
    assert faults_of({"UASZoneList": [ed269(identifier="")]}) == ["UASZoneList[0].identifier"]


def test_a_byte_order_mark_is_no_fault() -> None:
    data = b"\xef\xbb\xbf" + json.dumps({"features": [ed269()]}).encode()
    assert len(read_zones(data).zones) == 1


@pytest.mark.parametrize("document", [{"features": [ed269()]}, collection(ed318())])
def test_a_missing_limit_is_not_stated_and_never_0(document: Any) -> None:
    band = read(document).zones[0].band
    assert (band.lower_limit_m, band.upper_limit_m, band.lower_reference, band.upper_reference) == (None, None, "", "")


def test_99999_is_no_ceiling() -> None:
    volume = {
        "horizontalProjection": AREA,
        "lowerLimit": 0,
        "lowerVerticalReference": "AGL",
        "upperLimit": 99999,
        "upperVerticalReference": "AMSL",
    }
    band = read({"features": [ed269(geometry=[volume])]}).zones[0].band
    assert (band.lower_limit_m, band.upper_limit_m) == (0.0, None)
    assert band.as_stated["upperLimit"] == 99999


def test_a_long_identifier_is_taken() -> None:
    assert read({"features": [ed269(identifier="CH-GT9990")]}).zones[0].identifier == "CH-GT9990"


def test_a_zone_that_is_there_as_area_and_as_marker_is_one() -> None:
    """The shape of Denmark's Dronezoner: colours, site heights that are no limits, positions with a third number."""
    area = {"type": "Polygon", "coordinates": [[[*position, 12.0] for position in RING]]}
    marker = {"type": "Point", "coordinates": [24.05, 60.05, 12.0]}
    zone = feature(area, name="Airport", color="red", Elevation_m=12)
    found = read(collection(zone, feature(marker, name="Airport", color="red", Elevation_m=12)))
    assert [(record.name, record.band.upper_limit_m) for record in found.zones] == [("Airport", None)]
    assert found.notes == ("1 marker of zones that are here as areas: left out.",)


def test_a_point_with_a_buffer_is_a_circle_and_one_without_is_refused() -> None:
    point = {"type": "Point", "coordinates": [24.05, 60.05]}
    assert read(collection(feature(point, name="Mast", buffer=150))).zones[0].circle == {"centre": [24.05, 60.05], "radius_m": 150.0}
    assert faults_of(collection(feature(point, name="Mast"), feature(AREA, name="Other"))) == ["features[0].geometry"]


@pytest.mark.parametrize("make", [feature, ed318])
def test_what_the_source_hides_is_left_out_and_told(make: Callable[..., dict[str, Any]]) -> None:
    """Estonia hides features, and covers the world with EERZout."""
    world = {"type": "Polygon", "coordinates": [[[-170, -80], [170, -80], [170, 80], [-170, 80], [-170, -80]]]}
    found = read(collection(make(AREA, identifier="EE1"), make(AREA, identifier="EE2", hidden=True), make(world, identifier="EERZout")))
    assert [record.identifier for record in found.zones] == ["EE1"]
    assert found.notes == ("2 zones that the source hides: left out.",)


def test_extra_nesting_is_read() -> None:
    nested = feature(AREA | {"verticalLayer": {"upper": 400, "upperReference": "AGL", "uom": "ft"}}, UASZone=ed318()["properties"])
    record = read(collection(nested)).zones[0]
    assert (record.identifier, record.band.upper_limit_m, record.band.upper_reference) == ("A1", pytest.approx(121.92), "AGL")


def test_of_names_in_several_languages_the_english_one_is_shown_and_all_are_kept() -> None:
    names = [{"text": "Flughafen", "lang": "de-AT"}, {"text": "Airport", "lang": "en-GB"}]
    record = read(collection(ed318(name=names))).zones[0]
    assert (record.name, record.properties["names"]) == ("Airport", names)
    assert read(collection(ed318(name=names[:1]))).zones[0].name == "Flughafen"


@pytest.mark.parametrize(
    ("zone", "place"),
    [
        (ed318(type="REQ_AUTHORISATION"), "features[0].properties.type"),
        (ed318(variant="OWN"), "features[0].properties.variant"),
        (ed318(zoneAuthority=[]), "features[0].properties.zoneAuthority"),
        (ed318(identifier=""), "features[0].properties.identifier"),
        (ed318(limitedApplicability=[{"schedule": [{"day": ["FUN"]}]}]), "features[0].properties.limitedApplicability[0].schedule[0].day"),
        (ed318({"type": "Point", "coordinates": [24.0, 60.0]}), "features[0].geometry.extent"),
        (ed318({"type": "GeometryCollection", "geometries": []}), "features[0].geometry.geometries"),
        (ed318(AREA | {"layer": {"upper": 10, "upperReference": "QFE"}}), "features[0].geometry.layer.upperVerticalReference"),
    ],
)
def test_what_is_wrong_in_an_ed_318_zone_is_told_with_its_place(zone: dict[str, Any], place: str) -> None:
    assert faults_of(collection(zone)) == [place]


def test_an_area_across_the_antimeridian_is_two_either_side() -> None:
    ring = [[179.5, 10.0], [-179.5, 10.0], [-179.5, 11.0], [179.5, 11.0], [179.5, 10.0]]
    record = read(collection(ed318({"type": "Polygon", "coordinates": [ring]}))).zones[0]
    assert sorted(round(part.bounds[0], 3) for part in record.geometry.geoms) == [-180.0, 179.5]


@pytest.mark.parametrize(
    "names",
    [
        pytest.param(["ed318-collection", "ed269-features", "ed269-zone-list", "enaire"], id="own"),
        pytest.param(
            ["ed318-Example_Collection", "switzerland-ed269-test-che-1", "ed318-Example_GeoZone_2_Layers"],
            id="real",
            marks=pytest.mark.long,
        ),
    ],
)
def test_mutated_feeds_raise_nothing_but_the_named_error(names: list[str], zone_file: Callable[[str], Path]) -> None:
    rng = random.Random(11)
    documents = [json.loads(zone_file(f"{name}.json").read_text("utf-8-sig")) for name in names]
    strange = [None, True, -1, 1e300, "", "x", [], {}, [[]], {"type": "Polygon"}, float("1e18"), "2026-99-99"]
    for _ in range(750):
        document = deepcopy(rng.choice(documents))
        for _ in range(rng.randrange(1, 4)):
            _mutate(document, rng, strange)
        try:
            zones = read(document).zones
        except ZoneFileError:
            continue
        assert all(zone.geometry.is_valid for zone in zones)


def _mutate(value: Any, rng: random.Random, strange: list[Any]) -> None:
    while True:
        keys = list(value) if isinstance(value, dict) else list(range(len(value)))
        if not keys:
            return
        key = rng.choice(keys)
        if not isinstance(value[key], dict | list) or rng.random() < 0.15:
            value[key] = deepcopy(rng.choice(strange))
            return
        value = value[key]
