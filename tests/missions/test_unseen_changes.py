"""What changes a mission names the revision that was seen; what stops UAVs is never held up by a header."""

from typing import Any

import pytest
from django.http import HttpResponse
from django.test import Client

from missions.models import MissionState, UavCommand
from tests.accounts.users import a_user, client_of
from tests.missions.api import patch, post
from tests.missions.flights import approved, dispatched, fleet, planned
from tests.missions.worlds import World
from workspace.models import User

pytestmark = pytest.mark.django_db


@pytest.fixture
def person() -> User:
    return a_user()


@pytest.fixture
def client(person: User) -> Client:
    return client_of(person)


def without_header(client: Client, method: str, path: str, body: Any = None) -> HttpResponse:
    return getattr(client, method)(f"/api/v1/{path}", body or {}, content_type="application/json")


@pytest.mark.parametrize(
    ("method", "path", "body"),
    [
        ("post", "approve", {}),
        ("post", "dispatch", {}),
        ("post", "plan", {}),
        ("patch", "", {"name": "Other"}),
        ("delete", "", None),
        ("put", "routes/0/waypoints", {"waypoints": []}),
        ("post", "routes/0/waypoints/undo", {}),
    ],
)
def test_a_change_without_the_revision_that_was_seen_is_refused(
    client: Client, here: World, person: User, method: str, path: str, body: Any
) -> None:
    mission = planned(person, fleet(), here.towers[:2])
    answer = without_header(client, method, f"missions/{mission.pk}/{path}".rstrip("/"), body)
    assert (answer.status_code, answer.json()["error"]["code"]) == (428, "if_match_missing")
    seen = mission.revision
    mission.refresh_from_db()
    assert (mission.revision, mission.state) == (seen, MissionState.PLANNED)


def test_an_edit_of_the_same_second_is_not_approved_unseen(client: Client, here: World, person: User) -> None:
    mission = planned(person, fleet(), here.towers[:2])
    seen = client.get(f"/api/v1/missions/{mission.pk}")["ETag"]
    other = client_of(a_user())
    assert patch(other, f"missions/{mission.pk}", {"targets": [{"asset": here.towers[3].pk}], "plan": True}).status_code == 200
    answer = post(client, f"missions/{mission.pk}/approve", **{"If-Match": seen})
    assert (answer.status_code, answer.json()["error"]["code"]) == (412, "mission_changed")
    mission.refresh_from_db()
    assert mission.state == MissionState.PLANNED


def test_an_abort_is_carried_out_without_a_header_and_of_whatever_is_there(client: Client, here: World, person: User) -> None:
    for headers in ({}, {"If-Match": "*"}):
        UavCommand.objects.all().delete()
        mission = dispatched(person, fleet(f"Tern {len(headers)}"), here.towers[:2])
        answer = client.post(f"/api/v1/missions/{mission.pk}/abort", {"why": "smoke"}, content_type="application/json", headers=headers)
        assert (answer.status_code, answer.json()["state"]) == (200, "aborted")


def test_a_uav_is_held_returned_and_landed_without_a_header(client: Client, here: World, person: User) -> None:
    (tern,) = uavs = fleet()
    dispatched(person, uavs, here.towers[:2])
    for kind in ("hold", "return", "land"):
        assert without_header(client, "post", f"uavs/{tern.pk}/commands", {"kind": kind}).status_code == 201, kind


def test_an_approval_is_taken_back_without_a_header(client: Client, here: World, person: User) -> None:
    mission, _ = approved(person, fleet(), here.towers[:2])
    assert without_header(client, "post", f"missions/{mission.pk}/revoke", {"reason": "wind"}).status_code == 200
