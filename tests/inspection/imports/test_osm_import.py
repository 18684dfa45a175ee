"""Importing OpenStreetMap files into assets."""

import json
from io import StringIO

import pytest
from django.core.management import call_command
from django.core.management.base import CommandError

from inspection.importers.osm.file_validator import OsmFileError
from inspection.importers.osm.reader import read_osm
from inspection.models import Asset, DataImport, Ground
from inspection.services import import_osm
from tests.cases import long
from tests.inspection.imports.osm_files import TOWER, small_line, write_osm

pytestmark = pytest.mark.django_db


def revision():
    return Ground.objects.filter(pk=1).values_list("revision", flat=True).first() or 0


def rows():
    return list(Asset.objects.order_by("pk").values())


def present():
    return set(Asset.objects.filter(vanished_at=None).values_list("osm_type", "osm_id"))


@pytest.mark.parametrize(
    "name",
    [
        "elme-valley.osm.pbf", "quillmoor.osm.pbf", "columbus-ohio.osm.pbf",
        *long("liechtenstein-2021.osm.pbf", "nepal-power-2025.osm.pbf", "copenhagen-rail-2015.osm.gz"),
    ],
)  # fmt: skip
def test_the_same_file_again_changes_nothing(name, region_file):
    path = region_file(name)
    first = import_osm(path=path)
    before, at_revision = rows(), revision()
    second = import_osm(path=path)
    assert first.counts["new"] == len(before) > 0
    assert second.counts["unchanged"] == len(before)
    assert (second.counts["new"], second.counts["changed"], second.counts["vanished"]) == (0, 0, 0)
    assert rows() == before
    assert revision() == at_revision == 1
    assert (second.pk, DataImport.objects.count()) == (first.pk, 1)


@pytest.mark.parametrize("name", ["quillmoor.osm.pbf", *long("columbus-ohio.osm.pbf")])
def test_rows_hold_what_the_records_say(name, region_file):
    path = region_file(name)
    import_osm(path=path)
    stored = {(row.kind, row.osm_type, row.osm_id): row for row in Asset.objects.all()}
    records = read_osm(path).records
    assert len(stored) == len(records)
    for record in records:
        row = stored[record.key]
        assert bytes(row.geometry.wkb) == record.geometry.wkb
        assert row.geometry.srid == 4326
        assert row.centre.coords == tuple(record.centre)
        assert (row.tags, row.node_osm_ids, row.is_flyable) == (record.tags, list(record.node_osm_ids), record.is_flyable)
        assert (row.voltages_v, row.circuits, row.height_m) == (list(record.voltages_v), record.circuits, record.height_m)
        assert row.max_voltage_v == max(record.voltages_v, default=None)


def test_the_import_says_where_the_data_comes_from(tmp_path):
    nodes, ways = small_line()
    path = write_osm(tmp_path / "a.osm", nodes, ways)
    real, made = import_osm(path=path), import_osm(path=path, is_synthetic=True)
    assert "OpenStreetMap" in real.attribution
    assert not real.is_synthetic
    assert "Synthetic" in made.attribution
    assert made.is_synthetic


def test_a_newer_file_updates_adds_and_marks_what_vanished(tmp_path):
    nodes, ways = small_line()
    import_osm(path=write_osm(tmp_path / "old.osm", nodes, ways))
    keys = dict(Asset.objects.values_list("osm_id", "pk"))
    nodes, ways = small_line(without={4})
    nodes[1] = (nodes[1][0], 47.0, {**TOWER, "height": "30"})
    nodes[9] = (9.02, 47.001, TOWER)
    counts = import_osm(path=write_osm(tmp_path / "new.osm", nodes, ways)).counts
    assert (counts["new"], counts["changed"], counts["unchanged"], counts["vanished"]) == (1, 2, 2, 1)
    assert present() == {("n", 1), ("n", 2), ("n", 3), ("n", 9), ("w", 10)}
    assert Asset.objects.get(osm_type="n", osm_id=1).height_m == 30.0
    assert Asset.objects.get(osm_id=10).node_osm_ids == [1, 2, 3]
    assert keys.items() <= dict(Asset.objects.values_list("osm_id", "pk")).items()
    assert revision() == 2


def test_what_vanished_and_comes_back_is_there_again(tmp_path):
    full = write_osm(tmp_path / "full.osm", *small_line())
    import_osm(path=full)
    import_osm(path=write_osm(tmp_path / "less.osm", *small_line(without={4})))
    assert ("n", 4) not in present()
    assert import_osm(path=full).counts["changed"] == 2
    assert ("n", 4) in present()


def test_a_row_that_a_curator_edited_stays_as_it_is(tmp_path):
    import_osm(path=write_osm(tmp_path / "old.osm", *small_line()))
    Asset.objects.filter(osm_type="n", osm_id__in=[1, 4]).update(name="by hand", is_edited=True)
    nodes, ways = small_line(without={4})
    nodes[1] = (9.1, 47.2, TOWER)
    counts = import_osm(path=write_osm(tmp_path / "new.osm", nodes, ways)).counts
    assert counts["kept_edited"] == 1
    moved, gone = Asset.objects.get(osm_type="n", osm_id=1), Asset.objects.get(osm_type="n", osm_id=4)
    assert (moved.name, moved.geometry.coords, moved.vanished_at) == ("by hand", (9.004, 47.0), None)
    assert (gone.name, gone.vanished_at) == ("by hand", None)


