"""UAVs of a mission are started in planned order by the server: each when it is due and may, and none after a stop."""

from datetime import datetime, timedelta

import pytest
from django.utils import timezone

from missions.models import CommandKind, CommandState, Mission, MissionUav, PlannedStarts, UavCommand
from missions.services.commands.commands import note_sent
from missions.services.commands.dispatch import abort_mission
from missions.services.commands.planned_starts import LEAD_S, MAX_GAP_S, begin_planned_starts, carry_on_planned_starts, stop_planned_starts
from missions.services.commands.refused import Refused
from missions.services.commands.steering import command_uav
from telemetry.models import UavLink, UavWatch
from tests.accounts.users import a_user, client_of
from tests.missions.api import post
from tests.missions.commands.outbox import claim, fence
from tests.missions.flights import an_operator, approved, carry, dispatched, fleet
from tests.missions.worlds import world
from tests.telemetry.records import received
from workspace.models import Organisation, Role, User

pytestmark = pytest.mark.django_db


@pytest.fixture
def person() -> User:
    return an_operator()


@pytest.fixture
def crossing(person: User) -> tuple[Mission, MissionUav, MissionUav]:
    """Two UAVs whose routes cross and are kept apart by a delay; the one that departs first comes first. Both have their routes."""
    here, uavs = world(), fleet("Tern", "Kite")
    mission = dispatched(person, uavs, here.towers[4:6])
    carry(*uavs)
    received(*uavs)
    first, second = mission.mission_uavs.select_related("uav", "route").order_by("route__departs_s")
    assert second.route.departs_s - first.route.departs_s > 20.0
    return mission, first, second


def passes(starts: PlannedStarts, seconds: float) -> None:
    """All that was written down is so much older."""
    back = timedelta(seconds=seconds)
    starts.refresh_from_db()
    moved = [entry | {"due_at": (datetime.fromisoformat(entry["due_at"]) - back).isoformat()} for entry in starts.uavs]
    created_at = starts.created_at - back
    PlannedStarts.objects.filter(pk=starts.pk).update(uavs=moved, created_at=created_at)
    for command in UavCommand.objects.filter(kind=CommandKind.START):
        finished_at = None if command.finished_at is None else command.finished_at - back
        UavCommand.objects.filter(pk=command.pk).update(created_at=command.created_at - back, finished_at=finished_at)


def started() -> list[str]:
    return list(UavCommand.objects.filter(kind=CommandKind.START).order_by("created_at").values_list("uav__name", flat=True))


def states(starts: PlannedStarts) -> list[str]:
    starts.refresh_from_db()
    return [entry["state"] for entry in starts.uavs]


def test_each_is_started_at_its_planned_distance_in_time(crossing, person) -> None:
    mission, first, second = crossing
    starts = begin_planned_starts(mission=mission, actor=person)
    assert [entry["uav"] for entry in starts.uavs] == [first.uav_id, second.uav_id]
    first_due, second_due = (datetime.fromisoformat(entry["due_at"]) for entry in starts.uavs)
    assert (second_due - first_due).total_seconds() == pytest.approx(second.route.departs_s - first.route.departs_s)
    carry_on_planned_starts()
    assert started() == [], "there is time to stop the first one"
    passes(starts, LEAD_S)
    carry_on_planned_starts()
    assert started() == [first.name]
    carry(first.uav)
    carry_on_planned_starts()
    assert started() == [first.name]
    passes(starts, second.route.departs_s - first.route.departs_s)
    carry_on_planned_starts()
    assert started() == [first.name, second.name]
    assert (states(starts), starts.end) == (["started", "started"], "done")
    carry_on_planned_starts()
    assert started() == [first.name, second.name]


def test_one_waits_for_the_actual_state_of_those_in_the_air(crossing, person) -> None:
    """The first was started late: the second is due by its plan, and waits all the same."""
    mission, first, second = crossing
    starts = begin_planned_starts(mission=mission, actor=person)
    passes(starts, LEAD_S + second.route.departs_s - first.route.departs_s)
    carry_on_planned_starts()
    assert started() == [first.name]
    carry(first.uav)
    carry_on_planned_starts()
    assert (started(), states(starts)) == ([first.name], ["started", "waiting"])
    assert "It can be started in" in starts.uavs[1]["why"] or "Wait until" in starts.uavs[1]["why"]
    passes(starts, second.route.departs_s - first.route.departs_s)
    carry_on_planned_starts()
    assert (started(), states(starts)) == ([first.name, second.name], ["started", "started"])


def test_a_stop_starts_nobody_more_and_withdraws_what_was_not_sent(crossing, person) -> None:
    mission, first, _second = crossing
    starts = begin_planned_starts(mission=mission, actor=person)
    passes(starts, LEAD_S)
    carry_on_planned_starts()
    stop_planned_starts(mission=mission, actor=person)
    command = UavCommand.objects.get(kind=CommandKind.START)
    assert (command.state, command.outcome_code) == (CommandState.EXPIRED, "withdrawn")
    assert claim(first.uav) == []
    passes(starts, 3_600.0)
    carry_on_planned_starts()
    assert started() == [first.name]
    starts.refresh_from_db()
    assert (starts.end, starts.ended_by) == ("stopped", person)
    with pytest.raises(Refused):
        stop_planned_starts(mission=mission, actor=person)


