"""From findings to a draft of a mission: their targets once each, with the tasks and UAVs of then."""

from typing import Any

import pytest
from django.test import Client

from inspection.models import Asset
from missions.models import InspectionTarget, Mission
from results.models import Finding
from tests.accounts.users import a_user, client_of
from tests.inspection import ground
from workspace.models import Organisation, Role

pytestmark = pytest.mark.django_db
VIEWS = {"gsd_mm": 2.0, "camera_key": "sony-a7r-iv-55"}
PHOTOS = {"kind": "photo", "views": VIEWS}
LOOK_AGAIN = "/api/v1/findings/look-again"


@pytest.fixture
def client() -> Client:
    return client_of(a_user())


def post(client: Client, address: str, **body: Any) -> Any:
    return client.post(address, body, content_type="application/json")


def mission_at(client: Client, *towers: Asset, uav_name: str = "Tern", **target: Any) -> list[InspectionTarget]:
    body = {
        "name": "Spring", "objective": "makespan", "uavs": [{"name": uav_name, "position": [10.0, 55.99], "cruise_speed_mps": 12.0}],
        "targets": [{"asset": tower.pk, "task": PHOTOS} | target for tower in towers],
    }  # fmt: skip
    answer = post(client, "/api/v1/missions", **body)
    assert answer.status_code == 201, answer.json()
    return list(InspectionTarget.objects.filter(mission=answer.json()["id"]))


def finding(client: Client, **on: Any) -> str:
    answer = post(client, "/api/v1/findings", category="insulator-broken", severity=2, **on)
    assert answer.status_code == 201, answer.json()
    return str(answer.json()["id"])


def drafted(client: Client, *findings: str, **more: Any) -> Mission:
    answer = post(client, LOOK_AGAIN, findings=findings, **more)
    assert answer.status_code == 201, answer.json()
    return Mission.objects.get(pk=answer.json()["id"])


def test_the_targets_of_findings_are_taken_once_each_with_photos_and_uavs(client: Client) -> None:
    towers = [ground.tower((10.0 + number / 100, 56.0), ref=f"E401-{number}") for number in range(3)]
    targets = mission_at(client, *towers, uav_name="Tern")
    keys = [finding(client, target=targets[number].pk) for number in (2, 0, 2)]
    draft = drafted(client, *keys)
    assert [(row.asset_id, row.task["views"]["gsd_mm"]) for row in draft.targets.all()] == [(towers[2].pk, 2.0), (towers[0].pk, 2.0)]
    assert (draft.state, draft.objective, draft.departs_at) == ("draft", "makespan", None)
    assert [(row.name, row.start.coords) for row in draft.mission_uavs.all()] == [("Tern", (10.0, 55.99))]
    assert draft.name == "Look again: E401-2 and others"
    assert draft.pk != targets[0].mission_id


def test_of_several_missions_the_newest_gives_the_uavs_and_its_wishes_alone_name_one(client: Client) -> None:
    one, other = ground.tower((10.0, 56.0)), ground.tower((10.01, 56.0), ref="E401-9")
    first, second = mission_at(client, one, uav_name="Tern", uav="Tern"), mission_at(client, other, uav_name="Gull", uav="Gull")
    draft = drafted(client, finding(client, target=first[0].pk), finding(client, target=second[0].pk))
    assert [row.name for row in draft.mission_uavs.all()] == ["Gull"]
    assert [(row.asset_id, row.uav_name) for row in draft.targets.all()] == [(one.pk, ""), (other.pk, "Gull")]


def test_without_a_target_the_asset_is_looked_at_as_it_was_last(client: Client) -> None:
    tower, unseen = ground.tower((10.0, 56.0), ref="E401-1"), ground.tower((10.01, 56.0), ref="E401-2")
    mission_at(client, tower)
    alone = drafted(client, finding(client, asset=unseen.pk))
    assert (alone.name, alone.mission_uavs.count()) == ("Look again: E401-2", 0)
    draft = drafted(client, finding(client, asset=tower.pk), finding(client, asset=unseen.pk), name="After the storm")
    rows = list(draft.targets.all())
    assert [(row.asset_id, "views" in row.task, row.task["kind"]) for row in rows] == [
        (tower.pk, True, "photo"),
        (unseen.pk, False, "photo"),
    ]
    assert draft.name == "After the storm"


def test_what_is_gone_is_left_out_and_nothing_left_is_refused(client: Client) -> None:
    gone, there = ground.tower((10.0, 56.0)), ground.tower((10.01, 56.0))
    targets = mission_at(client, gone, there)
    keys = [finding(client, target=target.pk) for target in targets]
    gone.delete()
    assert [row.asset_id for row in drafted(client, *keys).targets.all()] == [there.pk]
    refused = post(client, LOOK_AGAIN, findings=keys[:1])
    assert (refused.status_code, refused.json()["error"]["code"]) == (409, "refused")
    Mission.objects.update(deleted_at="2026-11-01T00:00:00Z")
    assert [row.asset_id for row in drafted(client, keys[1]).targets.all()] == [there.pk]  # by its asset


def test_only_own_findings_by_those_who_plan(client: Client) -> None:
    tower = ground.tower((10.0, 56.0))
    key = finding(client, asset=tower.pk)
    stranger = client_of(a_user(organisation=Organisation.objects.create(name="Other")))
    assert post(stranger, LOOK_AGAIN, findings=[key]).status_code == 400
    assert post(client_of(a_user(Role.VIEWER)), LOOK_AGAIN, findings=[key]).status_code == 403
    for wrong in ([], ["x"], [key] * 501):
        assert post(client, LOOK_AGAIN, findings=wrong).status_code == 400
    assert Finding.objects.count() == 1
    assert Mission.objects.count() == 0
