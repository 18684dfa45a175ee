"""Rehearsals over the API: who may, what is asked, what is answered, in words."""

from pathlib import Path
from unittest import mock

import pytest
from django.db.models import F

from missions.models import Mission, UavType
from simulation.models import Rehearsal, RehearsalRule
from tests.accounts.users import a_user, client_of
from tests.missions.api import post
from tests.missions.flights import an_operator, fleet, ground, planned
from tests.missions.worlds import world
from tests.simulation.rehearsals.rehearsed import asked, rehearsed
from workspace.models import AuditEntry, JobState, Organisation, Role, User

pytestmark = pytest.mark.django_db


@pytest.fixture
def person() -> User:
    return an_operator()


@pytest.fixture
def mission(person: User, tmp_path: Path) -> Mission:
    here = world()
    ground(tmp_path / "ground.tif")
    return planned(person, fleet(), [here.towers[0]])


@pytest.fixture(autouse=True)
def no_queue():
    with mock.patch("workspace.tasks.current_app.send_task") as sent:
        yield sent


def path(mission: Mission, rest: str = "") -> str:
    return f"missions/{mission.pk}/rehearsals{rest}"


def put(client, address: str, body):
    return client.put(f"/api/v1/{address}", body, content_type="application/json")


def test_an_operator_starts_one_and_is_told_where_to_look(
    mission: Mission, person: User, django_capture_on_commit_callbacks, no_queue
) -> None:
    own = {"name": "Storm", "wind": [{"altitude_agl_m": 10, "speed_mps": 9, "from_deg": 90}], "gusts_mps": 3, "battery_percent": 70}
    with django_capture_on_commit_callbacks(execute=True):
        answer = post(client_of(person), path(mission), {"conditions": ["calm", "strong-wind", own]})
    body = answer.json()
    assert answer.status_code == 202
    assert answer.headers["Location"] == f"/api/v1/{path(mission)}/{body['id']}"
    assert [run["words"] for run in body["runs"]] == ["Calm", "Strong wind", "Storm"]
    assert body["runs"][1]["conditions"]["gusts_mps"] == 2.0
    assert body["runs"][2]["conditions"]["turbulence_mps_at_20ft"] == 9.0
    assert (body["state"], body["level"], body["is_simulated"], body["is_outdated"]) == ("queued", "", True, False)
    assert no_queue.call_args.args == ("simulation.tasks.rehearse_mission",)


@pytest.mark.parametrize(
    ("conditions", "place"),
    [
        (["sunny"], "conditions.0"),
        ([{"gusts_mps": 99}], "conditions.0.gusts_mps"),
        ([{"wind": [{"altitude_agl_m": 10, "speed_mps": 900, "from_deg": 0}]}], "conditions.0.wind[0].speed_mps"),
        ([{"rain": 3}], "conditions.0.rain"),
        ([7], "conditions.0.conditions"),
        (["own"], "conditions.0.conditions"),
    ],
)
def test_conditions_that_cannot_be_are_named(mission: Mission, person: User, conditions: list[object], place: str) -> None:
    answer = post(client_of(person), path(mission), {"conditions": conditions})
    assert answer.status_code == 400
    assert list(answer.json()["error"]["details"]) == [place]


def test_a_viewer_reads_and_starts_nothing(mission: Mission, person: User) -> None:
    rehearsal = asked(mission, person)
    viewer = client_of(a_user(Role.VIEWER))
    assert viewer.get(f"/api/v1/{path(mission)}").json()["results"][0]["id"] == str(rehearsal.pk)
    assert post(viewer, path(mission)).status_code == 403
    assert post(viewer, path(mission, f"/{rehearsal.pk}/cancel")).status_code == 403


def test_another_organisation_finds_nothing(mission: Mission, person: User) -> None:
    rehearsal = asked(mission, person)
    stranger = client_of(a_user(Role.OPERATOR, Organisation.objects.create(name="Other")))
    addresses = [path(mission), path(mission, f"/{rehearsal.pk}"), path(mission, f"/{rehearsal.pk}/track")]
    assert [stranger.get(f"/api/v1/{address}").status_code for address in addresses] == [404, 404, 404]
    assert post(stranger, path(mission)).status_code == 404
    assert post(stranger, path(mission, f"/{rehearsal.pk}/cancel")).status_code == 404


