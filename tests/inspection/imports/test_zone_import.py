"""Importing zone files: all or nothing, and hostile ones refused with the database unharmed."""

import json
import math
import random
from io import StringIO

import pytest
from django.core.management import call_command
from django.core.management.base import CommandError
from django.db import connection

from inspection.models import DataImport, Ground, NoFlyZone, ZoneSet
from inspection.services import ZoneFileError, import_zones
from tests.runaway import no_runaway

pytestmark = pytest.mark.django_db


def square(west=9.0, south=47.0, side=0.1):
    east, north = west + side, south + side
    return {"type": "Polygon", "coordinates": [[[west, south], [east, south], [east, north], [west, north], [west, south]]]}


def feature(geometry, **properties):
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def write(path, *features):
    path.write_text(json.dumps({"type": "FeatureCollection", "features": list(features)}))
    return path


def revision():
    return Ground.objects.filter(pk=1).values_list("revision", flat=True).first() or 0


def rows():
    return list(NoFlyZone.objects.order_by("pk").values())


@pytest.mark.parametrize(
    ("name", "layers"),
    [("ed269-features", 9), ("ed269-zone-list", 4), ("switzerland-ed269-test-che-1", 10), ("bulgaria-2026-ed269-extract", 11)],
)
def test_documents_are_stored_whole_and_the_same_file_again_changes_nothing(name, layers, zone_file):
    path = zone_file(f"{name}.json")
    first = import_zones(path=path)
    before = rows()
    second = import_zones(path=path)
    assert len(before) == first.counts["layers"] == second.counts["unchanged"] == layers
    assert rows() == before
    assert (second.pk, revision(), DataImport.objects.count()) == (first.pk, 1, 1)
    assert ZoneSet.objects.get().source_format == "ED-269"


@pytest.mark.parametrize(
    ("name", "concert", "upper_limit_m", "circle", "contact", "permanent"),
    [
        (
            "ed269-features.json", "Elmsgard Concert Meadow", 2400, {"centre": [26.541, 25.7065], "radius_m": 1200.0},
            "Town of Elmsgard", ("EL-0003", 1),
        ),
        (
            "switzerland-ed269-test-che-1.json", "Montreux Concert Area", 6259, {"centre": [6.913146, 46.430758], "radius_m": 3000.0},
            "Commune de Montreux", ("Lausanne Airport", 2),
        ),
    ],
)  # fmt: skip
def test_bands_circles_and_schedules_are_stored_as_stated(name, concert, upper_limit_m, circle, contact, permanent, zone_file):
    import_zones(path=zone_file(name))
    zone = NoFlyZone.objects.get(identifier=concert)
    assert (zone.lower_limit_m, zone.lower_reference, zone.upper_limit_m, zone.upper_reference) == (0, "AGL", upper_limit_m, "AMSL")
    assert zone.circle == circle
    assert zone.schedule[0]["schedule"][0]["day"] == ["SAT", "SUN"]
    assert zone.properties["zoneAuthority"][0]["contactName"] == contact
    assert NoFlyZone.objects.get(identifier=permanent[0], layer=permanent[1]).schedule is None


def test_the_next_file_of_the_set_changes_adds_and_removes_and_keeps_the_rest(tmp_path):
    path = tmp_path / "zones.geojson"
    import_zones(path=write(path, feature(square(), name="same"), feature(square(9.2), name="moved"), feature(square(9.4), name="gone")))
    keys = dict(NoFlyZone.objects.values_list("name", "pk"))
    counts = import_zones(
        path=write(path, feature(square(), name="same"), feature(square(9.3), name="moved"), feature(square(9.6), name="new"))
    ).counts
    assert (counts["new"], counts["changed"], counts["unchanged"], counts["removed"]) == (1, 1, 1, 1)
    after = dict(NoFlyZone.objects.values_list("name", "pk"))
    assert set(after) == {"same", "moved", "new"}
    assert (after["same"], after["moved"]) == (keys["same"], keys["moved"])
    assert NoFlyZone.objects.get(name="moved").geometry.extent[0] == 9.3
    assert revision() == 2


def test_a_zone_that_a_curator_changed_survives_the_same_file(tmp_path):
    path = write(tmp_path / "zones.geojson", feature(square(), name="a"))
    import_zones(path=path)
    NoFlyZone.objects.update(name="by hand", is_edited=True)
    import_zones(path=path)
    assert NoFlyZone.objects.get().name == "by hand"


def test_sets_of_other_names_and_drawn_zones_are_left_alone(tmp_path):
    drawn = NoFlyZone.objects.create(identifier="mine", name="drawn", geometry="SRID=4326;MULTIPOLYGON(((0 0,1 0,1 1,0 0)))")
    import_zones(path=write(tmp_path / "one.geojson", feature(square(), name="a")))
    import_zones(path=write(tmp_path / "two.geojson", feature(square(), name="b")))
    assert {zone.name for zone in NoFlyZone.objects.all()} == {"drawn", "a", "b"}
    drawn.refresh_from_db()


def test_a_file_of_the_same_name_from_elsewhere_takes_no_zone_away_unasked(tmp_path):
    (tmp_path / "south").mkdir()
    import_zones(path=write(tmp_path / "zones.geojson", feature(square(), name="north")))
    other = write(tmp_path / "south" / "zones.geojson", feature(square(20.0, -30.0), name="south"))
    with pytest.raises(ZoneFileError, match="--set zones"):
        import_zones(path=other)
    assert (NoFlyZone.objects.get().name, revision()) == ("north", 1)
    import_zones(path=other, set_name="zones")
    assert NoFlyZone.objects.get().name == "south"


