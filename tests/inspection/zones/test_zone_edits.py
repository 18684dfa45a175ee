"""Edits of many zones at once: all or none, a history entry each, conflicts refused, and one way back."""

from typing import Any

import pytest
from django.test import Client

from inspection.models import NoFlyZone, ZoneSet
from inspection.selectors import ground_revision
from inspection.selectors.zone_table import zone_table
from inspection.services.facts import zone_facts
from tests.accounts.users import a_user, client_of
from tests.inspection.ground import zone
from workspace.models import AuditEntry, Role, User

pytestmark = pytest.mark.django_db
PERIOD = [{"startDateTime": "2026-01-01T00:00:00Z", "endDateTime": "2026-02-01T00:00:00Z", "schedule": []}]


@pytest.fixture
def curator() -> User:
    return a_user(Role.CURATOR)


@pytest.fixture
def client(curator: User) -> Client:
    return client_of(curator)


def post(client: Client, body: dict[str, Any], query: str = "") -> Any:
    return client.post(f"/api/v1/zones/edits{query}", body, content_type="application/json")


def undo(client: Client, entries: list[int]) -> Any:
    return client.post("/api/v1/zones/edits/undo", {"entries": entries}, content_type="application/json")


def read(*rows: NoFlyZone) -> list[dict[str, int]]:
    return [{"id": row.pk, "revision": row.revision} for row in rows]


def one_of_a_source(**facts: Any) -> NoFlyZone:
    source, _ = ZoneSet.objects.get_or_create(name="Authority")
    return zone(zone_set=source, lower_limit_m=0.0, lower_reference="AGL", upper_limit_m=300.0, upper_reference="AGL", **facts)


def test_many_are_corrected_with_a_history_each_and_undone_together(client: Client, curator: User) -> None:
    sourced, drawn, other = one_of_a_source(), zone(restriction="CONDITIONAL"), zone(name="Other")
    revision = ground_revision()
    values = {
        "restriction": "PROHIBITED",
        "reason": "NATURE, NOISE",
        "upper_limit": {"value_m": 120, "reference": "AGL"},
        "schedule": PERIOD,
    }
    answer = post(client, {"zones": read(sourced, drawn), "values": values})
    assert answer.status_code == 200, answer.content
    assert answer.json()["changed"] == 2
    changed = list(NoFlyZone.objects.exclude(pk=other.pk).order_by("pk"))
    assert {(row.restriction, row.reason, row.upper_limit_m, row.upper_reference, row.revision) for row in changed} == {
        ("PROHIBITED", "NATURE, NOISE", 120.0, "AGL", 2)
    }
    assert [row.is_edited for row in changed] == [True, False]  # a drawn one has no source to differ from
    assert all(row.schedule == PERIOD and row.updated_at > sourced.updated_at for row in changed)
    assert ground_revision() == revision + 1  # plans were made with an older one: they are stale
    history = client.get(f"/api/v1/zones/{drawn.pk}/history").json()["results"]
    assert (history[0]["before"]["restriction"], history[0]["after"]["restriction"]) == ("CONDITIONAL", "PROHIBITED")
    client.patch(f"/api/v1/zones/{drawn.pk}", {"name": "Since"}, content_type="application/json", headers={"If-Match": "*"})
    assert undo(client, answer.json()["entries"]).json() == {"undone": 1, "kept": 1}
    sourced.refresh_from_db()
    assert (sourced.restriction, sourced.upper_limit_m, sourced.schedule, sourced.is_edited, sourced.revision) == (
        "",
        300.0,
        None,
        False,
        3,
    )
    assert AuditEntry.objects.filter(actor=curator, action="reverted", subject_type="zone").count() == 1


def test_it_stores_what_single_corrections_store(client: Client) -> None:
    single, many = one_of_a_source(), one_of_a_source()
    values = {"reason": "NOISE", "upper_limit": {"value_m": 90, "reference": "AMSL"}}
    client.patch(f"/api/v1/zones/{single.pk}", values, content_type="application/json", headers={"If-Match": '"1"'})
    post(client, {"zones": read(many), "values": values})
    own = {"identifier": None}
    facts = [zone_facts(row) | own for row in NoFlyZone.objects.filter(pk__in=[single.pk, many.pk])]
    assert facts[0] == facts[1]
    of_single, of_many = ({**entry.after, **own} for entry in AuditEntry.objects.order_by("pk"))
    assert of_single == of_many


