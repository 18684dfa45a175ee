"""OSM files as proposals: the difference is what the import then does, edits are kept, and the history has every change."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from inspection.models import Asset, DataImport, Ground
from inspection.services import delete_asset, import_osm, save_asset
from inspection.services.imports.osm import difference_of_osm
from inspection.services.proposals import osm
from inspection.services.proposals.reading import Change, FileRefused, Provenance, Reading
from tests.inspection.imports.osm_files import small_line, write_osm
from workspace.models import AuditEntry, User

pytestmark = pytest.mark.django_db
ORIGIN = Provenance(file_name="a.osm", licence="ODbL 1.0")


def read(path: Path, **parameters: Any) -> Reading:
    return osm.read(path=path, parameters=parameters, provenance=ORIGIN, progress=lambda stage, share: None)


def apply(path: Path, actor: User, **parameters: Any) -> DataImport:
    return osm.apply(path=path, parameters=parameters, provenance=ORIGIN, applied_by=actor, progress=lambda stage, share: None)


def first_and_next(tmp_path: Path) -> tuple[Path, Path]:
    """A line 1-2-3-4 with its supports; in the next file support 1 is gone, 2 has a ref, the line runs 2-3-4."""
    nodes, ways = small_line()
    first = write_osm(tmp_path / "a.osm", nodes, ways)
    nodes, ways = small_line(without={1})
    lon, lat, tags = nodes[2]
    nodes[2] = (lon, lat, tags | {"ref": "two"})
    (tmp_path / "next").mkdir()
    return first, write_osm(tmp_path / "next" / "a.osm", nodes, ways)


def by_action(reading: Reading) -> dict[str, list[Change]]:
    found: dict[str, list[Change]] = {}
    for change in reading.changes:
        found.setdefault(change.action, []).append(change)
    return found


def test_the_difference_is_what_the_import_then_does(tmp_path: Path, curator: User) -> None:
    first, following = first_and_next(tmp_path)
    new = read(first)
    assert (new.numbers["new"], new.numbers["changed"]) == (5, 0)
    assert not Asset.objects.exists()
    apply(first, curator)
    reading = read(following)
    counts = apply(following, curator).counts
    assert {name: counts[name] for name in reading.numbers} == reading.numbers
    assert (reading.numbers["changed"], reading.numbers["vanished"], reading.numbers["new"]) == (2, 1, 0)
    changes = by_action(reading)
    assert changes["vanished"][0].label == "Tower n1"
    tower = next(change for change in changes["changed"] if change.subject == "tower")
    assert (tower.before, tower.after) == (
        {"ref": "", "tags": {"power": "tower"}},
        {"ref": "two", "tags": {"power": "tower", "ref": "two"}},
    )
    assert tower.geometry is not None and tower.geometry.geom_type == "Point"


def test_every_row_that_an_import_changes_is_in_the_history_with_its_author(tmp_path: Path, curator: User) -> None:
    first, following = first_and_next(tmp_path)
    apply(first, curator)
    assert not AuditEntry.objects.exists()  # what is new has its import
    apply(following, curator)
    entries = AuditEntry.objects.order_by("action", "subject_id")
    assert [(entry.action, entry.actor) for entry in entries] == [("changed", curator), ("changed", curator), ("vanished", curator)]
    tower = Asset.objects.get(osm_id=2, kind="tower")
    changed = entries.get(subject_id=str(tower.pk))
    assert (changed.before["ref"], changed.after["ref"], tower.revision) == ("", "two", 2)
    gone = entries.get(action="vanished")
    assert (gone.before["vanished"], gone.after["vanished"]) == (False, True)


def test_an_edited_row_is_kept_and_knows_what_its_source_says_now(tmp_path: Path, curator: User) -> None:
    first, following = first_and_next(tmp_path)
    apply(first, curator)
    tower = Asset.objects.get(osm_id=2, kind="tower")
    tower.ref = "by hand"
    save_asset(asset=tower, actor=curator)
    reading = read(following)
    assert (reading.numbers["kept"], [change.label for change in by_action(reading)["kept"]]) == (1, ["by hand"])
    apply(following, curator)
    tower.refresh_from_db()
    assert (tower.ref, tower.is_edited, tower.source_facts["ref"]) == ("by hand", True, "two")
    assert read(following).numbers["kept"] == 0  # it says nothing new


def test_edits_are_replaced_where_somebody_says_so(tmp_path: Path, curator: User) -> None:
    first, following = first_and_next(tmp_path)
    apply(first, curator)
    tower = Asset.objects.get(osm_id=2, kind="tower")
    tower.ref = "by hand"
    save_asset(asset=tower, actor=curator)
    delete_asset(asset=Asset.objects.get(osm_id=3, kind="tower"), actor=curator)
    assert read(following, replace_edited=True).numbers["changed"] == 3
    apply(following, curator, replace_edited=True)
    tower.refresh_from_db()
    assert (tower.ref, tower.is_edited, tower.source_facts) == ("two", False, None)
    assert Asset.objects.get(osm_id=3, kind="tower").vanished_at is None


def test_a_region_is_replaced_whichever_file_its_assets_came_from(tmp_path: Path, curator: User) -> None:
    nodes, ways = small_line()
    apply(write_osm(tmp_path / "a.osm", nodes, ways), curator)
    far = {number: (lon + 5.0, lat, tags) for number, (lon, lat, tags) in nodes.items()}
    far |= {100 + number: (lon + (number - 2) * 1e-4, lat, {"power": "tower"}) for number, (lon, lat, _) in nodes.items()}
    wide = write_osm(
        tmp_path / "wide.osm", {number: node for number, node in far.items() if number > 100} | {200: (14.0, 47.0, {"power": "tower"})}, {}
    )
    assert read(wide).numbers["vanished"] == 0
    assert read(wide, replace_region=True).numbers["vanished"] > 0


def test_a_damaged_file_is_refused_and_changes_nothing(tmp_path: Path, curator: User) -> None:
    (tmp_path / "a.osm").write_text("<osm><node id='1'")
    with pytest.raises(FileRefused):
        read(tmp_path / "a.osm")
    with pytest.raises(FileRefused):
        apply(tmp_path / "a.osm", curator)
    assert not DataImport.objects.exists()
    assert not Ground.objects.exists()


@pytest.mark.parametrize(("name", "assets"), [("quillmoor.osm.pbf", 588), ("liechtenstein-2021-infra.osm.pbf", 400)])
def test_a_look_at_a_region_leaves_nothing_behind(name: str, assets: int, region_file: Callable[[str], Path]) -> None:
    file = region_file(name)
    found = difference_of_osm(path=file, most=10)
    assert (found.numbers["new"] >= assets, len(found.samples["new"])) == (True, 10)
    assert not Asset.objects.exists()
    import_osm(path=file)
    again = difference_of_osm(path=file)
    assert {name: number for name, number in again.numbers.items() if number} == {"unchanged": found.numbers["new"]}
