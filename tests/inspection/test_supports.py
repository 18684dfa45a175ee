"""Which line a support carries, and which place it has there."""

import pytest
from django.db import connection
from django.utils import timezone

from inspection.models import Asset, AssetKind, Ground
from inspection.services import delete_asset, import_osm, save_asset
from inspection.services.ground import number_supports
from tests.accounts.users import a_user
from tests.inspection.ground import line, tower
from tests.inspection.imports.osm_files import small_line, write_osm
from workspace.models import Role

pytestmark = pytest.mark.django_db


def places():
    """OSM id of a support → OSM id of its line, place, number of places."""
    supports = Asset.objects.filter(kind=AssetKind.TOWER).order_by("osm_id")
    return {row.osm_id: row.line and (row.line.osm_id, row.place_on_line, row.places_on_line) for row in supports.select_related("line")}


def supports(*osm_ids, **facts):
    return [tower((10.0 + osm_id / 1000, 56.0), osm_id=osm_id, **facts) for osm_id in osm_ids]


def test_an_import_numbers_supports_in_the_direction_of_their_line(tmp_path):
    """4 -- 3 -- 5 (no support) -- 1, and 2 alone."""
    nodes, _ = small_line()
    nodes[5] = (9.02, 47.0, {})
    import_osm(path=write_osm(tmp_path / "a.osm", nodes, {10: ([4, 3, 5, 1], {"power": "line"})}))
    assert places() == {4: (10, 1, 3), 3: (10, 2, 3), 1: (10, 3, 3), 2: None}


def test_of_several_lines_the_highest_voltage_counts_then_the_first():
    supports(1, 2)
    for osm_id, voltages_v in [(20, []), (21, [110_000]), (22, [380_000, 110_000]), (23, [380_000])]:
        line(osm_id=osm_id, voltages_v=voltages_v, node_osm_ids=[2, 1])
    line(osm_id=24, node_osm_ids=[9, 2])
    number_supports()
    assert places() == {2: (22, 1, 2), 1: (22, 2, 2)}


def test_only_lines_and_supports_in_use_count():
    supports(1, 3)
    supports(2, vanished_at=timezone.now())
    line(osm_id=20, voltages_v=[380_000], node_osm_ids=[1, 3], is_flyable=False)
    line(osm_id=21, voltages_v=[220_000], node_osm_ids=[1, 3], vanished_at=timezone.now())
    line(osm_id=22, node_osm_ids=[1, 2, 3])
    number_supports()
    assert places() == {1: (22, 1, 2), 2: None, 3: (22, 2, 2)}


def test_a_ring_counts_the_support_where_it_closes_once():
    supports(1, 2, 3)
    line(osm_id=20, node_osm_ids=[1, 2, 3, 1])
    number_supports()
    assert places() == {1: (20, 1, 3), 2: (20, 2, 3), 3: (20, 3, 3)}


def test_only_rows_that_differ_are_written_and_none_counts_as_changed(tmp_path):
    path = write_osm(tmp_path / "a.osm", *small_line())
    import_osm(path=path)
    before, revision = list(Asset.objects.order_by("pk").values()), Ground.objects.get().revision
    Asset.objects.filter(osm_id=2).update(place_on_line=7)
    assert number_supports() == 1
    assert number_supports() == 0
    with connection.cursor() as cursor:
        cursor.execute("SELECT id, xmin::text FROM inspection_asset ORDER BY id")
        versions = cursor.fetchall()
        import_osm(path=path)
        cursor.execute("SELECT id, xmin::text FROM inspection_asset ORDER BY id")
        assert cursor.fetchall() == versions
    assert list(Asset.objects.order_by("pk").values()) == before
    assert Ground.objects.get().revision == revision


def test_a_file_imported_before_supports_were_numbered_numbers_them_now(tmp_path):
    path = write_osm(tmp_path / "a.osm", *small_line())
    import_osm(path=path)
    Asset.objects.update(line=None, place_on_line=None, places_on_line=None)
    revision = Ground.objects.get().revision
    import_osm(path=path)
    assert places() == {number: (10, number, 4) for number in range(1, 5)}
    assert Ground.objects.get().revision == revision + 1  # so that the tiles are asked for again


