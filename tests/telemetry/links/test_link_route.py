"""What a UAV gets when it asks for its route: its own, as it was approved, and the commands that wait for it."""

import hashlib
import json
from datetime import UTC, datetime, timedelta
from typing import Any

import pytest
from django.db import connection
from django.test.utils import CaptureQueriesContext

from missions.models import Approval, CommandKind, CommandState, Mission, MissionState, UavCommand
from missions.services.approval.approval import revoke_approval
from missions.services.commands.dispatch import abort_mission, dispatch_mission
from missions.services.commands.outbox import queue_command
from missions.services.missions import MissionChange, MissionFrozen, change_mission
from telemetry.models import Alert
from tests.missions.commands.outbox import lose
from tests.missions.flights import an_operator, approved, dispatched
from tests.missions.worlds import World
from tests.telemetry.links.uav_clients import UavClient, linked_uav
from workspace import prepared_statements
from workspace.models import User

pytestmark = pytest.mark.django_db


@pytest.fixture
def person() -> User:
    return an_operator()


@pytest.fixture
def kite() -> UavClient:
    return linked_uav("Kite", is_simulated=True)


def canonical_sha256(content: Any) -> str:
    """As docs/uav-link.md tells companions to make it."""

    def plain(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: plain(entry) for key, entry in value.items()}
        if isinstance(value, list):
            return [plain(entry) for entry in value]
        return int(value) if isinstance(value, float) and value.is_integer() else value

    return hashlib.sha256(json.dumps(plain(content), sort_keys=True, separators=(",", ":"), ensure_ascii=False).encode()).hexdigest()


def acknowledge(uav: UavClient, command: Any, state: str, **more: Any) -> dict[str, Any]:
    body = {"acknowledgements": [{"command": str(command), "state": state} | more]}
    answer = uav.post("acknowledgements", body)
    assert answer.status_code == 200, answer.content
    return answer.json()["results"][0]


def give(uav: UavClient, kind: CommandKind, **more: Any) -> UavCommand:
    return queue_command(uav=uav.uav, kind=kind, actor=None, **more)


def test_nothing_to_fly_is_an_empty_answer_and_then_the_same(kite: UavClient) -> None:
    first = kite.get("route")
    assert (first.status_code, first.content) == (204, b"")
    for known in (first["ETag"], f"W/{first['ETag']}"):
        again = kite.get("route", **{"If-None-Match": known})
        assert (again.status_code, again["ETag"]) == (304, first["ETag"])


def test_an_approved_mission_that_was_not_sent_is_not_given(here: World, person: User, kite: UavClient) -> None:
    approved(person, [kite.uav], [here.bridge])
    assert kite.get("route").status_code == 204


def test_a_uav_gets_its_route_as_it_was_approved_with_the_outline_of_the_bridge(here: World, person: User, kite: UavClient) -> None:
    mission = dispatched(person, [kite.uav], [here.bridge])
    given = kite.get("route").json()
    route, approval = given["route"], Approval.objects.get()
    assert (route["mission"], route["mission_name"], route["approval"]) == (str(mission.pk), mission.name, str(approval.pk))
    assert (route["content"]["flight"], route["flights"]) == (1, 1)
    stored = list(mission.routes.get().waypoints.order_by("sequence"))
    reported = route["content"]["waypoints"]
    assert [waypoint["position"] for waypoint in reported] == [list(waypoint.position.coords) for waypoint in stored]
    for waypoint, row in zip(reported, stored, strict=True):
        assert (waypoint["altitude_agl_m"], waypoint["altitude_relative_m"]) == (row.altitude_agl_m, row.altitude_relative_m)
        assert waypoint["altitude_amsl_m"] == row.altitude_amsl_m
    (target,) = route["targets"]
    assert (target["place"], target["kind"], target["label"]) == (0, "bridge", mission.targets.get().label)
    assert target["geometry"]["type"] in {"Polygon", "MultiPolygon", "LineString"}
    assert target["geometry"] == json.loads(here.bridge.geometry.json)
    assert [waypoint["target"] for waypoint in reported if waypoint["target"] is not None] == [0]
    assert canonical_sha256(route["content"]) == route["content_sha256"]
    assert [command["kind"] for command in given["commands"]] == ["upload-mission"]
    assert UavCommand.objects.get().state == CommandState.SENT