def test_planning_sees_the_edit_at_once(client: Client) -> None:
    row = one_of_a_source()
    assert zone_table().ceiling_agl_m.tolist() == [300.0]
    post(client, {"zones": read(row), "values": {"upper_limit": {"value_m": 500, "reference": "AGL"}}})
    assert zone_table().ceiling_agl_m.tolist() == [500.0]


def test_a_zone_that_others_changed_or_deleted_refuses_the_whole_edit(client: Client) -> None:
    same, changed, deleted = one_of_a_source(), one_of_a_source(), one_of_a_source()
    asked = read(same, changed, deleted)
    client.patch(f"/api/v1/zones/{changed.pk}", {"name": "Since"}, content_type="application/json", headers={"If-Match": '"1"'})
    client.delete(f"/api/v1/zones/{deleted.pk}", headers={"If-Match": '"1"'})
    answer = post(client, {"zones": asked, "values": {"reason": "NOISE"}})
    assert (answer.status_code, answer.json()["error"]["details"]) == (409, {"changed": [changed.pk, deleted.pk]})
    assert not NoFlyZone.objects.filter(reason="NOISE").exists()


def test_filters_edit_the_number_that_was_confirmed(client: Client) -> None:
    for restriction in ("PROHIBITED", "PROHIBITED", "CONDITIONAL"):
        one_of_a_source(restriction=restriction)
    values = {"reason": "NOISE"}
    answer = post(client, {"expected": 3, "values": values}, "?restriction=PROHIBITED")
    assert (answer.status_code, answer.json()["error"]["details"]) == (409, {"found": 2})
    assert not AuditEntry.objects.exists()
    assert post(client, {"expected": 2, "values": values}, "?restriction=PROHIBITED").json()["changed"] == 2
    assert post(client, {"expected": 3, "values": values}).json()["changed"] == 1  # the others say so already


def test_limits_that_would_cross_change_nothing(client: Client) -> None:
    fine, crossed = one_of_a_source(), one_of_a_source(name="Mast")
    NoFlyZone.objects.filter(pk=crossed.pk).update(lower_limit_m=150.0)
    answer = post(client, {"zones": read(fine, crossed), "values": {"upper_limit": {"value_m": 120, "reference": "AGL"}}})
    assert answer.status_code == 400
    assert "such as of Mast" in answer.json()["error"]["message"]
    assert not NoFlyZone.objects.filter(upper_limit_m=120).exists()


def test_a_zone_imported_again_since_is_not_undone(client: Client) -> None:
    row = one_of_a_source()
    entries = post(client, {"zones": read(row), "values": {"reason": "NOISE"}}).json()["entries"]
    NoFlyZone.objects.filter(pk=row.pk).update(reason="NATURE", is_edited=False)  # an import that replaces edits
    assert undo(client, entries).json() == {"undone": 0, "kept": 1}
    row.refresh_from_db()
    assert row.reason == "NATURE"


@pytest.mark.parametrize(
    "body",
    [
        {"values": {"reason": "NOISE"}},
        {"expected": 1, "zones": [{"id": 1, "revision": 1}], "values": {"reason": "NOISE"}},
        {"zones": [{"id": 1}], "values": {"reason": "NOISE"}},
        {"expected": 1, "values": {}},
        {"expected": 1, "values": {"name": "Same for all"}},
        {"expected": 1, "values": {"upper_limit": {"value_m": 10}}},
        {"expected": 1, "values": {"schedule": "always"}},
        {"expected": 1, "values": {"lower_limit": {"value_m": 9, "reference": "AGL"}, "upper_limit": {"value_m": 8, "reference": "AGL"}}},
    ],
)
def test_what_cannot_be_changes_nothing(client: Client, body: dict[str, Any]) -> None:
    zone()
    assert post(client, body).status_code == 400
    assert not AuditEntry.objects.exists()


def test_operators_edit_nothing() -> None:
    row = zone()
    other = client_of(a_user(Role.OPERATOR))
    assert post(other, {"zones": read(row), "values": {"reason": "NOISE"}}).status_code == 403
    assert undo(other, [1]).status_code == 403