def test_a_newer_file_numbers_again_and_what_vanished_keeps_its_place(tmp_path):
    import_osm(path=write_osm(tmp_path / "old.osm", *small_line()))
    Asset.objects.filter(osm_id=3).update(name="by hand", is_edited=True)
    import_osm(path=write_osm(tmp_path / "new.osm", *small_line(without={1})))
    assert places() == {1: (10, 1, 4), 2: (10, 1, 3), 3: (10, 2, 3), 4: (10, 3, 3)}
    assert Asset.objects.get(osm_id=3).name == "by hand"


def test_a_curators_change_of_a_line_or_support_numbers_again():
    curator = a_user(Role.CURATOR)
    [first, *_] = supports(1, 2, 3)
    high = line((10.001, 56.0), (10.003, 56.0), osm_id=20, voltages_v=[380_000], node_osm_ids=[1, 3])
    low = line((10.001, 56.0), (10.002, 56.0), (10.003, 56.0), osm_id=21, voltages_v=[110_000], node_osm_ids=[1, 2, 3])
    number_supports()
    assert places() == {1: (20, 1, 2), 2: (21, 2, 3), 3: (20, 2, 2)}
    low.voltages_v = [400_000]
    save_asset(asset=low, actor=curator)
    assert places() == {1: (21, 1, 3), 2: (21, 2, 3), 3: (21, 3, 3)}
    delete_asset(asset=low, actor=curator)
    assert not Asset.objects.filter(pk=low.pk, vanished_at=None).exists()  # supports that name it do not hold it
    assert places() == {1: (20, 1, 2), 2: None, 3: (20, 2, 2)}
    delete_asset(asset=first, actor=curator)
    assert places() == {1: (20, 1, 2), 2: None, 3: (20, 1, 1)}  # the one that was taken away is still called what it was
    high.is_flyable = False
    save_asset(asset=high, actor=curator)
    assert places() == {1: (20, 1, 2), 2: None, 3: None}


@pytest.mark.parametrize(
    ("name", "supports"),
    [("elme-valley.osm.pbf", 3_065), ("quillmoor.osm.pbf", 457), pytest.param("columbus-ohio.osm.pbf", 500, marks=pytest.mark.long)],
)
def test_supports_have_a_place_on_a_line_that_runs_over_them(name, supports, region_file):
    import_osm(path=region_file(name))
    on_lines = Asset.objects.filter(line__isnull=False).select_related("line")
    assert len(on_lines) >= supports
    by_line = {}
    for row in on_lines:
        assert row.osm_id in row.line.node_osm_ids
        by_line.setdefault(row.line, []).append(row)
    for of, rows in by_line.items():
        in_order = sorted(rows, key=lambda row: row.place_on_line)
        assert [of.node_osm_ids.index(row.osm_id) for row in in_order] == sorted(of.node_osm_ids.index(row.osm_id) for row in rows)
        assert all(1 <= row.place_on_line <= row.places_on_line == rows[0].places_on_line for row in rows)


def test_a_drawn_support_counts_at_the_vertex_where_it_stands():
    """1 -- (drawn) -- 2, and a drawn one 20 m off the line's vertex that is none of its supports."""
    supports(1, 2)
    line((10.001, 56.0), (10.0015, 56.0), (10.002, 56.0), osm_id=20, node_osm_ids=[1, 5, 2])
    drawn = tower((10.0015, 56.0000001), osm_id=None, osm_type="")
    beside = tower((10.0015, 56.00018), osm_id=None, osm_type="")
    number_supports()
    assert places()[2] == (20, 3, 3)
    drawn.refresh_from_db()
    beside.refresh_from_db()
    assert (drawn.line.osm_id, drawn.place_on_line, beside.line) == (20, 2, None)


def test_a_drawn_line_carries_the_supports_at_its_vertices():
    supports(1, 2)
    line((10.001, 56.0), (10.0015, 56.0), (10.002, 56.0), osm_id=None, osm_type="")
    number_supports()
    assert {row.osm_id: (row.place_on_line, row.places_on_line) for row in Asset.objects.filter(kind=AssetKind.TOWER)} == {
        1: (1, 2),
        2: (2, 2),
    }