def test_a_poll_that_knows_the_answer_takes_three_small_statements(
    here: World, person: User, kite: UavClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    dispatched(person, [kite.uav], [here.towers[2]])
    etag = kite.get("route")["ETag"]
    attempts = UavCommand.objects.get().attempts
    statements: list[str] = []
    rows = prepared_statements._rows
    monkeypatch.setattr(prepared_statements, "_rows", lambda statement, values: (statements.append(statement), rows(statement, values))[1])
    with CaptureQueriesContext(connection) as asked:
        answer = kite.get("route", **{"If-None-Match": etag})
    assert (answer.status_code, answer.content) == (304, b"")
    assert (len(statements), len(asked)) == (3, 0)  # whose token, that it was heard, what is given
    assert UavCommand.objects.get().attempts == attempts


def test_an_answer_that_was_lost_is_given_again(here: World, person: User, kite: UavClient) -> None:
    dispatched(person, [kite.uav], [here.towers[2]])
    assert kite.get("route").json() == kite.get("route").json()
    lose(UavCommand.objects.get())
    given = kite.get("route").json()
    assert given["route"] is not None
    assert len(given["commands"]) == 1


def test_a_uav_gets_nothing_of_another_uavs(here: World, person: User, kite: UavClient) -> None:
    tern = linked_uav("Tern", is_simulated=True)
    dispatched(person, [kite.uav, tern.uav], [here.towers[1], here.towers[4]])
    routes = {uav.uav.name: uav.get("route").json()["route"] for uav in (kite, tern)}
    assert routes["Kite"]["content_sha256"] != routes["Tern"]["content_sha256"]
    assert [[target["place"] for target in route["targets"]] for route in routes.values()] in ([[0], [1]], [[1], [0]])
    assert linked_uav("Gull").get("route").status_code == 204
    for command in UavCommand.objects.filter(uav=tern.uav):
        assert acknowledge(kite, command.pk, "applied")["state"] is None
        assert UavCommand.objects.get(pk=command.pk).state == CommandState.SENT


def test_an_upload_is_applied_only_by_the_content_that_was_approved(here: World, person: User, kite: UavClient) -> None:
    dispatched(person, [kite.uav], [here.towers[2]])
    route = kite.get("route").json()["route"]
    assert acknowledge(kite, route["command"], "acknowledged")["state"] == "acknowledged"
    reported = acknowledge(kite, route["command"], "applied", content_sha256=route["content_sha256"])
    assert (reported["noted"], reported["state"]) == (True, "applied")
    kite.uav.connection.refresh_from_db()
    held = kite.uav.connection
    assert (held.loaded_sha256, str(held.loaded_approval), held.loaded_flight) == (route["content_sha256"], route["approval"], 1)
    assert kite.get("route").json()["commands"] == []
    assert kite.get("route").json()["route"] == route


@pytest.mark.parametrize("content", [None, "0" * 64])
def test_a_uav_that_holds_something_else_is_not_ready(here: World, person: User, kite: UavClient, content: str | None) -> None:
    dispatched(person, [kite.uav], [here.towers[2]])
    route = kite.get("route").json()["route"]
    reported = acknowledge(kite, route["command"], "applied", content_sha256=content)
    assert reported["state"] == "failed"
    command = UavCommand.objects.get()
    assert (command.state, command.outcome_code) == (CommandState.FAILED, "other-content")
    assert kite.uav.connection.loaded_sha256 == ""
    assert kite.get("route").status_code == 204
    alert = Alert.objects.get()
    assert (alert.level, alert.code, alert.uav, alert.closed_at) == ("critical", "holds-other-content", kite.uav, None)
    dispatch_mission(mission=Mission.objects.get(), actor=person)
    again = kite.get("route").json()["route"]
    acknowledge(kite, again["command"], "applied", content_sha256=again["content_sha256"])
    assert Alert.objects.get().closed_at is not None


def test_a_refusal_is_kept_in_the_uavs_words(kite: UavClient) -> None:
    command = give(kite, CommandKind.ARM)
    kite.get("route")
    acknowledge(kite, command.pk, "failed", reason="Compass not calibrated\x07")  # garbled, and it counts all the same
    command.refresh_from_db()
    assert (command.state, command.outcome_code, command.outcome) == (CommandState.FAILED, "refused-by-uav", "Compass not calibrated\x07")


def test_an_acknowledgement_that_is_sent_again_changes_nothing(kite: UavClient) -> None:
    command = give(kite, CommandKind.HOLD)
    kite.get("route")
    first, second = acknowledge(kite, command.pk, "applied"), acknowledge(kite, command.pk, "applied")
    assert first == second
    assert list(command.events.values_list("state", flat=True)) == ["queued", "sent", "applied"]
    late = acknowledge(kite, command.pk, "failed")
    assert (late["noted"], late["state"]) == (False, "applied")


def test_the_most_urgent_command_comes_first_and_a_later_one_takes_its_place(kite: UavClient) -> None:
    give(kite, CommandKind.CHANGE_SPEED, parameters={"speed_mps": 9})
    pause = give(kite, CommandKind.PAUSE)
    assert [command["kind"] for command in kite.get("route").json()["commands"]] == ["pause", "change-speed"]
    abort = give(kite, CommandKind.ABORT)
    waiting = kite.get("route").json()["commands"]
    assert [command["id"] for command in waiting] == [str(abort.pk)]
    reported = acknowledge(kite, pause.pk, "applied")
    assert (reported["noted"], reported["state"]) == (False, "expired")


def test_a_command_that_is_too_old_is_not_given(kite: UavClient) -> None:
    give(kite, CommandKind.ARM, expires_in_s=-1)
    assert kite.get("route").status_code == 204


def test_a_new_command_changes_the_answer_of_a_uav_that_knew_the_old_one(kite: UavClient) -> None:
    etag = kite.get("route")["ETag"]
    give(kite, CommandKind.RETURN)
    answer = kite.get("route", **{"If-None-Match": etag})
    assert answer.status_code == 200
    assert kite.get("route", **{"If-None-Match": answer["ETag"]}).status_code == 304


def test_a_command_goes_by_the_door_that_it_was_given_for(kite: UavClient) -> None:
    command = give(kite, CommandKind.HOLD)
    UavCommand.objects.filter(pk=command.pk).update(link="mavlink")
    assert kite.get("route").status_code == 204
    assert acknowledge(kite, command.pk, "applied")["state"] is None


def test_starting_makes_the_mission_active_and_aborting_takes_the_route_away(here: World, person: User, kite: UavClient) -> None:
    mission = dispatched(person, [kite.uav], [here.towers[2]])
    route = kite.get("route").json()["route"]
    acknowledge(kite, route["command"], "applied", content_sha256=route["content_sha256"])
    start = give(kite, CommandKind.START, mission=mission, approval=Approval.objects.get(), parameters={"flight": 1})
    kite.get("route")
    acknowledge(kite, start.pk, "applied")
    mission.refresh_from_db()
    assert mission.state == MissionState.ACTIVE
    assert kite.get("route").json()["route"] == route
    with pytest.raises(MissionFrozen):
        change_mission(mission=mission, actor=person, change=MissionChange(name="Other"))
    abort_mission(mission=mission, actor=person, why="test")
    given = kite.get("route").json()
    assert (given["route"], [command["kind"] for command in given["commands"]]) == (None, ["abort"])


def test_a_mission_that_is_revoked_is_taken_off_the_uav_first(here: World, person: User, kite: UavClient) -> None:
    mission = dispatched(person, [kite.uav], [here.towers[2]])
    route = kite.get("route").json()["route"]
    acknowledge(kite, route["command"], "applied", content_sha256=route["content_sha256"])
    revoke_approval(mission=mission, actor=person, reason="wind")
    given = kite.get("route").json()
    assert (given["route"], [command["kind"] for command in given["commands"]]) == (None, ["clear-mission"])
    acknowledge(kite, given["commands"][0]["id"], "applied")
    assert Mission.objects.get().state == MissionState.PLANNED
    assert kite.uav.connection.loaded_sha256 == ""


def test_a_uav_that_knows_the_answer_before_is_told_that_its_approval_was_revoked(here: World, person: User, kite: UavClient) -> None:
    mission = dispatched(person, [kite.uav], [here.towers[2]])
    given = kite.get("route")
    acknowledge(kite, given.json()["route"]["command"], "applied", content_sha256=given.json()["route"]["content_sha256"])
    etag = kite.get("route")["ETag"]
    assert kite.get("route", **{"If-None-Match": etag}).status_code == 304
    revoke_approval(mission=mission, actor=person, reason="wind")
    revoked = kite.get("route", **{"If-None-Match": etag})
    assert (revoked.status_code, revoked.json()["route"]) == (200, None)
    acknowledge(kite, revoked.json()["commands"][0]["id"], "applied")
    for known in (etag, revoked["ETag"]):
        assert kite.get("route", **{"If-None-Match": known}).status_code == 204, "neither answer is the present one"


def test_what_is_changed_on_the_ground_afterwards_changes_nothing_of_what_was_approved(here: World, person: User, kite: UavClient) -> None:
    mission, _ = approved(person, [kite.uav], [here.bridge])
    outline = json.loads(here.bridge.geometry.json)
    dispatch_mission(mission=mission, actor=person)
    here.bridge.geometry = here.bridge.centre.buffer(0.01)
    here.bridge.save()
    assert kite.get("route").json()["route"]["targets"][0]["geometry"] == outline


@pytest.mark.parametrize(
    "body",
    [
        {}, {"acknowledgements": []}, {"acknowledgements": [{"command": "x", "state": "applied"}]},
        {"acknowledgements": [{"command": "00000000-0000-4000-8000-000000000000", "state": "sent"}]},
        {"acknowledgements": [{"command": "00000000-0000-4000-8000-000000000000", "state": "applied", "content_sha256": "x"}]},
    ],
)  # fmt: skip
def test_what_is_no_acknowledgement_is_refused(kite: UavClient, body: dict[str, Any]) -> None:
    assert kite.post("acknowledgements", body).status_code == 400


def test_what_was_handed_over_and_not_answered_is_not_handed_over_when_its_time_is_over(kite: UavClient) -> None:
    """Its answer was lost: a start that came half a minute later would come when nobody expects it."""
    lost, here = give(kite, CommandKind.HOLD), give(kite, CommandKind.CHANGE_SPEED, parameters={"speed_mps": 5.0})
    assert len(kite.get("route").json()["commands"]) == 2
    acknowledge(kite, here.pk, "acknowledged")
    UavCommand.objects.update(expires_at=datetime.now(UTC) - timedelta(seconds=1))
    assert [command["id"] for command in kite.get("route").json()["commands"]] == [str(here.pk)]
    assert acknowledge(kite, lost.pk, "applied")["noted"], "it did arrive"


def test_a_mission_that_was_not_dropped_stays_an_alert(here: World, person: User, kite: UavClient) -> None:
    mission = dispatched(person, [kite.uav], [here.towers[2]])
    acknowledge(kite, kite.get("route").json()["route"]["command"], "applied", content_sha256="0" * 64)
    revoke_approval(mission=Mission.objects.get(pk=mission.pk), actor=person, reason="other")
    (clear,) = kite.get("route").json()["commands"]
    acknowledge(kite, clear["id"], "failed", reason="It is flying it.")
    assert Alert.objects.get().closed_at is None
