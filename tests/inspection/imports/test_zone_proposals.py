"""Zone files as proposals: what they state is kept, what was said of them is checked, and two curators at once lose nothing."""

import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from django.db import connection, connections, transaction

from inspection.models import ImportProposal, NoFlyZone, ZoneSet
from inspection.services import import_zones, save_zone
from inspection.services.imports.uploads import store_upload
from inspection.services.proposals import pipeline
from inspection.services.proposals.reading import FileRefused, Provenance
from inspection.services.proposals.zones import apply, read
from inspection.tasks import apply_proposal, read_proposal
from tests.accounts.users import a_user
from tests.inspection.imports.zone_sets import zone_file
from workspace.models import AuditEntry, Role, User

pytestmark = pytest.mark.django_db


def written(folder: Path, *zones: tuple[str, float], south: float = 47.0) -> Path:
    path = folder / "Works.geojson"
    path.write_bytes(zone_file(*zones, south=south))
    return path


def look(path: Path, **parameters: Any) -> Any:
    return read(path=path, parameters=parameters, provenance=Provenance(path.name), progress=lambda stage, share: None)


def make_so(path: Path, **parameters: Any) -> Any:
    with transaction.atomic():
        return apply(
            path=path, parameters=parameters, provenance=Provenance(path.name), applied_by=None, progress=lambda stage, share: None
        )


@pytest.mark.parametrize(
    ("name", "source_format", "layers"),
    [
        ("ed269-features.json", "ed269", 9),
        ("ed269-zone-list.json", "ed269", 4),
        ("ed318-collection.json", "ed318", 3),
        ("enaire.json", "ed318", 2),
        ("openair.txt", "openair", 7),
        ("switzerland-ed269-test-che-1.json", "ed269", 10),
        ("bulgaria-2026-ed269-extract.json", "ed269", 11),
        ("ed318-Example_Collection.json", "ed318", 3),
        ("czechia-2026-openair.txt", "openair", 270),
    ],
)
def test_files_say_after_the_import_what_they_said_before(
    name: str, source_format: str, layers: int, zone_file: Callable[[str], Path]
) -> None:
    path = zone_file(name)
    assert look(path, format=source_format).numbers["new"] == layers
    make_so(path, format=source_format)
    again = look(path, format=source_format)
    assert (again.numbers["unchanged"], sum(again.numbers.values()), again.changes) == (layers, layers, ())
    version = ZoneSet.objects.get().versions.get()
    rolled = read(path=None, parameters={"set": version.zone_set_id, "version": 1}, provenance=Provenance(""), progress=lambda *_: None)
    assert (rolled.numbers["unchanged"], sum(rolled.numbers.values())) == (layers, layers)


@pytest.mark.parametrize(
    ("name", "valid_from"),
    [("ed318-collection.json", "2026-01-01T06:00:00+00:00"), ("ed318-Example_Collection.json", "2018-12-31T15:59:59+00:00")],
)
def test_the_validity_that_a_file_states_is_kept(name: str, valid_from: str, zone_file: Callable[[str], Path]) -> None:
    make_so(zone_file(name))
    source = ZoneSet.objects.select_related("data_import").get().data_import
    assert source is not None
    assert (source.valid_from.isoformat(), source.valid_until) == (valid_from, None)


@pytest.mark.parametrize(("stated", "words"), [("openair", "GeoJSON, not OpenAir"), ("shapefile", "known formats"), (7, "known formats")])
def test_a_file_of_another_format_than_was_said_is_refused(stated: Any, words: str, tmp_path: Path) -> None:
    with pytest.raises(FileRefused, match=words):
        look(written(tmp_path, ("A", 9.0)), format=stated)


def test_a_set_from_elsewhere_is_replaced_only_when_that_is_said(tmp_path: Path) -> None:
    import_zones(path=written(tmp_path, ("North", 9.0)))
    south = written(tmp_path, ("South", 20.0), south=-30.0)
    with pytest.raises(FileRefused, match="all of them elsewhere"):
        look(south)
    with pytest.raises(FileRefused, match="all of them elsewhere"):
        make_so(south)
    assert NoFlyZone.objects.get().name == "North"
    assert look(south, replace_all=True).numbers["vanished"] == 1
    assert look(south, set_name="South").numbers["new"] == 1
    make_so(south, replace_all=True)
    assert NoFlyZone.objects.get().name == "South"


@pytest.mark.parametrize("name", ["", "  ", 7, ["Works"]])
def test_the_name_of_a_set_is_a_text(name: Any, tmp_path: Path) -> None:
    with pytest.raises(FileRefused, match="name of the set"):
        look(written(tmp_path, ("A", 9.0)), set_name=name)


@pytest.mark.parametrize("parameters", [{}, {"set": "x", "version": 1}, {"set": [1], "version": 1}, {"set": 1, "version": 2**40}])
def test_a_roll_back_to_nowhere_is_refused(parameters: dict[str, Any]) -> None:
    with pytest.raises(FileRefused, match="no such version"):
        read(path=None, parameters=parameters, provenance=Provenance(""), progress=lambda *_: None)


def test_an_edited_zone_is_reported_as_kept_only_while_the_source_differs(tmp_path: Path) -> None:
    import_zones(path=written(tmp_path, ("A", 9.0)))
    NoFlyZone.objects.update(name="Mine", is_edited=True)
    assert look(written(tmp_path, ("A", 9.0))).numbers["kept"] == 1
    NoFlyZone.objects.update(name="A")
    make_so(written(tmp_path, ("A", 9.0), ("B", 9.3)))
    assert list(NoFlyZone.objects.order_by("name").values_list("name", "is_edited")) == [("A", False), ("B", False)]