@pytest.mark.long
def test_the_verdict_says_in_words_by_route_and_target_why(mission: Mission, person: User) -> None:
    mission.mission_uavs.update(performance={"battery_wh": 11.1})
    rehearsal = rehearsed(mission, person, "calm")
    body = client_of(person).get(f"/api/v1/{path(mission)}/{rehearsal.pk}").json()
    assessment = body["runs"][0]["assessment"]
    (target,) = assessment["routes"][0]["targets"]
    percent = round(assessment["routes"][0]["energy"][0]["left_percent"])
    assert body["level"] == target["level"] == "fail"
    assert target["reasons"] == [f"{percent} % battery at return, limit 20 %"]
    assert f"{percent} % battery at return, limit 20 %" in assessment["findings"][0]["message"]
    assert assessment["findings"][0]["message"].startswith("target 1 ")
    assert body["uavs"][0]["words"] == "Tern: the simulated Iris, the nearest by mass and endurance, with its own battery of 11 Wh"
    limit = next(one for one in body["limits"] if one["name"] == "obstacle_fail_m")
    assert (limit["value"], limit["source"]) == (5.0, "arms of a tower beside its middle")
    track = client_of(person).get(f"/api/v1/{path(mission)}/{rehearsal.pk}/track?run=0").json()
    (route,) = track["routes"]
    assert track["is_simulated"] and len(route["flights"][0]["t_s"]) == len(route["flights"][0]["battery_percent"])
    assert route["planned"][1]["target"] == 0


def test_what_was_rehearsed_is_out_of_date_once_the_plan_is_another_one(mission: Mission, person: User) -> None:
    rehearsal = rehearsed(mission, person, "calm")
    Mission.objects.filter(pk=mission.pk).update(departs_at="2031-05-01T10:00:00Z")
    client = client_of(person)
    assert client.get(f"/api/v1/{path(mission)}").json()["results"][0]["is_outdated"]
    assert client.get(f"/api/v1/{path(mission)}/{rehearsal.pk}/track").json()["routes"][0]["planned"] == []


@pytest.mark.long
def test_the_list_marks_a_mission_whose_present_plan_failed_its_rehearsal(mission: Mission, person: User) -> None:
    client = client_of(person)

    def is_marked() -> bool:
        (row,) = client.get("/api/v1/missions").json()["results"]
        return row["has_failed_rehearsal"]

    assert not is_marked()
    mission.mission_uavs.update(performance={"battery_wh": 11.1})
    assert rehearsed(mission, person, "calm").level == "fail"
    assert is_marked()
    Mission.objects.filter(pk=mission.pk).update(departs_at="2031-05-01T10:00:00Z", revision=F("revision") + 1)  # another plan
    assert not is_marked()


def test_one_that_waits_is_cancelled_at_once(mission: Mission, person: User) -> None:
    rehearsal = asked(mission, person)
    answer = post(client_of(person), path(mission, f"/{rehearsal.pk}/cancel"))
    assert answer.json()["state"] == JobState.CANCELLED
    assert AuditEntry.objects.filter(action="cancel-rehearsal", subject_id=str(mission.pk)).count() == 1


def test_nobody_has_more_open_than_allowed(mission: Mission, person: User, settings) -> None:
    settings.MAX_OPEN_REHEARSALS = 1
    client = client_of(person)
    assert post(client, path(mission)).status_code == 202
    assert post(client, path(mission)).status_code == 429
    assert Rehearsal.objects.count() == 1


def test_administrators_alone_ask_for_rehearsals_before_approval(mission: Mission, person: User) -> None:
    assert put(client_of(person), "rehearsal-rule", {"requires_green": True}).status_code == 403
    boss = a_user(Role.ADMINISTRATOR)
    assert put(client_of(boss), "rehearsal-rule", {"requires_green": True}).json() == {"requires_green": True}
    assert RehearsalRule.objects.get().organisation_id == person.organisation_id
    refused = post(client_of(person), f"missions/{mission.pk}/approve")
    assert refused.status_code == 409
    assert refused.json()["error"]["details"]["reasons"][0]["code"] == "not_rehearsed"
    assert "Rehearse the mission first" in refused.json()["error"]["message"]


def test_an_airframe_is_chosen_for_a_type(person: User) -> None:
    uav_type = UavType.objects.create(organisation=person.organisation, name="Heavy", mass_kg=3.9, battery_wh=270.0, range_unlimited=True)
    client, address = client_of(person), f"uav-types/{uav_type.pk}/airframe"
    assert client.get(f"/api/v1/{address}").json() == {"airframe": None, "flown": "inspector"}
    assert put(client, address, {"airframe": "iris"}).json() == {"airframe": "iris", "flown": "iris"}
    assert put(client, address, {"airframe": "teapot"}).status_code == 400
    assert put(client, address, {"airframe": None}).json() == {"airframe": None, "flown": "inspector"}
    assert {"iris", "inspector"} <= {row["code"] for row in client.get("/api/v1/airframes").json()["results"]}
