"""A review of an import: numbers by kind, changes that are left out, what a replaced region removes, undoing, and wrong files."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from django.test import Client

from inspection.models import Asset, ChangeAction, ImportProposal, NoFlyZone, ProposalState
from inspection.services import save_asset
from inspection.services.imports.uploads import store_upload
from inspection.services.proposals import osm, undo
from inspection.services.proposals.reading import FileRefused, Provenance, Reading
from tests.accounts.users import a_user, client_of
from tests.inspection.imports.osm_files import small_line, write_osm
from tests.inspection.imports.test_imports_api import apply as applied
from tests.inspection.imports.test_imports_api import propose, read, square, zone_file
from tests.inspection.imports.test_osm_proposals import apply, by_action, first_and_next
from tests.inspection.imports.test_osm_proposals import read as read_osm
from workspace.models import AuditEntry, Role, User

pytestmark = pytest.mark.django_db


@pytest.fixture
def sent(client: Client) -> Callable[..., dict[str, Any]]:
    """Sends a file of a kind, and has it read."""

    def send(kind: str, content: bytes, name: str = "file.geojson") -> dict[str, Any]:
        upload = store_upload(file_name=name, chunks=[content], created_by=None)
        answer = client.post("/api/v1/imports", {"kind": kind, "upload": str(upload.pk)}, content_type="application/json")
        assert answer.status_code == 202, answer.content
        return read(client, answer.json())

    return send


def facts_of_all() -> list[tuple[Any, ...]]:
    names = ("pk", "ref", "tags", "content_hash", "data_import", "max_voltage_v", "node_osm_ids", "is_edited")
    rows = Asset.objects.filter(vanished_at=None).order_by("pk")
    return [(*(getattr(row, name) for name in names), round(row.length_m or 0, 3), row.geometry.wkt, row.centre.wkt) for row in rows]


def keys(reading: Reading, action: ChangeAction) -> list[str]:
    return [change.key for change in by_action(reading)[action]]


def test_a_difference_has_its_numbers_by_kind(tmp_path: Path, curator: User) -> None:
    first, following = first_and_next(tmp_path)
    assert read_osm(first).summary["by_kind"]["tower"]["new"] == 4
    apply(first, curator)
    by_kind = read_osm(following).summary["by_kind"]
    assert by_kind["tower"] == {"new": 0, "changed": 1, "vanished": 1, "kept": 0, "unchanged": 2}
    assert by_kind["line"] == {"new": 0, "changed": 1, "vanished": 0, "kept": 0, "unchanged": 0}


def test_changes_that_are_left_out_are_not_written_and_come_again(tmp_path: Path, curator: User) -> None:
    first, following = first_and_next(tmp_path)
    every = read_osm(first)
    out = [key for key in keys(every, ChangeAction.NEW) if "n4" in key]
    apply(first, curator, excluded=out)
    assert sorted(Asset.objects.filter(kind="tower").values_list("osm_id", flat=True)) == [1, 2, 3]
    assert keys(read_osm(first), ChangeAction.NEW) == out
    reading = read_osm(following)
    out = [*keys(reading, ChangeAction.VANISHED), *(change.key for change in by_action(reading)["changed"] if change.subject == "tower")]
    counts = apply(following, curator, excluded=out).counts
    assert (counts["changed"], counts["vanished"]) == (1, 0)
    assert Asset.objects.get(kind="tower", osm_id=2).ref == ""
    assert Asset.objects.get(kind="tower", osm_id=1).vanished_at is None


@pytest.mark.parametrize("excluded", ["", {"a": 1}, [1, None], ["no such key"]])
def test_what_names_no_change_leaves_nothing_out(tmp_path: Path, curator: User, excluded: Any) -> None:
    first, _ = first_and_next(tmp_path)
    assert apply(first, curator, excluded=excluded).counts["new"] == 5


def test_zones_are_left_out_one_by_one(client: Client) -> None:
    proposal = read(client, propose(client, zone_file(("North", 8.0), ("South", 9.0))))
    assert proposal["summary"]["by_kind"] == {"zone": proposal["difference"]}
    features = client.get(f"/api/v1/imports/{proposal['id']}/changes").json()["features"]
    (north,) = [feature["properties"]["key"] for feature in features if feature["properties"]["label"] == "North"]
    applied(client, proposal, excluded=[north])
    assert list(NoFlyZone.objects.values_list("name", flat=True)) == ["South"]


def test_a_replaced_region_says_what_it_removes_before_it_is_read_for_that(tmp_path: Path, curator: User) -> None:
    nodes, ways = small_line()
    apply(write_osm(tmp_path / "a.osm", nodes, ways), curator)
    wide = {100 + number: (lon + (number - 2) * 1e-4, lat, {"power": "tower"}) for number, (lon, lat, _) in nodes.items()}
    file = write_osm(tmp_path / "wide.osm", wide | {200: (14.0, 47.0, {"power": "tower"})}, {})
    before = read_osm(file)
    after = read_osm(file, replace_region=True)
    removed = before.summary["replaced_region_removes"]
    assert sum(removed.values()) == after.numbers["vanished"] - before.numbers["vanished"] > 0
    assert removed == {kind: counts["vanished"] for kind, counts in after.summary["by_kind"].items() if counts["vanished"]}


def test_an_undone_import_leaves_the_assets_as_they_were_before_it(tmp_path: Path, curator: User) -> None:
    first, following = first_and_next(tmp_path)
    apply(first, curator)
    before = facts_of_all()
    data_import = apply(following, curator)
    assert facts_of_all() != before
    reading = undo.read_undo({"undo": data_import.pk})
    assert {action: reading.numbers[action] for action in ("new", "changed", "vanished", "kept")} == {
        "new": 1, "changed": 2, "vanished": 0, "kept": 0,
    }  # fmt: skip
    osm.apply(path=None, parameters={"undo": data_import.pk}, provenance=Provenance("a"), applied_by=curator, progress=lambda *_: None)
    assert facts_of_all() == before
    assert AuditEntry.objects.filter(action="undone import", actor=curator).count() == 3
    assert by_action(undo.read_undo({"undo": data_import.pk})).keys() <= {"kept"}
    assert read_osm(following).numbers["changed"] == 2  # the file can be applied again


def test_undoing_the_first_import_of_a_region_removes_what_it_brought(tmp_path: Path, curator: User) -> None:
    first, _ = first_and_next(tmp_path)
    data_import = apply(first, curator)
    assert undo.read_undo({"undo": data_import.pk}).numbers["vanished"] == 5
    undo.apply_undo({"undo": data_import.pk}, curator)
    assert not Asset.objects.filter(vanished_at=None).exists()
    assert Asset.objects.count() == 5  # targets of missions may name them
    assert apply(first, curator).counts["changed"] == 5
    assert Asset.objects.filter(vanished_at=None).count() == 5


def test_an_import_of_an_earlier_version_is_not_undone(tmp_path: Path, curator: User) -> None:
    first, following = first_and_next(tmp_path)
    apply(first, curator)
    data_import = apply(following, curator)
    for entry in AuditEntry.objects.filter(action="changed"):
        AuditEntry.objects.filter(pk=entry.pk).update(after={k: v for k, v in entry.after.items() if k != "data_import_id"})
    before = facts_of_all()
    with pytest.raises(FileRefused):
        undo.apply_undo({"undo": data_import.pk}, curator)
    assert facts_of_all() == before


def test_what_was_edited_since_stays_when_its_import_is_undone(tmp_path: Path, curator: User) -> None:
    first, following = first_and_next(tmp_path)
    apply(first, curator)
    data_import = apply(following, curator)
    tower = Asset.objects.get(kind="tower", osm_id=2)
    tower.ref = "by hand"
    save_asset(asset=tower, actor=curator)
    assert undo.read_undo({"undo": data_import.pk}).numbers["kept"] == 1
    undo.apply_undo({"undo": data_import.pk}, curator)
    tower.refresh_from_db()
    assert (tower.ref, tower.is_edited) == ("by hand", True)


def test_only_an_applied_import_of_assets_is_undone(client: Client, curator: User) -> None:
    proposal = read(client, propose(client, zone_file(("North", 8.0))))
    applied(client, proposal)
    answer = client.post(f"/api/v1/imports/{proposal['id']}/undo", {}, content_type="application/json")
    assert (answer.status_code, answer.json()["error"]["code"]) == (409, "not_undoable")
    assert client_of(a_user(Role.OPERATOR)).post(f"/api/v1/imports/{proposal['id']}/undo").status_code == 403


WRONG: list[tuple[str, bytes, str]] = [
    ("zones", b"\x89PNG\r\n\x1a\n" + bytes(40), "This is a PNG file, which holds none of the data that Spanwise reads."),
    ("assets", b"\x89PNG\r\n\x1a\n" + bytes(40), "This is a PNG file, which holds none of the data that Spanwise reads."),
    ("osm", b"%PDF-1.7" + bytes(40), "This is a PDF file, which holds none of the data that Spanwise reads."),
    ("terrain", b"\xff\xd8\xff\xe0" + bytes(40), "This is a JPEG file, which holds none of the data that Spanwise reads."),
    ("assets", b'{"type": "FeatureCollection", "features": []}', "The file has no records: it is an empty collection."),
    ("zones", b'{"type": "FeatureCollection", "features": []}', "the file has no zones"),
]


@pytest.mark.parametrize(("kind", "content", "words"), WRONG)
def test_a_wrong_file_gets_one_sentence(client: Client, sent: Callable[..., dict[str, Any]], kind: str, content: bytes, words: str) -> None:
    proposal = sent(kind, content)
    assert proposal["state"] == ProposalState.REFUSED
    assert [(fault["place"], fault["message"]) for fault in proposal["faults"]] == [("", words)]
    assert "can_leave_out" not in proposal["summary"]


def test_a_refused_file_is_read_without_faulty_records_only_where_the_faults_are_theirs(
    client: Client, sent: Callable[..., dict[str, Any]]
) -> None:
    assert sent("assets", b"<OGRVRTDataSource></OGRVRTDataSource>", name="a.vrt")["summary"] == {}
    good, bad = square(8.0), square(9.0)
    bad["coordinates"][0][1] = [200.0, 99.0]
    features = [{"type": "Feature", "properties": {"name": "a"}, "geometry": geometry} for geometry in (good, bad)]
    refused = sent("zones", json.dumps({"type": "FeatureCollection", "features": features}).encode())
    assert (refused["state"], refused["summary"]) == ("refused", {"can_leave_out": True})
    assert ImportProposal.objects.filter(state=ProposalState.REFUSED).count() == 2