def test_an_edited_zone_that_the_source_no_longer_has_is_kept_and_said(tmp_path: Path) -> None:
    import_zones(path=written(tmp_path, ("A", 9.0), ("B", 9.2)))
    NoFlyZone.objects.filter(name="A").update(reason="Checked", is_edited=True)
    reading = look(written(tmp_path, ("B", 9.2)))
    [kept] = reading.changes
    assert (reading.numbers["kept"], reading.numbers["vanished"], kept.action, kept.after) == (1, 0, "kept", None)
    assert look(written(tmp_path, ("B", 9.2)), replace_edited=True).numbers["vanished"] == 1


def test_changes_and_removals_are_in_the_history_with_before_and_after(tmp_path: Path) -> None:
    import_zones(path=written(tmp_path, ("A", 9.0), ("B", 9.2)))
    key = NoFlyZone.objects.get(name="A").pk
    import_zones(path=written(tmp_path, ("A", 9.05)))
    changed, vanished = (AuditEntry.objects.get(subject_type="zone", action=action) for action in ("changed", "vanished"))
    assert (changed.subject_id, changed.before["geometry"]["coordinates"][0][0][0][0]) == (str(key), 9.0)
    assert (changed.after["geometry"]["coordinates"][0][0][0][0], vanished.before["name"], vanished.after) == (9.05, "B", None)
    assert NoFlyZone.objects.get().revision == 2


def test_what_was_looked_at_for_one_set_is_not_applied_to_another_one(tmp_path: Path) -> None:
    curator = a_user(Role.CURATOR)
    import_zones(path=written(tmp_path, ("A", 9.0), ("B", 9.2)))
    proposal = proposed(zone_file(("C", 9.1)), curator, set_name="New")
    assert proposal.difference["vanished"] == 0
    pipeline.ask_to_apply(proposal=proposal, parameters={"set_name": "Works"}, actor=curator)
    proposal.refresh_from_db()
    apply_proposal(str(proposal.job_id))
    proposal.refresh_from_db()
    assert (proposal.state, proposal.difference["vanished"], NoFlyZone.objects.count()) == ("ready", 2, 2)


@pytest.mark.django_db(transaction=True)
def test_a_zone_that_is_edited_while_a_file_waits_for_the_ground_is_not_overwritten(tmp_path: Path) -> None:
    """Cora edits in an open transaction; Carl applies, waits for her, and finds that what he looked at no longer holds."""
    cora, carl = a_user(Role.CURATOR), a_user(Role.CURATOR)
    import_zones(path=written(tmp_path, ("A", 9.0), ("B", 9.2)))
    proposal = proposed(zone_file(("A", 9.05), ("B", 9.25)), carl)
    pipeline.ask_to_apply(proposal=proposal, parameters={}, actor=carl)
    proposal.refresh_from_db()
    applying = threading.Thread(target=apply_in_a_thread, args=(str(proposal.job_id),))
    with transaction.atomic():
        zone = NoFlyZone.objects.get(name="A")
        zone.reason = "Checked on site"
        save_zone(zone=zone, actor=cora)
        applying.start()
        wait_until_somebody_waits_for_the_ground()
    applying.join(timeout=20)
    proposal.refresh_from_db()
    zone.refresh_from_db()
    assert (proposal.state, proposal.difference["kept"], proposal.difference["changed"]) == ("ready", 1, 1)
    assert (zone.reason, zone.geometry.extent[0], NoFlyZone.objects.get(name="B").geometry.extent[0]) == ("Checked on site", 9.0, 9.2)
    assert list(AuditEntry.objects.filter(subject_type="zone").values_list("actor", flat=True)) == [cora.pk]


@pytest.mark.django_db(transaction=True)
def test_two_files_for_one_set_are_applied_one_after_the_other_and_the_second_is_looked_at_again(tmp_path: Path, settings: Any) -> None:
    settings.DATA_WORKERS = 3  # both jobs of the organisation run at once
    cora, carl = a_user(Role.CURATOR), a_user(Role.CURATOR)
    import_zones(path=written(tmp_path, ("A", 9.0)))
    proposals = [proposed(zone_file(("A", 9.05)), cora), proposed(zone_file(("A", 9.1)), carl)]
    for proposal, actor in zip(proposals, (cora, carl), strict=True):
        pipeline.ask_to_apply(proposal=proposal, parameters={}, actor=actor)
        proposal.refresh_from_db()
    threads = [threading.Thread(target=apply_in_a_thread, args=(str(proposal.job_id),)) for proposal in proposals]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(timeout=20)
    assert sorted(ImportProposal.objects.values_list("state", flat=True)) == ["applied", "ready"]
    assert AuditEntry.objects.filter(subject_type="zone", action="changed").count() == 1
    assert ZoneSet.objects.get().versions.count() == 2


def proposed(content: bytes, actor: User, set_name: str = "Works") -> ImportProposal:
    upload = store_upload(file_name="Works.geojson", chunks=[content], created_by=actor)
    proposal = pipeline.start_proposal(
        kind="zones", upload=upload, file_name="Works.geojson", parameters={"set_name": set_name}, provenance={}, created_by=actor
    )
    read_proposal(str(proposal.job_id))
    proposal.refresh_from_db()
    return proposal


def apply_in_a_thread(job: str) -> None:
    try:
        apply_proposal(job)
    finally:
        connections.close_all()


def wait_until_somebody_waits_for_the_ground() -> None:
    waiting = threading.Event()
    for _ in range(1_000):
        with connection.cursor() as cursor:
            cursor.execute(
                "SELECT count(*) FROM pg_locks JOIN pg_database ON oid = database "
                "WHERE datname = current_database() AND locktype = 'advisory' AND NOT granted"
            )
            if cursor.fetchone()[0]:
                return
        waiting.wait(0.01)
    raise AssertionError("nobody waits")