def test_a_start_that_was_sent_is_not_withdrawn(crossing, person) -> None:
    mission, first, _second = crossing
    starts = begin_planned_starts(mission=mission, actor=person)
    passes(starts, LEAD_S)
    carry_on_planned_starts()
    (command,) = claim(first.uav)
    assert note_sent(command.pk, **fence(command))
    stop_planned_starts(mission=mission, actor=person)
    command.refresh_from_db()
    assert command.state == CommandState.SENT


@pytest.mark.parametrize("kind", ["pause", "hold", "return", "land", "abort"])
def test_whoever_stops_a_uav_of_the_mission_stops_the_starts(crossing, person, kind: str) -> None:
    mission, first, _second = crossing
    starts = begin_planned_starts(mission=mission, actor=person)
    passes(starts, LEAD_S)
    carry_on_planned_starts()
    carry(first.uav)
    command_uav(uav=first.uav, kind=CommandKind(kind), actor=person)
    passes(starts, 3_600.0)
    carry_on_planned_starts()
    starts.refresh_from_db()
    assert (started(), starts.end) == ([first.name], "commanded")


def test_an_abort_ends_the_starts(crossing, person) -> None:
    mission, _first, _second = crossing
    starts = begin_planned_starts(mission=mission, actor=person)
    abort_mission(mission=mission, actor=person, why="Storm")
    passes(starts, 3_600.0)
    carry_on_planned_starts()
    starts.refresh_from_db()
    assert (started(), starts.end) == ([], "mission-over")


def test_starts_that_nobody_looked_after_for_a_minute_are_not_made_up_for(crossing, person) -> None:
    mission, _first, _second = crossing
    starts = begin_planned_starts(mission=mission, actor=person)
    passes(starts, MAX_GAP_S + 1.0)
    PlannedStarts.objects.update(looked_at=timezone.now() - timedelta(seconds=MAX_GAP_S + 1.0))
    carry_on_planned_starts()
    starts.refresh_from_db()
    assert (started(), starts.end) == ([], "interrupted")


def test_one_that_is_refused_is_left_and_the_others_go_on(crossing, person) -> None:
    mission, first, second = crossing
    starts = begin_planned_starts(mission=mission, actor=person)
    first.route.has_failed = True
    first.route.save()
    passes(starts, LEAD_S + second.route.departs_s - first.route.departs_s)
    carry_on_planned_starts()
    assert (started(), states(starts)) == ([second.name], ["refused", "started"])
    assert "has failed" in starts.uavs[0]["why"]


def test_one_that_was_started_alone_meanwhile_is_not_started_twice(crossing, person) -> None:
    mission, first, _second = crossing
    starts = begin_planned_starts(mission=mission, actor=person)
    command_uav(uav=first.uav, kind=CommandKind.START, actor=person)
    passes(starts, 0.0)
    PlannedStarts.objects.update(created_at=timezone.now() - timedelta(minutes=1))
    passes(starts, LEAD_S)
    carry_on_planned_starts()
    assert started() == [first.name]


def test_nothing_begins_before_each_has_its_route(person) -> None:
    here, uavs = world(), fleet("Tern", "Kite")
    mission, _approval = approved(person, uavs, here.towers[4:6])
    with pytest.raises(Refused, match="Only an uploaded mission"):
        begin_planned_starts(mission=mission, actor=person)
    other = dispatched(person, fleet("Crow", "Rook"), here.towers[1:3], name="North")
    with pytest.raises(Refused) as error:
        begin_planned_starts(mission=other, actor=person)
    assert [reason.code for reason in error.value.reasons] == ["not_loaded", "not_loaded"]


@pytest.mark.parametrize("names_uavs", [False, True])
def test_none_is_started_that_nobody_hears(crossing, person, names_uavs) -> None:
    mission, *places = crossing
    for reported in (UavLink, UavWatch):
        reported.objects.all().delete()
    with pytest.raises(Refused) as error:
        begin_planned_starts(mission=mission, actor=person, uavs=[place.uav_id for place in places] if names_uavs else None)
    assert [reason.code for reason in error.value.reasons] == ["link", "link"]


def test_over_the_api(crossing, person) -> None:
    mission, first, second = crossing
    client, path = client_of(person), f"missions/{mission.pk}/planned-starts"
    reported = client.get(f"/api/v1/{path}").json()
    assert (reported["starts"], [entry["name"] for entry in reported["waiting"]]) == (None, [first.name, second.name])
    assert reported["waiting"][1]["after_s"] == pytest.approx(second.route.departs_s - first.route.departs_s)
    begun = post(client, path)
    assert begun.status_code == 201, begun.content
    assert [entry["name"] for entry in begun.json()["uavs"]] == [first.name, second.name]
    assert post(client, path).json()["error"]["code"] == "already_starting"
    (listed,) = client.get("/api/v1/planned-starts").json()["results"]
    assert (listed["mission"], listed["mission_name"], listed["end"]) == (str(mission.pk), mission.name, "")
    stopped = client.delete(f"/api/v1/{path}")
    assert (stopped.status_code, stopped.json()["end"], stopped.json()["ended_by"]) == (200, "stopped", person.username)
    assert client.get(f"/api/v1/{path}").json()["starts"]["end"] == "stopped"
    assert client.delete(f"/api/v1/{path}").status_code == 409
    assert client_of(a_user(role=Role.VIEWER)).delete(f"/api/v1/{path}").status_code == 403
    stranger = client_of(a_user(organisation=Organisation.objects.create(name="Elsewhere")))
    assert post(stranger, path).status_code == 404
    assert stranger.get("/api/v1/planned-starts").json()["results"] == []