def test_one_fault_refuses_the_whole_file_and_its_predecessor_stays(tmp_path):
    path = tmp_path / "zones.geojson"
    import_zones(path=write(path, feature(square(), name="a")))
    before = rows()
    bowtie = {"type": "Polygon", "coordinates": [[[9, 47], [10, 48], [10, 47], [9, 48], [9, 47]]]}
    with pytest.raises(ZoneFileError) as refusal:
        import_zones(path=write(path, feature(square(9.5), name="b"), feature(bowtie, name="c")))
    assert [fault.place for fault in refusal.value.faults] == ["features[1].geometry.coordinates"]
    assert (rows(), revision(), DataImport.objects.count()) == (before, 1, 1)


def postmaster_start():
    with connection.cursor() as cursor:
        cursor.execute("SELECT pg_postmaster_start_time()")
        return cursor.fetchone()[0]


def random_ring(number):
    source = random.Random(7)
    corners = [[9 + source.random(), 47 + source.random()] for _ in range(number)]
    return json.dumps(feature({"type": "Polygon", "coordinates": [[*corners, corners[0]]]}, name="random"))


def round_ring(number):
    corners = [[9 + math.cos(2 * math.pi * k / number), 47 + math.sin(2 * math.pi * k / number)] for k in range(number)]
    return json.dumps(feature({"type": "Polygon", "coordinates": [[*corners, corners[0]]]}, name="round"))


def one(coordinates):
    return f'{{"type": "Feature", "properties": {{"name": "a"}}, "geometry": {{"type": "Polygon", "coordinates": {coordinates}}}}}'


def many(number):
    return json.dumps({"type": "FeatureCollection", "features": [feature(square(k % 100 * 0.3, k // 100 * 0.2)) for k in range(number)]})


HOSTILE = {
    "random ring of 600 points": lambda: random_ring(600),
    "random ring of 2,000 points": lambda: random_ring(2_000),
    "random ring of 9,000 points": lambda: random_ring(9_000),
    "100,000 vertices": lambda: round_ring(100_000),
    "41 MB": lambda: round_ring(1_000_000),
    "20,000 deep": lambda: one("[" * 20_000 + "]" * 20_000),
    "500 deep": lambda: one("[" * 500 + "]" * 500),
    "deep properties": lambda: f'{{"type": "Feature", "properties": {{"a": {"[" * 900 + "]" * 900}}}, "geometry": null}}',
    "NaN": lambda: one("[[[9, 47], [NaN, 47], [10, 48], [9, 47]]]"),
    "1e999": lambda: one("[[[9, 47], [1e999, 47], [10, 48], [9, 47]]]"),
    "unclosed": lambda: one("[[[9, 47], [10, 47], [10, 48], [9, 48]]]"),
    "hole outside": lambda: one("[[[9, 47], [10, 47], [10, 48], [9, 47]], [[19, 47], [20, 47], [20, 48], [19, 47]]]"),
    "zero area": lambda: one("[[[9, 47], [10, 47], [11, 47], [9, 47]]]"),
    "off the earth": lambda: one("[[[500, 95], [501, 95], [501, 96], [500, 95]]]"),
    "empty": lambda: one("[]"),
    "pole inside": lambda: one("[[[0, 80], [90, 80], [180, 80], [-90, 80], [0, 80]]]"),
    "30,000 polygons": lambda: many(30_000),
}  # fmt: skip


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_zone_file_is_refused_before_it_costs_much_and_the_database_lives_on(name, tmp_path):
    path = tmp_path / "hostile.geojson"
    path.write_text(HOSTILE[name]())
    running_since = postmaster_start()
    with no_runaway(), pytest.raises(CommandError, match="refused"):
        call_command("import_zones", str(path))
    assert postmaster_start() == running_since
    assert (NoFlyZone.objects.count(), DataImport.objects.count(), ZoneSet.objects.count()) == (0, 0, 0)


@pytest.mark.long
def test_ten_thousand_polygons_are_taken(tmp_path):
    features = [feature(square(k % 100 * 0.3, k // 100 * 0.2), name=f"zone {k}") for k in range(10_000)]
    assert import_zones(path=write(tmp_path / "many.geojson", *features)).counts["new"] == 10_000
    assert NoFlyZone.objects.count() == 10_000


def test_an_area_over_the_antimeridian_is_stored_on_both_sides(tmp_path):
    geometry = {"type": "Polygon", "coordinates": [[[179, 0], [-179, 0], [-179, 1], [179, 1], [179, 0]]]}
    import_zones(path=write(tmp_path / "date-line.geojson", feature(geometry, name="Date line")))
    inside = [NoFlyZone.objects.filter(geometry__covers=f"SRID=4326;POINT({lon} 0.5)").count() for lon in (179.5, -179.5, 0)]
    assert inside == [1, 1, 0]


@pytest.mark.parametrize(
    ("name", "zones", "circles", "polygons", "with_schedule"),
    [("ed269-features.json", 6, 4, 5, 5), ("switzerland-ed269-test-che-1.json", 6, 4, 6, 4)],
)
def test_the_command_prints_counts_as_json_and_faults_with_their_places(name, zones, circles, polygons, with_schedule, tmp_path, zone_file):
    out = StringIO()
    call_command("import_zones", str(zone_file(name)), "--json", stdout=out)
    counts = json.loads(out.getvalue())
    assert (counts["zones"], counts["circles"], counts["polygons"], counts["with_schedule"]) == (zones, circles, polygons, with_schedule)
    with pytest.raises(CommandError, match=r"features\[0\].geometry.coordinates\[0\]\[0\]: latitude 139.0 is beyond"):
        call_command("import_zones", str(write(tmp_path / "swapped.geojson", feature(square(35.0, 139.0), name="Tokyo"))))
    with pytest.raises(CommandError, match="no file"):
        call_command("import_zones", str(tmp_path / "missing.geojson"))
