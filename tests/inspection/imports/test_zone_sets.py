"""Sets of zones: where they come from, and every state they had."""

from collections.abc import Iterator
from io import StringIO
from pathlib import Path
from typing import Any

import pytest
from django.core.management import call_command
from django.test import Client
from django.utils import timezone

from inspection.models import DataImport, ImportProposal, NoFlyZone, ZoneSet, ZoneSetVersion, ZoneSubscription
from inspection.selectors import ground_revision
from inspection.services import save_zone
from tests.accounts.users import a_user, client_of
from tests.inspection.imports.zone_sets import SETS, SUBSCRIPTIONS, applied, names, post, read, stored, subscribed, zone_file
from tests.workspace.loopback import Server, serving
from workspace.models import AuditEntry, Role, User

pytestmark = pytest.mark.django_db


@pytest.fixture
def source(settings: Any) -> Iterator[Server]:
    """The authority's server: /zones.json answers what a test puts there."""
    with serving() as server:
        settings.OUTGOING_ALLOWED_HOSTS = [f"127.0.0.1:{server.server_port}"]
        yield server


def test_a_set_states_its_source_and_its_numbers(client: Client, curator: User, tmp_path: Path) -> None:
    path = tmp_path / "Works.geojson"
    path.write_bytes(zone_file(("A", 9.0), ("B", 9.2)))
    call_command("import_zones", str(path), "--licence", "CC BY 4.0", "--attribution", "The office", stdout=StringIO())
    zone = NoFlyZone.objects.get(name="A")
    zone.reason = "Checked on site"
    save_zone(zone=zone, actor=curator)
    [listed] = client_of(a_user(Role.VIEWER)).get(SETS).json()["results"]
    assert (listed["name"], listed["zone_count"], listed["edited_count"], listed["version_count"]) == ("Works", 2, 1, 1)
    source = listed["source"]
    assert (source["file_name"], source["licence"], source["attribution"]) == ("Works.geojson", "CC BY 4.0", "The office")
    assert (source["source_address"], source["fetched_at"], source["is_synthetic"], listed["subscription"]) == ("", None, False, None)
    assert client.get(f"{SETS}/{listed['id']}").json() == listed


def test_a_list_of_many_sets_asks_the_database_no_more_often_than_one_of_few(
    client: Client, django_assert_max_num_queries: Any, tmp_path: Path
) -> None:
    source = stored(tmp_path, ("A", 9.0))
    for number in range(20):
        zone_set = ZoneSet.objects.create(name=f"set {number}", data_import=source)
        ZoneSubscription.objects.create(zone_set=zone_set, address="https://example.org/zones")
    client.get(SETS)  # the first request of a session notes that it is in use
    with django_assert_max_num_queries(5):
        assert len(client.get(SETS).json()["results"]) == 21
    with django_assert_max_num_queries(5):
        assert len(client.get(SUBSCRIPTIONS).json()["results"]) == 20


def test_the_licence_can_be_stated_later_and_is_not_forgotten(tmp_path: Path) -> None:
    path = tmp_path / "Works.geojson"
    path.write_bytes(zone_file(("A", 9.0)))
    for options in ([], ["--licence", "CC0"], []):
        call_command("import_zones", str(path), *options, stdout=StringIO())
    assert DataImport.objects.get().licence == "CC0"


def test_each_change_of_a_set_is_a_version_and_a_file_that_changes_nothing_is_none(client: Client, tmp_path: Path) -> None:
    stored(tmp_path, ("A", 9.0))
    stored(tmp_path, ("A", 9.0), ("B", 9.2))
    stored(tmp_path, ("A", 9.0), ("B", 9.2))
    versions = client.get(f"{SETS}/{ZoneSet.objects.get().pk}/versions").json()["results"]
    assert [(version["version"], version["zone_count"]) for version in versions] == [(2, 2), (1, 1)]
    assert versions[0]["source"]["file_name"] == "Works.geojson"