def test_a_drawn_asset_never_vanishes(tmp_path):
    import_osm(path=write_osm(tmp_path / "old.osm", *small_line()))
    drawn = Asset.objects.create(kind="tower", geometry="SRID=4326;POINT(9.005 47)", centre="SRID=4326;POINT(9.005 47)")
    import_osm(path=write_osm(tmp_path / "new.osm", *small_line(without={4})))
    drawn.refresh_from_db()
    assert drawn.vanished_at is None


@pytest.mark.parametrize(
    "names",
    [
        pytest.param(["elme-valley.osm.pbf", "quillmoor.osm.pbf"], id="generated"),
        *long(["roenne-bornholm-2015.osm.gz", "copenhagen-rail-2015.osm.gz", "funen-power-nodes-2019.osm.pbf"]),
    ],
)
def test_files_of_several_regions_do_not_mark_each_other(names, region_file):
    for name in names + names:
        import_osm(path=region_file(name))
    assert not Asset.objects.exclude(vanished_at=None).exists()


def test_neighbours_that_overlap_a_little_do_not_mark_each_other(tmp_path):
    west = {number: (9.0 + 0.1 * number, 47.0, TOWER) for number in range(1, 6)}
    east = {number: (9.0 + 0.1 * number, 47.0, TOWER) for number in range(5, 11)}
    import_osm(path=write_osm(tmp_path / "west.osm", west))
    import_osm(path=write_osm(tmp_path / "east.osm", east))
    assert len(present()) == 10


def test_a_file_filtered_to_power_lines_takes_no_bridge_away(tmp_path):
    nodes, ways = small_line()
    bridges = {20 + number: ([1, 2], {"highway": "primary", "bridge": "yes"}) for number in range(11)}
    import_osm(path=write_osm(tmp_path / "all.osm", nodes, ways | bridges))
    assert import_osm(path=write_osm(tmp_path / "power.osm", nodes, ways)).counts["vanished"] == 0


def test_a_file_cut_smaller_marks_only_inside_its_stated_box(tmp_path):
    nodes, ways = small_line()
    import_osm(path=write_osm(tmp_path / "old.osm", nodes, ways))
    box = '<bounds minlon="9.0" minlat="46.99" maxlon="9.014" maxlat="47.01"/>'
    import_osm(path=write_osm(tmp_path / "cut.osm", {1: nodes[1], 2: nodes[2]}, {10: ([1, 2, 3], ways[10][1])}, bounds=box))
    assert present() == {("n", 1), ("n", 2), ("n", 4), ("w", 10)}  # 3 was inside the box and is gone, 4 lies outside


def test_a_file_with_older_data_changes_nothing_that_newer_data_wrote(tmp_path):
    def answer(name, timestamp, nodes):
        elements = [{"type": "node", "id": key, "lon": lon, "lat": lat, "tags": tags} for key, (lon, lat, tags) in nodes.items()]
        path = tmp_path / name
        path.write_text(json.dumps({"osm3s": {"timestamp_osm_base": timestamp}, "elements": elements}))
        return path

    nodes, _ = small_line()
    import_osm(path=answer("new.json", "2026-05-01T00:00:00Z", {**nodes, 1: (9.004, 47.0, {**TOWER, "ref": "new"})}))
    old = {key: value for key, value in nodes.items() if key != 4} | {1: (9.004, 47.0, {**TOWER, "ref": "old"})}
    counts = import_osm(path=answer("old.json", "2020-05-01T00:00:00Z", old)).counts
    assert (counts["kept_newer"], counts["changed"], counts["vanished"]) == (3, 0, 0)
    assert Asset.objects.get(osm_id=1).ref == "new"


def test_a_file_without_infrastructure_is_refused(tmp_path):
    with pytest.raises(OsmFileError, match="no power lines"):
        import_osm(path=write_osm(tmp_path / "a.osm", {1: (9.0, 47.0, {"amenity": "bench"})}))
    assert (DataImport.objects.count(), revision()) == (0, 0)


def test_tags_that_the_database_cannot_hold_are_cut_or_cleaned(tmp_path):
    path = tmp_path / "a.json"
    tags = {"power": "tower", "ref": "r" * 400, "note": "a\0b"}
    path.write_text(json.dumps({"elements": [{"type": "node", "id": 1, "lon": 9, "lat": 47, "tags": tags}]}))
    import_osm(path=path)
    tower = Asset.objects.get()
    assert len(tower.ref) == 255
    assert len(tower.tags["ref"]) == 400


def test_the_command_prints_the_counts_as_json(tmp_path):
    out = StringIO()
    call_command("import_osm", str(write_osm(tmp_path / "a.osm", *small_line())), "--json", stdout=out)
    counts = json.loads(out.getvalue())
    assert (counts["tower"], counts["line"], counts["new"], counts["skipped"]) == (4, 1, 5, {})
    assert counts["line_km"] == pytest.approx(0.913, abs=0.001)


def test_the_command_tells_people_what_was_read(tmp_path):
    out = StringIO()
    call_command("import_osm", str(write_osm(tmp_path / "a.osm", *small_line())), stdout=out)
    assert "4 supports, 1 lines" in out.getvalue()
    assert "5 new" in out.getvalue()


def test_the_command_refuses_a_bad_file_and_leaves_the_database_alone(tmp_path):
    path = tmp_path / "bad.osm.pbf"
    path.write_bytes(b"\0\0\0\x0d" + b"A" * 1_000)
    with pytest.raises(CommandError, match="PBF"):
        call_command("import_osm", str(path))
    with pytest.raises(CommandError, match="no file"):
        call_command("import_osm", str(tmp_path / "missing.osm"))
    assert (DataImport.objects.count(), Asset.objects.count()) == (0, 0)
