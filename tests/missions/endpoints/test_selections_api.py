"""Saved selections over HTTP: kept, found, loaded again, changed by several people, gone."""

from typing import Any

import pytest
from django.test import Client
from django.utils import timezone

from inspection.models import Asset
from tests.accounts.users import a_user, client_of
from tests.inspection.ground import line, tower
from tests.missions.api import patch, post
from workspace.models import AuditEntry, Organisation, Role

pytestmark = pytest.mark.django_db


@pytest.fixture
def client() -> Client:
    return client_of(a_user(Role.OPERATOR))


def keeps(client: Client, *targets: Asset | dict[str, Any], name: str = "South belt") -> dict[str, Any]:
    listed = [target if isinstance(target, dict) else {"asset": target.pk} for target in targets]
    answer = post(client, "selections", {"name": name, "targets": listed})
    assert answer.status_code == 201, answer.content
    assert answer["Location"] == f"/api/v1/selections/{answer.json()['id']}"
    return answer.json()


def test_a_selection_comes_back_as_it_was_kept(client: Client) -> None:
    mast, way = tower(ref="T 1", voltages_v=[138_000]), line(ref="North", length_m=900.0)
    stretch = [[10.0, 56.0], [10.01, 56.01]]
    kept = keeps(
        client,
        {"asset": mast.pk, "task": {"kind": "hold", "hold_s": 45}, "priority": "high", "sensor": "Lidar"},
        {"asset": way.pk, "stretch": stretch},
        {"asset": way.pk, "position": [10.005, 56.005]},
        {"position": [10.2, 56.2]},
    )
    loaded = client.get(f"/api/v1/selections/{kept['id']}")
    assert loaded["ETag"] == '"1"'
    body = loaded.json()
    assert (body["name"], body["target_count"], body["missing"]) == ("South belt", 4, [])
    assert body["author"].startswith("operator-")
    assert [target["label"] for target in body["targets"]] == ["T 1", "North, km 0.0–1.3", "North", "56.20000, 10.20000"]
    assert body["targets"][0] == {
        "asset": mast.pk, "label": "T 1", "detail": "138 kV", "length_m": None, "kind": "tower", "line": None, "position": [10.0, 56.0],
        "stretch": None,
        "is_point": False, "task": {"kind": "hold", "hold_s": 45.0}, "priority": "high", "sensor": "Lidar",
    }  # fmt: skip
    assert [(target["priority"], target["sensor"]) for target in body["targets"][1:]] == [("normal", "")] * 3
    assert [target["stretch"] for target in body["targets"]] == [None, stretch, None, None]
    assert [target["is_point"] for target in body["targets"]] == [False, False, True, True]


def test_what_is_no_longer_in_the_data_is_named(client: Client) -> None:
    stays, vanishes, goes = tower(ref="stays"), tower(ref="vanishes"), tower(ref="goes")
    kept = keeps(client, stays, vanishes, goes)
    Asset.objects.filter(pk=vanishes.pk).update(vanished_at=timezone.now())
    goes.delete()
    body = client.get(f"/api/v1/selections/{kept['id']}").json()
    assert [target["label"] for target in body["targets"]] == ["stays"]
    assert body["missing"] == ["vanishes", "goes"]


def test_selections_are_listed_by_name_and_shared_in_the_organisation(client: Client) -> None:
    mast = tower()
    keeps(client, mast, name="West")
    keeps(client, mast, name="east")
    other = client_of(a_user(Role.VIEWER))
    assert {row["name"] for row in other.get("/api/v1/selections").json()["results"]} == {"West", "east"}
    assert [row["name"] for row in other.get("/api/v1/selections?text=EAS").json()["results"]] == ["east"]
    first = other.get("/api/v1/selections?limit=1").json()
    assert len(first["results"]) == 1 and first["next"]


def test_another_organisation_sees_nothing_of_them(client: Client) -> None:
    kept = keeps(client, tower())
    elsewhere = client_of(a_user(Role.ADMINISTRATOR, Organisation.objects.create(name="Elsewhere")))
    assert elsewhere.get("/api/v1/selections").json()["results"] == []
    address = f"selections/{kept['id']}"
    assert elsewhere.get(f"/api/v1/{address}").status_code == 404
    assert patch(elsewhere, address, {"name": "mine"}, **{"If-Match": "*"}).status_code == 404
    assert elsewhere.delete(f"/api/v1/{address}", headers={"If-Match": "*"}).status_code == 404


def test_a_name_is_given_once(client: Client) -> None:
    mast = tower()
    keeps(client, mast)
    second = keeps(client, mast, name="other")
    taken = post(client, "selections", {"name": "South belt", "targets": [{"asset": mast.pk}]})
    assert (taken.status_code, taken.json()["error"]["code"]) == (409, "name_taken")
    renamed = patch(client, f"selections/{second['id']}", {"name": "South belt"}, **{"If-Match": '"1"'})
    assert (renamed.status_code, renamed.json()["error"]["code"]) == (409, "name_taken")


def test_who_comes_second_overwrites_nothing_and_sees_what_is_there(client: Client) -> None:
    one, two = tower(ref="one"), tower(ref="two")
    address = f"selections/{keeps(client, one)['id']}"
    changed = patch(client, address, {"targets": [{"asset": two.pk}]}, **{"If-Match": '"1"'})
    assert (changed.status_code, changed["ETag"]) == (200, '"2"')
    late = patch(client, address, {"name": "late"}, **{"If-Match": '"1"'})
    assert (late.status_code, late.json()["error"]["details"]["current"]["revision"]) == (412, 2)
    assert client.delete(f"/api/v1/{address}", headers={"If-Match": '"1"'}).status_code == 412
    assert client.patch(f"/api/v1/{address}", {"name": "none"}, content_type="application/json").status_code == 428
    now = client.get(f"/api/v1/{address}").json()
    assert (now["name"], [target["label"] for target in now["targets"]]) == ("South belt", ["two"])


def test_a_deleted_selection_is_gone_and_in_the_log(client: Client) -> None:
    kept = keeps(client, tower())
    assert client.delete(f"/api/v1/selections/{kept['id']}", headers={"If-Match": '"1"'}).status_code == 204
    assert client.get(f"/api/v1/selections/{kept['id']}").status_code == 404
    actions = AuditEntry.objects.filter(subject_type="selection", subject_id=str(kept["id"])).order_by("recorded_at", "pk")
    assert [entry.action for entry in actions] == ["create", "delete"]


def test_the_same_request_sent_twice_keeps_one(client: Client) -> None:
    body = {"name": "South belt", "targets": [{"asset": tower().pk}]}
    first, second = (post(client, "selections", body, **{"Idempotency-Key": "k1"}) for _ in range(2))
    assert (first.status_code, second.status_code) == (201, 201)
    assert first.json()["id"] == second.json()["id"]


@pytest.mark.parametrize(
    "body",
    [
        {"name": "x", "targets": []},
        {"name": "", "targets": [{"position": [10, 56]}]},
        {"name": "x" * 101, "targets": [{"position": [10, 56]}]},
        {"name": "x", "targets": [{"asset": 999_999_999}]},
        {"name": "x", "targets": [{}]},
        {"name": "x", "targets": [{"position": [10, 56]}] * 501},
        {"name": "x"},
    ],
)
def test_what_cannot_be_picked_cannot_be_kept(client: Client, body: dict[str, Any]) -> None:
    assert post(client, "selections", body).status_code == 400
