"""A mission after the mission: what was missed, asked for again."""

from typing import Any

import pytest
from django.test import Client

from missions.models import Mission, MissionState, TargetState
from tests.accounts.users import a_user, client_of
from tests.missions.api import mission_body, post
from tests.missions.worlds import World
from workspace.models import Organisation, Role

pytestmark = pytest.mark.django_db


@pytest.fixture
def client() -> Client:
    return client_of(a_user())


@pytest.fixture
def flown(client: Client, here: World) -> Mission:
    """Of four targets two were missed; it had a time to depart, and targets that were kept together."""
    task = {"kind": "hold", "hold_s": 12.0}
    targets = [{"asset": tower.pk, "task": task} for tower in here.towers[1:5]]
    body = mission_body(name="Bexley", plan=True) | {"targets": targets, "locks": [{"uav": "Tern", "targets": [0, 1]}]}
    answer = post(client, "missions", body)
    assert answer.status_code == 201, answer.content
    mission = Mission.objects.get(pk=answer.json()["id"])
    mission.targets.filter(sequence__in=(0, 2)).update(state=TargetState.COMPLETE)
    mission.targets.filter(sequence=1).update(state=TargetState.SKIPPED, state_reason="not-held")
    Mission.objects.filter(pk=mission.pk).update(state=MissionState.COMPLETED)
    mission.refresh_from_db()
    return mission


def follow_up(client: Client, mission: Mission, **body: Any) -> Any:
    return post(client, f"missions/{mission.pk}/follow-up", body)


def test_what_was_missed_becomes_a_draft_with_the_same_uavs_and_wishes(client: Client, flown: Mission, here: World) -> None:
    answer = follow_up(client, flown)
    assert answer.status_code == 201, answer.content
    draft = answer.json()
    assert (draft["state"], draft["name"], draft["departs_at"]) == ("draft", "Bexley – follow-up", None)
    assert [target["asset"] for target in draft["targets"]] == [here.towers[2].pk, here.towers[4].pk]
    assert {target["state"] for target in draft["targets"]} == {"pending"}
    row = Mission.objects.get(pk=draft["id"])
    assert list(row.targets.values_list("task__kind", flat=True)) == ["hold", "hold"] and row.locks == []
    assert [uav.name for uav in row.mission_uavs.all()] == [uav.name for uav in flown.mission_uavs.all()]
    assert post(client, f"missions/{draft['id']}/plan").status_code in {200, 202}
    assert follow_up(client, flown, name="Again").json()["name"] == "Again"


def test_what_another_mission_took_over_is_left_to_that_one(client: Client, flown: Mission, here: World) -> None:
    body = mission_body(here.towers[2], name="Continuation", plan=False)
    Mission.objects.filter(pk=post(client, "missions", body).json()["id"]).update(continues=flown)
    assert [target["asset"] for target in follow_up(client, flown).json()["targets"]] == [here.towers[4].pk]


def test_a_mission_that_missed_nothing_or_is_not_over_has_none(client: Client, flown: Mission) -> None:
    Mission.objects.filter(pk=flown.pk).update(state=MissionState.ACTIVE)
    under_way = follow_up(client, flown)
    assert (under_way.status_code, under_way.json()["error"]["code"]) == (409, "not_over")
    Mission.objects.filter(pk=flown.pk).update(state=MissionState.COMPLETED)
    flown.targets.update(state=TargetState.COMPLETE)
    whole = follow_up(client, flown)
    assert (whole.status_code, whole.json()["error"]["code"]) == (409, "nothing_missed")
    assert Mission.objects.count() == 1


def test_a_viewer_and_another_organisation_cannot(flown: Mission) -> None:
    assert follow_up(client_of(a_user(Role.VIEWER)), flown).status_code == 403
    stranger = client_of(a_user(Role.OPERATOR, Organisation.objects.create(name="Other")))
    assert follow_up(stranger, flown).status_code == 404
