"""Zone files: what each format says, and what is wrong with those that are refused."""

import json

import pytest

from inspection.importers.zones.zone_file import ZoneFileError, read_zones

SQUARE = {"type": "Polygon", "coordinates": [[[9, 47], [10, 47], [10, 48], [9, 48], [9, 47]]]}


def feature(geometry=SQUARE, **properties):
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def collection(*features, **more):
    return {"type": "FeatureCollection", "features": list(features), **more}


def ed269(*geometry, **more):
    volume = {"uomDimensions": "M", "lowerLimit": 0, "lowerVerticalReference": "AGL", "upperLimit": 120, "upperVerticalReference": "AGL",
              "horizontalProjection": SQUARE}  # fmt: skip
    zone = {
        "identifier": "ABC0001",
        "country": "CHE",
        "name": "Field",
        "restriction": "PROHIBITED",
        "applicability": [{"permanent": "YES"}],
    }
    return {"title": "t", "features": [{**zone, "geometry": [{**volume, **layer} for layer in geometry or ({},)], **more}]}


def read(document):
    return read_zones(json.dumps(document).encode())


def faults(document):
    with pytest.raises(ZoneFileError) as refusal:
        read_zones(document if isinstance(document, bytes) else json.dumps(document).encode())
    return [(fault.place, fault.message) for fault in refusal.value.faults]


def test_the_first_envelope_of_ed_269_is_read_whole(zone_file):
    file = read_zones(zone_file("ed269-features.json").read_bytes())
    assert (file.source_format, file.zone_count, len(file.zones)) == ("ED-269", 6, 9)
    assert sum(zone.circle is not None for zone in file.zones) == 4
    concert = file.zones[0]
    assert concert.circle == {"centre": [26.541, 25.7065], "radius_m": 1200.0}
    assert concert.schedule[0]["schedule"] == [
        {"day": ["SAT", "SUN"], "startTime": "18:00:00Z", "startEvent": None, "endTime": "23:59:59Z", "endEvent": None}
    ]
    assert (concert.band.lower_limit_m, concert.band.lower_reference) == (0.0, "AGL")
    assert (concert.band.upper_limit_m, concert.band.upper_reference) == (2400.0, "AMSL")
    airfield = [zone for zone in file.zones if zone.identifier == "Varneck Airfield"]
    assert [(zone.layer, zone.band.lower_limit_m, zone.circle["radius_m"]) for zone in airfield] == [
        (0, 0.0, 900.0), (1, 45.0, 2200.0), (2, 90.0, 3300.0),
    ]  # fmt: skip
    park = [zone for zone in file.zones if zone.identifier == "Tarnfold Moor Nature Park"]
    assert [(zone.layer, zone.restriction) for zone in park] == [(0, "NO_RESTRICTION"), (1, "REQ_AUTHORISATION")]
    assert park[0].band.upper_limit_m == pytest.approx(91.44)  # 300 ft
    assert park[0].band.as_stated["upperLimit"] == 300
    assert file.zones[-1].band.upper_limit_m is None  # 99999 m


def test_the_second_envelope_of_ed_269_is_read_whole(zone_file):
    """With a byte-order mark, texts in Cyrillic letters, and a zone that states no limits."""
    data = zone_file("ed269-zone-list.json").read_bytes()
    assert data.startswith(b"\xef\xbb\xbf")
    file = read_zones(data)
    assert (file.source_format, file.zone_count, len(file.zones)) == ("ED-269", 4, 4)
    assert [len(zone.geometry.geoms[0].exterior.coords) for zone in file.zones] == [13, 13, 13, 13]
    assert [zone.band.upper_limit_m for zone in file.zones] == [120.0, 120.0, None, 120.0]
    assert file.zones[0].properties["zoneAuthority"][0]["name"] == "Общество Куилмур"


def test_the_swiss_test_document_is_read_whole(shared_data):
    file = read_zones(shared_data("zones/switzerland-ed269-test-che-1.json").read_bytes())
    assert (file.source_format, file.zone_count, len(file.zones)) == ("ED-269", 6, 10)
    assert sum(zone.circle is not None for zone in file.zones) == 4
    concert = file.zones[0]
    assert concert.circle == {"centre": [6.913146, 46.430758], "radius_m": 3000.0}
    assert concert.schedule[0]["schedule"] == [
        {"day": ["SAT", "SUN"], "startTime": "17:00:00Z", "startEvent": None, "endTime": "23:59:59Z", "endEvent": None}
    ]
    assert (concert.band.lower_limit_m, concert.band.lower_reference) == (0.0, "AGL")
    assert (concert.band.upper_limit_m, concert.band.upper_reference) == (6259.0, "AMSL")
    park = [zone for zone in file.zones if zone.identifier == "Gantrisch Nature Park"]
    assert [(zone.layer, zone.restriction) for zone in park] == [(0, "NO_RESTRICTION"), (1, "REQ_AUTHORISATION")]
    assert park[0].band.upper_limit_m == pytest.approx(76.2)  # 250 ft
    assert park[0].band.as_stated["upperLimit"] == 250


