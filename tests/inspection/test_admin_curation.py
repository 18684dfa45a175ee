"""The admin for curators: nobody overwrites another, every change is in the history, and many rows are changed at once."""

from typing import Any

import pytest
from django.test import Client
from django.urls import reverse
from django.utils import timezone

import config.urls  # noqa: F401 - the models are registered when the addresses are read
from inspection.admin.curated import MAX_CONCURRENT
from inspection.models import Asset, AssetSet, DataIssue, ImportProposal, NoFlyZone, ZoneSet, ZoneSetVersion, ZoneSubscription
from inspection.services import StaleRevision, save_asset, save_zone
from tests.accounts.users import a_user, client_of
from tests.inspection.ground import line, tower, zone
from tests.inspection.test_admin import area, change_address, form_of, point
from workspace.models import AuditEntry, Role, User

pytestmark = pytest.mark.django_db


@pytest.fixture
def curator() -> User:
    return a_user(Role.CURATOR)


@pytest.fixture
def client(curator: User) -> Client:
    return client_of(curator)


def act(client: Client, model: str, action: str, rows: Any, **more: Any) -> Any:
    form = {"action": action, "_selected_action": [row.pk for row in rows], **more}
    return client.post(reverse(f"admin:inspection_{model}_changelist"), form, follow=True)


def test_a_form_from_before_somebody_elses_change_is_shown_back_and_says_who(client: Client) -> None:
    asset = tower(ref="18")
    form = form_of(client.get(change_address(asset)))
    other = a_user(Role.CURATOR)
    asset.height_m = 31.0
    save_asset(asset=asset, actor=other)
    answer = client.post(change_address(asset), form | {"ref": "19"})
    assert answer.status_code == 200
    page = answer.content.decode()
    assert f"{other.username} has changed this in the meantime (changed, " in page
    assert 'value="19"' in page, "what was entered is kept"
    asset.refresh_from_db()
    assert (asset.ref, asset.height_m) == ("18", 31.0)
    again = form_of(client.get(change_address(asset)))
    assert client.post(change_address(asset), again | {"ref": "19"}).status_code == 302
    asset.refresh_from_db()
    assert (asset.ref, asset.height_m) == ("19", 31.0)


def test_a_change_between_the_look_and_the_save_is_told_too(client: Client, monkeypatch: pytest.MonkeyPatch) -> None:
    stored = zone()
    form = form_of(client.get(change_address(stored)))

    def too_late(**_: Any) -> None:
        raise StaleRevision("zone", stored.pk)

    monkeypatch.setattr("inspection.services.save_zone", too_late)
    answer = client.post(change_address(stored), form | {"name": "Fair"}, follow=True)
    assert "has changed in the meantime, and nothing was saved" in answer.content.decode()


def test_a_zone_that_an_import_changed_in_the_meantime_is_not_overwritten(client: Client) -> None:
    stored = zone()
    form = form_of(client.get(change_address(stored)))
    NoFlyZone.objects.update(revision=2, reason="From the source")
    AuditEntry.objects.create(organisation_id=1, action="changed", subject_type="zone", subject_id=str(stored.pk))
    answer = client.post(change_address(stored), form | {"name": "Fair"})
    assert "An import has changed this in the meantime" in answer.content.decode()


def test_the_history_of_an_asset_shows_author_before_and_after(client: Client, curator: User) -> None:
    asset = tower(ref="18")
    other = a_user(Role.CURATOR)
    asset.ref, asset.height_m = "<b>19</b>", 31.5
    save_asset(asset=asset, actor=other)
    form = form_of(client.get(change_address(asset)))
    client.post(change_address(asset), form | {"geometry": point(10.5, 56.5)})
    page = client.get(reverse("admin:inspection_powertower_history", args=[asset.pk])).content.decode()
    assert page.index(f"Changed by {curator.username}") < page.index(f"Changed by {other.username}"), "newest first"
    assert "<th scope='row'>ref</th><td>18</td><td>&lt;b&gt;19&lt;/b&gt;</td>" in page
    assert "<th scope='row'>height m</th><td>–</td><td>31.5</td>" in page
    assert "<td>Point 10, 56</td><td>Point 10.5, 56.5</td>" in page


def test_the_history_of_a_zone_shows_what_was_drawn(client: Client, curator: User) -> None:
    address = reverse("admin:inspection_noflyzone_add")
    square = [[10.0, 56.0], [10.1, 56.0], [10.1, 56.1], [10.0, 56.1], [10.0, 56.0]]
    client.post(address, form_of(client.get(address)) | {"name": "Fair", "geometry": area(square)})
    page = client.get(reverse("admin:inspection_noflyzone_history", args=[NoFlyZone.objects.get().pk])).content.decode()
    assert f"Created by {curator.username}" in page
    assert "<th scope='row'>name</th><td>–</td><td>Fair</td>" in page
    assert "MultiPolygon of 5 vertices" in page


def test_the_history_is_paged(client: Client) -> None:
    asset = tower()
    entries = [
        AuditEntry(organisation_id=1, action=f"step {n}", subject_type="asset", subject_id=str(asset.pk), after={}) for n in range(60)
    ]
    AuditEntry.objects.bulk_create(entries)
    address = reverse("admin:inspection_asset_history", args=[asset.pk])
    assert "1 of 2" in client.get(address).content.decode()
    assert "Step 0 by the program" in client.get(f"{address}?p=2").content.decode()


