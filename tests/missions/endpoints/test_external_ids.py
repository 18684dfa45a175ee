"""Ids and attributes of other systems on UAVs, missions and targets."""

from typing import Any

import pytest
from django.test import Client

from missions.models import Mission, MissionState
from missions.services.mission_copies import draft_follow_up, duplicate_mission
from tests.accounts.users import a_user, client_of
from tests.missions.api import mission_body, patch, post
from tests.missions.worlds import world
from workspace.models import AuditEntry, Organisation, Role

pytestmark = pytest.mark.django_db
ATTRIBUTES = {"plant": "North", "circuit": 2, "is_urgent": True, "age_years": 31.5}
GIVEN = {"external_id": "WO-4711", "attributes": ATTRIBUTES}
KITE = {"name": "Kite", "position": [10.0, 56.0]}


@pytest.fixture
def client() -> Client:
    return client_of(a_user())


def given_of(row: dict[str, Any]) -> dict[str, Any]:
    return {name: row[name] for name in GIVEN}


def names(client: Client, path: str) -> list[str]:
    answer = client.get(f"/api/v1/{path}")
    assert answer.status_code == 200, answer.content
    found = answer.json()
    return [row["name"] for row in found.get("results") or [feature["properties"] for feature in found.get("features", [])]]


def test_a_uav_keeps_what_another_system_says_of_it(client: Client) -> None:
    made = post(client, "uavs", KITE | GIVEN)
    assert made.status_code == 201, made.content
    assert given_of(made.json()["properties"]) == GIVEN
    path = f"uavs/{made.json()['id']}"
    changed = patch(client, path, {"attributes": {"plant": "South"}}, **{"If-Match": made["ETag"]}).json()["properties"]
    assert given_of(changed) == {"external_id": "WO-4711", "attributes": {"plant": "South"}}
    assert patch(client, path, {"external_id": ""}, **{"If-Match": made["ETag"]}).status_code == 412
    entry = AuditEntry.objects.get(subject_type="uav", action="change")
    assert entry.before is not None and entry.after is not None
    assert (entry.before["attributes"], entry.after["attributes"]) == (ATTRIBUTES, {"plant": "South"})


def test_a_uav_that_was_deleted_comes_back_with_it(client: Client) -> None:
    uav = post(client, "uavs", KITE | GIVEN).json()["id"]
    assert client.delete(f"/api/v1/uavs/{uav}", headers={"If-Match": "*"}).status_code == 204
    assert given_of(post(client, f"uavs/{uav}/restore").json()["properties"]) == GIVEN


def test_an_external_id_is_of_one_uav_of_an_organisation(client: Client) -> None:
    post(client, "uavs", KITE | GIVEN)
    second = post(client, "uavs", KITE | GIVEN | {"name": "Tern"})
    assert (second.status_code, second.json()["error"]["code"]) == (409, "external_id_taken")
    assert "external_id" in second.json()["error"]["details"]
    assert post(client, "uavs", KITE | {"name": "Tern"}).status_code == 201
    assert post(client, "uavs", KITE | {"name": "Gull"}).status_code == 201, "several may have none"
    other = client_of(a_user(organisation=Organisation.objects.create(name="Other")))
    assert post(other, "uavs", KITE | GIVEN).status_code == 201


def test_uavs_are_found_by_their_external_id(client: Client) -> None:
    post(client, "uavs", KITE | GIVEN)
    post(client, "uavs", KITE | {"name": "Tern", "external_id": "WO-47"})
    assert names(client, "uavs?external_id=WO-4711") == ["Kite"]
    assert names(client, "uavs?external_id=WO") == [], "the whole id"


