"""Closing a mission: a reason for each open target, then the report and the follow-up at once."""

from typing import Any

import pytest
from django.test import Client
from django.utils import timezone

from missions.models import Mission, MissionState, TargetState, Uav
from missions.services.commands.dispatch import abort_mission
from missions.services.commands.flight_progress import FlightEnd, mark_flight_ended, mark_started
from telemetry.models import UavLink
from tests.accounts.users import a_user, client_of
from tests.missions.api import post
from tests.missions.flights import dispatched, fleet
from tests.missions.worlds import World
from workspace.models import AuditEntry, Role, User

pytestmark = pytest.mark.django_db


@pytest.fixture
def mission(mission: Mission) -> Mission:
    mission.targets.filter(sequence=0).update(state=TargetState.COMPLETE, state_at=timezone.now())
    mission.targets.filter(sequence=1).update(state=TargetState.IN_PROGRESS, state_at=timezone.now())
    return mission


@pytest.fixture
def client(person: User) -> Client:
    return client_of(person)


REASONS = [{"target": 1, "reason": "Tern is in the field"}, {"target": 2, "reason": "too windy"}]


def close(client: Client, mission: Mission, reasons: list[dict[str, Any]] | None = None) -> Any:
    return post(client, f"missions/{mission.pk}/close", {"reasons": REASONS if reasons is None else reasons})


def test_a_mission_whose_uavs_are_down_is_closed_and_can_be_followed_up(client: Client, mission: Mission, person: User) -> None:
    answer = close(client, mission)
    assert (answer.status_code, answer.json()["state"]) == (200, MissionState.ABORTED), answer.content
    assert list(mission.targets.values_list("state", "state_reason")) == [
        ("complete", ""), ("skipped", "Tern is in the field"), ("skipped", "too windy"),
    ]  # fmt: skip
    record = client.get(f"/api/v1/missions/{mission.pk}/record").json()
    assert record["mission"]["ended_at"] is not None
    assert [target["reason"] and target["reason"]["message"] for target in record["targets"]][1:] == ["Tern is in the field", "too windy"]
    assert record["summary"]["results"]["not-inspected"] == 2
    follow_up = post(client, f"missions/{mission.pk}/follow-up", {})
    assert follow_up.status_code == 201 and len(follow_up.json()["targets"]) == 2
    entry = AuditEntry.objects.get(subject_id=str(mission.pk), action="close")
    assert entry.actor == person and entry.after["targets"] == {"1": "Tern is in the field", "2": "too windy"}


def test_each_open_target_needs_a_reason(client: Client, mission: Mission) -> None:
    answer = close(client, mission, REASONS[:1])
    assert (answer.status_code, answer.json()["error"]["code"]) == (409, "reason_missing")
    assert mission.targets.get(sequence=2).label in answer.json()["error"]["message"]
    mission.refresh_from_db()
    assert mission.state == MissionState.ACTIVE and not mission.targets.filter(state=TargetState.SKIPPED).exists()


def test_a_uav_in_the_air_keeps_its_mission_open(client: Client, mission: Mission, tern: Uav) -> None:
    UavLink.objects.update_or_create(uav=tern, defaults={"is_in_air": True, "last_message_at": timezone.now()})
    answer = close(client, mission)
    assert (answer.status_code, answer.json()["error"]["code"]) == (409, "in_the_air")
    assert "Tern is in the air" in answer.json()["error"]["message"]


def test_a_uav_that_flies_another_mission_by_now_does_not(client: Client, mission: Mission, tern: Uav, here: World, person: User) -> None:
    abort_mission(mission=mission, actor=person, why="thunderstorm")
    mark_started(mission_id=dispatched(person, [tern], [here.towers[2]], name="Afternoon").pk, uav_id=tern.pk)
    UavLink.objects.update_or_create(uav=tern, defaults={"is_in_air": True, "last_message_at": timezone.now()})
    assert close(client, mission).status_code == 200


def test_it_is_closed_after_an_abort_too_and_only_once(client: Client, mission: Mission, person: User) -> None:
    abort_mission(mission=mission, actor=person, why="thunderstorm")
    answer = close(client, mission)
    assert (answer.status_code, answer.json()["state"]) == (200, MissionState.ABORTED), answer.content
    assert mission.targets.filter(state=TargetState.SKIPPED).count() == 2
    again = close(client, mission)
    assert (again.status_code, again.json()["error"]["code"]) == (409, "nothing_open")


@pytest.mark.parametrize(("end", "state"), [(FlightEnd.FAILED, MissionState.FAILED), (FlightEnd.FLOWN, MissionState.COMPLETED)])
def test_it_has_the_state_of_its_flights(
    client: Client, mission: Mission, here: World, person: User, end: FlightEnd, state: MissionState
) -> None:
    two = fleet("Kite", "Rook")
    other = dispatched(person, two, [here.towers[2], here.towers[4]])
    mark_started(mission_id=other.pk, uav_id=two[0].pk)
    for uav in two[: 1 if end is FlightEnd.FAILED else 2]:
        mark_flight_ended(mission_id=other.pk, uav_id=uav.pk, flight=1, end=end)
    reasons = [{"target": place, "reason": "left"} for place in other.targets.values_list("sequence", flat=True)]
    if end is FlightEnd.FAILED:
        assert close(client, other, reasons).json()["state"] == state
    else:
        other.refresh_from_db()
        assert other.state == state and close(client, other, []).status_code == 409


def test_a_mission_that_was_not_started_is_taken_off_its_uavs(client: Client, here: World, person: User) -> None:
    uav = fleet("Kite")[0]
    other = dispatched(person, [uav], [here.towers[2]])
    answer = close(client, other, [{"target": 0, "reason": "no permission today"}])
    assert answer.json()["state"] == MissionState.ABORTED
    assert uav.commands.filter(kind="clear-mission").exists()


def test_a_draft_and_a_viewer_cannot(client: Client, mission: Mission) -> None:
    assert close(client_of(a_user(Role.VIEWER)), mission).status_code == 403
    answer = close(client, Mission.objects.create(name="Draft"), [])
    assert (answer.status_code, answer.json()["error"]["code"]) == (409, "not_sent")
