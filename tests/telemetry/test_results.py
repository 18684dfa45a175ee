"""`GET /api/v1/results`: what came of targets, over all missions of an organisation."""

from datetime import UTC, datetime, timedelta
from typing import Any

import pytest
from django.db import connection
from django.test import Client
from django.test.utils import CaptureQueriesContext

from inspection.models import AssetReference
from missions.models import InspectionTarget, Mission, TargetState, Uav
from missions.services.commands.flight_progress import mark_started
from telemetry.models import InspectionResult, TelemetryStream
from tests.accounts.users import a_user, client_of
from tests.missions.flights import an_operator, dispatched, fleet
from tests.missions.worlds import World
from workspace.models import Organisation, Role, User

pytestmark = pytest.mark.django_db
NOON = datetime(2026, 5, 4, 12, tzinfo=UTC)


@pytest.fixture
def person() -> User:
    return an_operator()


@pytest.fixture
def client(person: User) -> Client:
    return client_of(a_user(Role.VIEWER, person.organisation))


@pytest.fixture
def tern() -> Uav:
    return fleet("Tern")[0]


@pytest.fixture
def mission(here: World, person: User, tern: Uav) -> Mission:
    mission = dispatched(person, [tern], [here.towers[1], here.towers[3], here.bridge])
    mark_started(mission_id=mission.pk, uav_id=tern.pk)
    return mission


def settle(mission: Mission, place: int, at: datetime, state: TargetState = TargetState.COMPLETE) -> InspectionTarget:
    mission.targets.filter(sequence=place).update(state=state, state_at=at)
    return mission.targets.get(sequence=place)


def report(target: InspectionTarget, uav: Uav, at: datetime, sequence: int = 1) -> None:
    stream, _ = TelemetryStream.objects.get_or_create(uav=uav, link="http", key="boot")
    InspectionResult.objects.create(
        stream=stream, sequence=sequence, uav=uav, mission=target.mission, place=target.sequence, target=target, measured_at=at,
        received_at=at, outcome="complete", note="rust", values={"temperature_c": 41},
    )  # fmt: skip


def results(client: Client, **asked: Any) -> list[dict[str, Any]]:
    answer = client.get("/api/v1/results", asked)
    assert answer.status_code == 200, answer.content
    found: list[dict[str, Any]] = answer.json()["results"]
    return found


def places(client: Client, **asked: Any) -> list[int]:
    return [row["place"] for row in results(client, **asked)]


def test_a_row_has_what_was_planned_what_became_of_it_and_what_was_reported(
    client: Client, mission: Mission, tern: Uav, here: World
) -> None:
    Mission.objects.filter(pk=mission.pk).update(external_id="WO-1", departs_at=NOON)
    AssetReference.objects.create(organisation=mission.organisation, asset=here.towers[3], external_id="SAP-3")
    target = settle(mission, 1, NOON)
    InspectionTarget.objects.filter(pk=target.pk).update(external_id="item-1", attributes={"row": 1})
    report(target, tern, NOON)
    [row] = results(client)
    waypoint = target.waypoints.get()
    assert row["mission"]["external_id"] == "WO-1"
    assert client.get(row["mission"]["record"]).status_code == 200
    assert row["asset"] == {"id": here.towers[3].pk, "kind": "tower", "external_id": "SAP-3"}
    assert (row["place"], row["external_id"], row["attributes"]) == (1, "item-1", {"row": 1})
    assert row["position"] == list(here.towers[3].centre.coords)
    assert row["planned"]["uav"] == tern.pk
    assert row["planned"]["waypoint_sequence"] == waypoint.sequence
    planned_at = datetime.fromisoformat(row["planned"]["at"])
    assert (planned_at - NOON).total_seconds() == pytest.approx(waypoint.arrival_s, abs=0.001)
    assert (row["state"], datetime.fromisoformat(row["state_at"])) == ("complete", NOON)
    [reported] = row["reported"]
    assert (reported["uav"], reported["outcome"], reported["note"], reported["values"]) == (
        tern.pk, "complete", "rust", {"temperature_c": 41},
    )  # fmt: skip


def test_what_is_pending_is_no_result_and_the_newest_comes_first(client: Client, mission: Mission) -> None:
    settle(mission, 0, NOON)
    settle(mission, 2, NOON + timedelta(hours=1), TargetState.SKIPPED)
    mission.targets.filter(sequence=1).update(state=TargetState.PENDING, state_at=NOON)  # as a copy of a flown mission has it
    assert places(client) == [2, 0]


def test_results_are_asked_for_by_asset_time_and_mission(client: Client, mission: Mission, here: World) -> None:
    AssetReference.objects.create(organisation=mission.organisation, asset=here.towers[1], external_id="SAP-1")
    for place in range(3):
        settle(mission, place, NOON + timedelta(hours=place))
    one = (NOON + timedelta(hours=1)).isoformat()
    assert places(client, asset=here.towers[3].pk) == [1]
    assert places(client, external_id="SAP-1") == [0]
    assert places(client, **{"from": one}) == [2, 1]
    assert places(client, to=one) == [0]
    assert places(client, mission=str(mission.pk)) == [2, 1, 0]
    assert places(client, mission="00000000-0000-4000-8000-000000000000") == []


def test_what_was_reported_later_is_a_change(client: Client, mission: Mission, tern: Uav) -> None:
    report(settle(mission, 0, NOON), tern, NOON + timedelta(hours=2))
    settle(mission, 1, NOON)
    assert places(client, changed_since=(NOON + timedelta(hours=1)).isoformat()) == [0]
    assert places(client, changed_since=NOON.isoformat()) == [1, 0]


def test_nobody_reads_results_or_ids_of_another_organisation(client: Client, mission: Mission, here: World) -> None:
    other = Organisation.objects.create(name="Other")
    AssetReference.objects.create(organisation=other, asset=here.towers[1], external_id="theirs")
    settle(mission, 0, NOON)
    assert results(client)[0]["asset"]["external_id"] == ""
    assert places(client, external_id="theirs") == []
    assert results(client_of(a_user(Role.VIEWER, other))) == []


def test_results_of_a_deleted_mission_are_gone(client: Client, mission: Mission) -> None:
    settle(mission, 0, NOON)
    Mission.objects.filter(pk=mission.pk).update(deleted_at=NOON)
    assert results(client) == []


def test_pages_repeat_and_hide_nothing(client: Client, mission: Mission) -> None:
    for place in range(3):
        settle(mission, place, NOON)  # all at one moment
    path, found = "/api/v1/results?limit=1", []
    while path:
        page = client.get(path).json()
        found += [row["place"] for row in page["results"]]
        path = page["next"]
    assert sorted(found) == [0, 1, 2]


def test_more_rows_take_no_more_queries(client: Client, mission: Mission, tern: Uav) -> None:
    client.get("/api/v1/results")  # once a minute it is noted that somebody was here
    numbers = []
    for place in range(3):
        report(settle(mission, place, NOON), tern, NOON, sequence=place)
        with CaptureQueriesContext(connection) as queries:
            assert len(results(client)) == place + 1
        numbers.append(len(queries))
    assert numbers[0] == numbers[1] == numbers[2]


@pytest.mark.parametrize("asked", [{"asset": "x"}, {"mission": "x"}, {"from": "noon"}, {"to": "noon"}, {"changed_since": "noon"}])
def test_what_cannot_be_asked_for_is_refused_by_its_name(client: Client, asked: dict[str, str]) -> None:
    answer = client.get("/api/v1/results", asked)
    assert answer.status_code == 400
    assert list(answer.json()["error"]["details"]) == list(asked)