def test_what_was_there_before_versions_is_kept_by_the_first_import_after(curator: User, tmp_path: Path) -> None:
    stored(tmp_path, ("A", 9.0))
    ZoneSetVersion.objects.all().delete()
    stored(tmp_path, ("B", 9.0))
    assert list(ZoneSetVersion.objects.values_list("number", "zones")) == [(2, 1), (1, 1)]


def test_a_curators_edit_is_in_a_version_before_a_file_replaces_it(client: Client, curator: User, tmp_path: Path) -> None:
    stored(tmp_path, ("A", 9.0))
    zone = NoFlyZone.objects.get()
    zone.reason = "Checked on site"
    save_zone(zone=zone, actor=curator)
    stored(tmp_path, ("A", 9.05), replace_edited=True)
    zone_set = ZoneSet.objects.get()
    assert (NoFlyZone.objects.get().reason, NoFlyZone.objects.get().is_edited, zone_set.versions.count()) == ("", False, 3)
    answer = post(client, f"{SETS}/{zone_set.pk}/roll-back", version=2)
    assert answer.status_code == 202, answer.content
    applied(client, read(ImportProposal.objects.get(pk=answer.json()["id"])))
    zone.refresh_from_db()
    assert (zone.reason, zone.is_edited, zone.geometry.extent[0]) == ("Checked on site", True, 9.0)
    changed = AuditEntry.objects.filter(subject_type="zone", action="changed").first()
    assert (changed.actor, changed.before["reason"], changed.after["reason"]) == (curator, "", "Checked on site")


def test_a_roll_back_is_looked_at_first_and_keeps_the_source(client: Client, tmp_path: Path) -> None:
    stored(tmp_path, ("A", 9.0), ("B", 9.2))
    DataImport.objects.update(licence="CC0", valid_until=timezone.now())
    stored(tmp_path, ("B", 9.25), ("C", 9.4))
    zone_set, revision = ZoneSet.objects.get(), ground_revision()
    answer = post(client, f"{SETS}/{zone_set.pk}/roll-back", version=1)
    assert (answer.json()["origin"], answer["Location"]) == ("roll_back", f"/api/v1/imports/{answer.json()['id']}")
    proposal = read(ImportProposal.objects.get())
    assert proposal.difference == {"new": 1, "changed": 1, "vanished": 1, "kept": 0, "unchanged": 0}
    assert (names(), ground_revision()) == (["B", "C"], revision)
    applied(client, proposal)
    assert (names(), ground_revision(), zone_set.versions.count()) == (["A", "B"], revision + 1, 3)
    source = client.get(f"{SETS}/{zone_set.pk}").json()["source"]
    assert (source["licence"], source["valid_until"] is not None, source["file_name"]) == ("CC0", True, "Works, version 1")


@pytest.mark.parametrize("version", [2, 0, -1, "one", None, 10**12])
def test_a_version_that_is_not_there_cannot_be_gone_back_to(version: Any, client: Client, tmp_path: Path) -> None:
    stored(tmp_path, ("A", 9.0))
    assert post(client, f"{SETS}/{ZoneSet.objects.get().pk}/roll-back", version=version).status_code == 400
    assert not ImportProposal.objects.exists()


def test_a_set_is_emptied_with_its_history_and_can_be_brought_back(client: Client, source: Server, tmp_path: Path) -> None:
    stored(tmp_path, ("A", 9.0), ("B", 9.2))
    subscribed(client, source)
    zone_set, revision = ZoneSet.objects.get(), ground_revision()
    for _ in range(2):
        assert client.delete(f"{SETS}/{zone_set.pk}").status_code == 204
    assert (names(), ground_revision()) == ([], revision + 1)
    listed = client.get(f"{SETS}/{zone_set.pk}").json()
    assert (listed["zone_count"], listed["version_count"], listed["source"]) == (0, 1, None)
    assert listed["subscription"]["is_active"] is False
    assert sorted(AuditEntry.objects.filter(subject_type="zone").values_list("action", flat=True)) == ["vanished", "vanished"]
    post(client, f"{SETS}/{zone_set.pk}/roll-back", version=1)
    applied(client, read(ImportProposal.objects.get()))
    assert names() == ["A", "B"]