def test_rows_that_nobody_changed_have_an_empty_history(client: Client) -> None:
    page = client.get(reverse("admin:inspection_asset_history", args=[tower().pk])).content.decode()
    assert "Nothing has been changed by hand" in page


def test_several_assets_are_marked_as_not_flyable_each_in_the_history(client: Client, curator: User) -> None:
    rows = [tower((10.0 + n / 100, 56.0)) for n in range(3)]
    answer = act(client, "powertower", "mark_not_flyable", rows[:2])
    assert "2 marked as not flyable" in answer.content.decode()
    assert list(Asset.objects.order_by("pk").values_list("is_flyable", "is_edited")) == [(False, True), (False, True), (True, False)]
    entries = AuditEntry.objects.filter(actor=curator, action="changed")
    assert [(entry.before["is_flyable"], entry.after["is_flyable"]) for entry in entries] == [(True, False)] * 2
    act(client, "asset", "mark_flyable", rows)
    assert not Asset.objects.filter(is_flyable=False).exists()


def test_more_than_a_request_can_change_is_refused_whole(client: Client) -> None:
    row = tower()
    copies = [Asset(kind="tower", geometry=row.geometry, centre=row.centre) for _ in range(MAX_CONCURRENT)]
    Asset.objects.bulk_create(copies)
    answer = act(client, "powertower", "mark_not_flyable", [row], select_across="1")
    assert f"{MAX_CONCURRENT + 1} rows are chosen; at most {MAX_CONCURRENT} are changed at once" in answer.content.decode()
    assert not Asset.objects.filter(is_flyable=False).exists()


def test_deleting_several_supports_numbers_the_others_anew_once(client: Client) -> None:
    supports = [tower((10.0 + n / 100, 56.0), osm_id=None, osm_type="") for n in range(3)]
    row = line(*[support.centre.coords for support in supports], osm_id=None, osm_type="")
    save_asset(asset=row, actor=a_user(Role.CURATOR))
    act(client, "asset", "delete_selected", supports[:1], post="yes")
    supports[2].refresh_from_db()
    assert (supports[2].place_on_line, supports[2].places_on_line) == (2, 2)


def test_gaps_are_left_as_they_are_and_opened_again_at_once(client: Client, curator: User) -> None:
    asset = tower()
    gaps = [
        DataIssue.objects.create(kind="tower_on_no_line", key=f"x{n}", asset=asset, position=asset.centre, ground_revision=1)
        for n in range(2)
    ]
    assert "2 left as they are" in act(client, "dataissue", "dismiss", gaps).content.decode()
    assert set(DataIssue.objects.values_list("state", "decided_by")) == {("dismissed", curator.pk)}
    act(client, "dataissue", "reopen", gaps[:1])
    assert sorted(DataIssue.objects.values_list("state", flat=True)) == ["dismissed", "open"]


def test_subscriptions_are_paused_and_resumed_at_once(client: Client) -> None:
    rows = [ZoneSubscription.objects.create(zone_set=ZoneSet.objects.create(name=name), address="https://example.org/z") for name in "ab"]
    act(client, "zonesubscription", "pause", rows)
    assert not ZoneSubscription.objects.filter(is_active=True).exists()
    act(client, "zonesubscription", "resume", rows[:1])
    assert ZoneSubscription.objects.filter(is_active=True).count() == 1


def test_proposals_lead_to_the_page_where_they_are_decided(client: Client) -> None:
    proposal = ImportProposal.objects.create(kind="assets", file_name="masts.csv", difference={"new": 7}, summary={"preview": "x" * 99})
    page = client.get(reverse("admin:inspection_importproposal_changelist")).content.decode()
    assert f'href="/imports/{proposal.pk}"' in page
    assert "xxx" not in client.get(change_address(proposal)).content.decode()
    assert client.post(change_address(proposal), {"state": "applied"}).status_code == 403
    assert 'href="/imports"' in page


def test_an_asset_says_which_set_it_comes_from(client: Client) -> None:
    asset = tower(osm_id=None, osm_type="", asset_set=AssetSet.objects.create(name="Masts of the north"), source_key="7")
    assert "Masts of the north" in client.get(reverse("admin:inspection_asset_changelist")).content.decode()
    assert client.get(reverse("admin:inspection_asset_changelist") + "?q=7").context["cl"].result_count == 1
    assert "Masts of the north" in client.get(change_address(asset)).content.decode()


def test_versions_do_not_load_what_they_hold(client: Client, django_assert_max_num_queries: Any) -> None:
    zone_set = ZoneSet.objects.create(name="Denmark")
    version = ZoneSetVersion.objects.create(zone_set=zone_set, number=1, zones=0, content=b"x", created_at=timezone.now())
    with django_assert_max_num_queries(12):
        assert client.get(reverse("admin:inspection_zonesetversion_changelist")).status_code == 200
    assert client.get(change_address(version)).status_code == 200


@pytest.mark.parametrize(("text", "fault"), [('{"day": "MON"}', "are a list"), ('[{"startDateTime": "soon"}]', "schedule")])
def test_a_schedule_that_is_none_is_shown_back_with_its_fault(client: Client, text: str, fault: str) -> None:
    stored = zone()
    save_zone(zone=stored, actor=a_user(Role.CURATOR))
    answer = client.post(change_address(stored), form_of(client.get(change_address(stored))) | {"schedule": text})
    assert fault in str(answer.context["adminform"].form.errors["schedule"])