def test_the_bulgarian_extract_is_read_whole(shared_data):
    file = read_zones(shared_data("zones/bulgaria-2026-ed269-extract.json").read_bytes())
    assert (file.zone_count, len(file.zones)) == (11, 11)
    assert sum(len(zone.geometry.geoms[0].exterior.coords) for zone in file.zones) == 126
    assert {zone.band.upper_limit_m for zone in file.zones} == {120.0}


def test_a_zone_with_only_a_name_is_permanent_and_reaches_all_heights():
    (zone,) = read(collection(feature(name="Prison"))).zones
    assert (zone.name, zone.identifier, zone.schedule, zone.circle) == ("Prison", "Prison", None, None)
    assert (zone.band.lower_limit_m, zone.band.upper_limit_m, zone.band.as_stated) == (None, None, {})


def test_a_single_feature_and_a_bare_geometry_are_zones_too():
    assert read(feature(name="One")).zones[0].name == "One"
    assert read(SQUARE).zones[0].name == "zone 1"


def test_a_geojson_point_with_a_radius_is_a_circle():
    (zone,) = read(collection(feature({"type": "Point", "coordinates": [9, 47]}, name="Mast", radius=200))).zones
    assert zone.circle == {"centre": [9.0, 47.0], "radius_m": 200.0}


def test_not_stated_is_kept_apart_from_zero():
    stated, unstated = (read(ed269(layer)).zones[0].band for layer in ({}, {"lowerLimit": None, "lowerVerticalReference": None}))
    assert (stated.lower_limit_m, unstated.lower_limit_m) == (0.0, None)
    assert (stated.lower_reference, unstated.lower_reference) == ("AGL", "")


def test_the_swiss_way_of_writing_no_ceiling_is_not_stated_and_kept_as_written():
    band = read(ed269({"upperLimit": 99999})).zones[0].band
    assert (band.upper_limit_m, band.as_stated["upperLimit"]) == (None, 99999)


def test_features_of_one_identifier_become_its_layers():
    file = read(collection(feature(name="A"), feature(name="A"), feature(name="B")))
    assert [(zone.identifier, zone.layer) for zone in file.zones] == [("A", 0), ("A", 1), ("B", 0)]


def test_every_fault_of_a_file_is_named_with_its_place():
    bowtie = {"type": "Polygon", "coordinates": [[[9, 47], [10, 48], [10, 47], [9, 48], [9, 47]]]}
    far = {"type": "Polygon", "coordinates": [[[9, 47], [10, 47], [10, 148], [9, 47]]]}
    found = faults(collection(feature(name="good"), feature(bowtie, name="a"), feature(far, name="b"), feature(None, name="c"), 7))
    assert [place for place, _ in found] == [
        "features[1].geometry.coordinates", "features[2].geometry.coordinates[0][2]", "features[3].geometry", "features[4]",
    ]  # fmt: skip


def test_reading_stops_after_fifty_faults():
    assert len(faults(collection(*[feature(None)] * 200))) == 50


@pytest.mark.parametrize(
    ("layer", "place"),
    [
        ({"uomDimensions": "KM"}, "uomDimensions"),
        ({"uomDimensions": ["M"]}, "uomDimensions"),
        ({"upperLimit": "high"}, "upperLimit"),
        ({"upperLimit": -5}, "upperLimit"),
        ({"upperVerticalReference": "QFE"}, "upperVerticalReference"),
        ({"horizontalProjection": None}, "horizontalProjection"),
        ({"horizontalProjection": {"type": "Circle", "center": [9, 47], "radius": -3}}, "horizontalProjection.radius"),
        ({"horizontalProjection": {"type": "Circle", "center": [9, 97], "radius": 3}}, "horizontalProjection.center"),
        ({"horizontalProjection": {"type": "Blob"}}, "horizontalProjection"),
        ({"horizontalProjection": {"type": ["Polygon"]}}, "horizontalProjection"),
    ],
)
def test_faults_of_an_ed269_layer_are_named_with_their_place(layer, place):
    ((found, _),) = faults(ed269({}, layer))
    assert found == f"features[0].geometry[1].{place}"


@pytest.mark.parametrize(
    ("document", "message"),
    [
        (b"AN PRAHA\n", "no JSON"),
        ({"type": "FeatureCollection", "features": []}, "no zones"),
        ({"features": []}, "no zones"),
        ([], "neither"),
        ({"type": "Topology"}, "neither"),
        (collection(feature(), crs={"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::25832"}}), "EPSG:4326"),
        (collection(feature({"type": "Point", "coordinates": [9, 47]})), "radius"),
        (collection(feature({"type": "LineString", "coordinates": [[9, 47], [10, 47]]})), "no area"),
        (collection(feature(name=["a"])), "text is expected"),
        (collection(feature(name="a\0b")), "none"),
        (collection(feature(note="a\0b")), "none"),
        (collection(feature(note="\ud800")), "none"),
        (collection(feature(name="n" * 300)), "at most 255"),
        (ed269(applicability="always"), "are a list"),
        (ed269(identifier=None), "identifier"),
        (ed269(geometry=[]), "at least one geometry"),
    ],
)
def test_a_file_that_cannot_be_taken_says_why(document, message):
    assert message in faults(document)[0][1]