def test_a_mission_and_its_targets_keep_what_another_system_says_of_them(client: Client) -> None:
    here = world()
    item = {"external_id": "item-1", "attributes": {"row": 1}}
    made = post(client, "missions", mission_body({"asset": here.towers[1].pk} | item, here.towers[2], plan=True, **GIVEN))
    assert made.status_code == 201, made.content
    mission = made.json()
    assert given_of(mission) == GIVEN
    assert [given_of(target) for target in mission["targets"]] == [item, {"external_id": "", "attributes": {}}]
    path = f"missions/{mission['id']}"
    changed = patch(client, path, {"external_id": "WO-2"}, **{"If-Match": made["ETag"]})
    assert given_of(changed.json()) == {"external_id": "WO-2", "attributes": ATTRIBUTES}
    assert changed.json()["state"] == "planned", "no plan hangs on it"
    assert changed["ETag"] != made["ETag"]
    entry = AuditEntry.objects.filter(subject_type="mission", subject_id=mission["id"]).latest("recorded_at")
    assert entry.before is not None and entry.after is not None
    assert (entry.action, entry.before["external_id"], entry.after["external_id"]) == ("change", "WO-4711", "WO-2")


def test_missions_are_found_by_their_external_id_and_by_those_of_their_targets(client: Client) -> None:
    here = world()
    target = {"asset": here.towers[1].pk, "external_id": "item-1"}
    post(client, "missions", mission_body(target, external_id="WO-1") | {"name": "A"})
    post(client, "missions", mission_body(here.towers[1], external_id="WO-1") | {"name": "B"})
    post(client, "missions", mission_body(here.towers[1]) | {"name": "C"})
    assert sorted(names(client, "missions?external_id=WO-1")) == ["A", "B"]
    assert names(client, "missions?target_external_id=item-1") == ["A"]
    assert names(client, "missions?external_id=WO-1&target_external_id=item-2") == []
    other = client_of(a_user(organisation=Organisation.objects.create(name="Other")))
    assert names(other, "missions?external_id=WO-1") == []


def test_copies_and_follow_ups_keep_them(client: Client) -> None:
    here, author = world(), a_user(Role.OPERATOR)
    made = post(client, "missions", mission_body({"asset": here.towers[1].pk, "external_id": "item-1"}, plan=True, **GIVEN)).json()
    mission = Mission.objects.get(pk=made["id"])
    Mission.objects.filter(pk=mission.pk).update(state=MissionState.COMPLETED)
    mission.refresh_from_db()
    for made_from_it in (duplicate_mission(mission=mission, author=author), draft_follow_up(mission=mission, author=author)):
        assert (made_from_it.external_id, made_from_it.attributes) == ("WO-4711", ATTRIBUTES)
        assert [target.external_id for target in made_from_it.targets.all()] == ["item-1"]


@pytest.mark.parametrize(
    ("given", "field"),
    [
        ({"external_id": "x" * 201}, "external_id"),
        ({"external_id": "line\nline"}, "external_id"),
        ({"external_id": 7.5e300}, "external_id"),
        ({"attributes": {f"name{number}": 1 for number in range(51)}}, "attributes"),
        ({"attributes": {"long": "x" * 8_000}}, "attributes"),
        ({"attributes": {"list": [1]}}, "attributes"),
        ({"attributes": {"object": {"a": 1}}}, "attributes"),
        ({"attributes": {"nothing": None}}, "attributes"),
        ({"attributes": {"tab\t": 1}}, "attributes"),
        ({"attributes": {"name": "a\u2028b"}}, "attributes"),
        ({"attributes": []}, "attributes"),
        ({"attributes": None}, "attributes"),
    ],
)
def test_what_is_out_of_bounds_is_refused_by_its_field(client: Client, given: dict[str, Any], field: str) -> None:
    answer = post(client, "uavs", KITE | given)
    assert answer.status_code == 400, answer.content
    assert field in answer.json()["error"]["details"]


def test_the_bounds_themselves_are_taken(client: Client) -> None:
    empty = len('{"a":""}')
    for given in (
        {"external_id": "x" * 200},
        {"attributes": {f"n{number}": 1 for number in range(50)}},
        {"attributes": {"a": "x" * (8_000 - empty)}},
    ):
        answer = post(client, "uavs", KITE | given | {"name": f"Kite {len(str(given))}"})
        assert answer.status_code == 201, answer.content


def test_a_filter_that_is_no_id_is_refused(client: Client) -> None:
    for path in ("uavs", "missions", "assets"):
        answer = client.get(f"/api/v1/{path}", {"external_id": "x" * 201})
        assert answer.status_code == 400, path
        assert "external_id" in answer.json()["error"]["details"]
