"""One request commands the UAVs of a mission that have a route of it sent or in flight, and no others."""

from collections.abc import Iterator
from copy import deepcopy
from datetime import timedelta
from typing import Any

import pytest
from django.test import Client
from django.utils import timezone

from missions.models import CommandKind, Mission, Uav, UavCommand
from missions.services.approval.approval import approve_mission
from missions.services.commands.batch import BATCH_KINDS, Scope, UavAnswer, command_missions
from missions.services.commands.dispatch import dispatch_mission
from missions.services.commands.steering import command_uav, mission_in_hand
from telemetry.models import UavLink
from telemetry.selectors.in_the_air import BELIEVED_FOR
from tests.accounts.users import a_user, client_of
from tests.cases import RowsForAModule
from tests.missions.api import post
from tests.missions.commands.outbox import a_uav
from tests.missions.flights import approved, carry, dispatched, fleet, planned
from tests.missions.worlds import World
from workspace.models import Organisation, User

pytestmark = pytest.mark.django_db


@pytest.fixture
def person() -> User:
    return a_user()


@pytest.fixture
def client(person: User) -> Client:
    return client_of(person)


def flies(*uavs: Uav, in_air: bool | None = True) -> None:
    for uav in uavs:
        UavLink.objects.update_or_create(uav=uav, defaults={"is_in_air": in_air, "last_message_at": timezone.now()})


def started(mission: Mission, person: User, *uavs: Uav) -> None:
    carry(*uavs)
    for uav in uavs:
        command_uav(uav=uav, kind=CommandKind.START, actor=person, parameters={"out_of_slot": True})
        carry(uav)
    flies(*uavs)
    mission.refresh_from_db()


@pytest.fixture(scope="module")
def in_flight(world_of_the_module: World, rows_for_a_module: RowsForAModule) -> Iterator[list[Any]]:
    made: list[Any] = []

    def make() -> None:
        person, uavs = a_user(), fleet("Tern", "Kite", "Crow", "Rook")
        first, second = uavs[:2], uavs[2:]
        south = dispatched(person, first, world_of_the_module.towers[1:3], name="South")
        started(south, person, *first)
        north = dispatched(person, second, world_of_the_module.towers[1:3], name="North")
        started(north, person, *second)
        for place, uav in enumerate(second, start=len(first)):
            south.mission_uavs.create(uav=uav, name=uav.name, sequence=place, start=uav.location, cruise_speed_mps=10.0)
        made.extend((south, first, north, second))

    with rows_for_a_module(make):
        yield made


@pytest.fixture
def two(in_flight: list[Any], db: None) -> list[Any]:
    """Two missions in flight with two UAVs each. The first also lists the second's UAVs, and plans no route for them."""
    UavLink.objects.update(last_message_at=timezone.now())
    return deepcopy(in_flight)


def kinds_of(*uavs: Uav) -> list[str]:
    return list(UavCommand.objects.filter(uav__in=uavs).exclude(kind__in=["upload-mission", "start"]).values_list("kind", flat=True))


def given(mission: Mission, kind: str, person: User, *uavs: Uav) -> dict[str, UavAnswer]:
    scope = Scope(mission, [uav.pk for uav in uavs] if uavs else None)
    return {answer.name: answer for answer in command_missions(scopes=[scope], kind=CommandKind(kind), actor=person)}


def codes(answers: dict[str, UavAnswer]) -> dict[str, list[str]]:
    return {name: [reason.code for reason in answer.reasons] for name, answer in answers.items()}


@pytest.mark.parametrize("kind", sorted(BATCH_KINDS))
def test_a_batch_of_one_mission_leaves_the_others_uavs_untouched(two: Any, person: User, kind: str) -> None:
    south, first, _north, second = two
    if kind == "resume":
        given(south, "pause", person)
        carry(*first)
    before = len(kinds_of(*first))
    answers = given(south, kind, person)
    assert codes(answers) == {"Tern": [], "Kite": []}
    assert kinds_of(*first)[before:] or kinds_of(*first).count(kind) == 2
    assert kinds_of(*second) == []
    assert {command.mission_id for command in UavCommand.objects.filter(kind=kind)} == {south.pk}


@pytest.mark.parametrize("kind", sorted(BATCH_KINDS))
def test_uavs_of_another_mission_are_refused_by_the_service_and_not_only_by_the_page(two: Any, person: User, kind: str) -> None:
    south, _first, _north, second = two
    assert codes(given(south, kind, person, *second)) == {"Crow": ["not_in_mission"], "Rook": ["not_in_mission"]}
    assert kinds_of(*second) == []


def test_an_abort_of_one_mission_leaves_the_others_uavs_untouched(two: Any, client: Client) -> None:
    south, first, _north, second = two
    assert post(client, f"missions/{south.pk}/abort", {"why": "Storm"}).status_code == 200
    assert kinds_of(*first) == ["abort", "abort"]
    assert kinds_of(*second) == []


def test_a_route_that_is_planned_and_not_sent_does_not_take_its_uav_from_the_mission_that_it_flies(
    two: Any, here: World, person: User
) -> None:
    """South plans Gull and Wren and is sent to Gull alone; Wren flies North, which was sent before."""
    gull, wren = uavs = fleet("Gull", "Wren")
    south, _approval = approved(person, uavs, here.towers[1:3], name="South")
    north = planned(person, [wren], here.towers[:1], name="North")
    approve_mission(mission=north, actor=person)
    dispatch_mission(mission=north, actor=person)
    north.refresh_from_db()
    started(north, person, wren)
    dispatch_mission(mission=south, actor=person, place=0)
    south.refresh_from_db()
    flies(gull)
    assert mission_in_hand(wren) == north
    assert codes(given(south, "return", person)) == {"Gull": []}
    assert kinds_of(wren) == []
    assert codes(given(north, "pause", person)) == {"Wren": []}
    carry(wren)
    assert command_uav(uav=wren, kind=CommandKind.RESUME, actor=person).mission == north


def test_each_uav_is_answered_for_by_itself(two: Any, person: User) -> None:
    south, (tern, kite), _north, _second = two
    flies(kite, in_air=False)
    answers = given(south, "return", person)
    assert codes(answers) == {"Tern": [], "Kite": ["on_the_ground"]}
    assert answers["Tern"].command is not None
    assert answers["Kite"].command is None
    assert answers["Kite"].reasons[0].message == "Kite is on the ground."
    assert (kinds_of(tern), kinds_of(kite)) == (["return"], [])


def test_one_whose_start_was_sent_after_its_last_report_may_be_in_the_air(two: Any, person: User) -> None:
    south, (_tern, kite), _north, _second = two
    UavLink.objects.filter(uav=kite).update(is_in_air=False, last_message_at=timezone.now() - timedelta(minutes=5))
    assert codes(given(south, "return", person))["Kite"] == []


def test_one_that_never_connected_is_refused_with_that_reason(two: Any, person: User) -> None:
    south, (tern, _kite), _north, _second = two
    UavLink.objects.filter(uav=tern).delete()
    assert codes(given(south, "hold", person)) == {"Tern": ["never_connected"], "Kite": []}


def test_a_refusal_of_one_is_no_refusal_of_the_others(two: Any, person: User) -> None:
    """A return that waits is not called off by a hold."""
    south, (tern, _kite), _north, _second = two
    given(south, "return", person, tern)
    answers = given(south, "hold", person)
    assert {name: len(found) for name, found in codes(answers).items()} == {"Tern": 1, "Kite": 0}


def test_after_an_abort_those_in_the_air_are_still_reached(two: Any, person: User, client: Client) -> None:
    south, first, _north, second = two
    post(client, f"missions/{south.pk}/abort", {"why": "Storm"})
    carry(*first)
    south.refresh_from_db()
    assert codes(given(south, "land", person)) == {"Tern": [], "Kite": []}
    assert kinds_of(*second) == []


def test_several_missions_are_commanded_in_one_request(two: Any, person: User) -> None:
    south, first, north, second = two
    scopes = [Scope(south, [first[0].pk]), Scope(north, None)]
    answers = command_missions(scopes=scopes, kind=CommandKind.PAUSE, actor=person)
    assert [(answer.mission, answer.name, answer.is_accepted) for answer in answers] == [
        (south.pk, "Tern", True), (north.pk, "Crow", True), (north.pk, "Rook", True),
    ]  # fmt: skip
    assert kinds_of(first[1]) == []
    assert kinds_of(*second) == ["pause", "pause"]


def test_a_uav_that_was_on_the_ground_when_last_heard_long_ago_is_given_its_command(two: Any, person: User) -> None:
    south, (_tern, kite), _north, _second = two
    flies(kite, in_air=False)
    last_message_at = timezone.now() - BELIEVED_FOR - timedelta(seconds=1)
    UavLink.objects.filter(uav=kite).update(last_message_at=last_message_at)
    UavCommand.objects.filter(uav=kite).update(sent_at=last_message_at - timedelta(seconds=1))
    assert codes(given(south, "return", person)) == {"Tern": [], "Kite": []}


def test_over_the_api_one_request_is_answered_uav_by_uav(two: Any, client: Client) -> None:
    south, (tern, kite), _north, (crow, _rook) = two
    flies(kite, in_air=False)
    body = {"kind": "return", "uavs": [tern.pk, kite.pk, crow.pk], "why": "Storm"}
    headers = {"Idempotency-Key": "storm-1"}
    answer = post(client, f"missions/{south.pk}/commands", body, **headers)
    assert answer.status_code == 200, answer.content
    results = answer.json()["results"]
    assert [(one["name"], one["is_accepted"], [reason["code"] for reason in one["reasons"]]) for one in results] == [
        ("Tern", True, []), ("Kite", False, ["on_the_ground"]), ("Crow", False, ["not_in_mission"]),
    ]  # fmt: skip
    assert results[0]["command"]["why"] == "Storm"
    assert {one["mission"] for one in results} == {str(south.pk)}
    again = post(client, f"missions/{south.pk}/commands", body, **headers)
    assert again.json() == answer.json()
    assert again["Idempotency-Replayed"] == "true"
    assert kinds_of(tern, kite, crow) == ["return"]


def test_over_the_api_missions_are_named(two: Any, client: Client) -> None:
    south, first, north, second = two
    scopes = [{"mission": str(south.pk), "uavs": [first[0].pk]}, {"mission": str(north.pk)}]
    answer = post(client, "missions/commands", {"kind": "pause", "missions": scopes})
    assert [one["name"] for one in answer.json()["results"]] == ["Tern", "Crow", "Rook"]
    assert kinds_of(*second) == ["pause", "pause"]
    assert post(client, "missions/commands", {"kind": "pause"}).status_code == 400
    assert post(client, "missions/commands", {"kind": "pause", "missions": []}).status_code == 400


@pytest.mark.parametrize("kind", ["start", "abort", "upload-mission", "change-speed", "fly"])
def test_what_is_no_batch_is_refused(two: Any, client: Client, kind: str) -> None:
    south, first, _north, _second = two
    assert post(client, f"missions/{south.pk}/commands", {"kind": kind}).status_code == 400
    assert kinds_of(*first) == []


def test_another_organisations_missions_and_uavs_are_not_reached(two: Any, person: User, client: Client) -> None:
    south, _first, north, second = two
    strangers = Organisation.objects.create(name="Elsewhere")
    foreign = a_uav("Gull", strangers)
    flies(foreign)
    (one,) = post(client, f"missions/{south.pk}/commands", {"kind": "return", "uavs": [foreign.pk]}).json()["results"]
    assert (one["name"], one["is_accepted"], one["reasons"][0]["code"]) == ("", False, "not_in_mission")
    stranger = client_of(a_user(organisation=strangers))
    assert post(stranger, f"missions/{north.pk}/commands", {"kind": "return"}).status_code == 404
    scopes = [{"mission": str(north.pk)}]
    assert post(stranger, "missions/commands", {"kind": "return", "missions": scopes}).status_code == 404
    assert kinds_of(foreign, *second) == []


def test_a_mission_that_is_not_on_its_way_has_nobody_to_command(two: Any, here: World, person: User, client: Client) -> None:
    uavs = fleet("Gull")
    mission, _approval = approved(person, uavs, here.towers[:1])
    flies(*uavs)
    answer = post(client, f"missions/{mission.pk}/commands", {"kind": "return"})
    assert answer.status_code == 409
    assert answer.json()["error"]["code"] == "nobody_in_mission"
    assert codes(given(mission, "return", person, *uavs)) == {"Gull": ["not_in_mission"]}


def test_a_return_in_turn_lets_the_others_hold_first(two: Any, person: User, client: Client) -> None:
    south, (tern, kite), _north, _second = two
    ways = {str(kite.pk): {"wait_s": 40.0}}
    body = {"kind": "return", "uavs": [tern.pk, kite.pk], "ways": ways}
    answer = post(client, f"missions/{south.pk}/commands", body)
    assert answer.status_code == 200, answer.content
    assert {one["name"]: one["command"]["kind"] for one in answer.json()["results"]} == {"Tern": "return", "Kite": "hold"}
    carry(tern, kite)
    assert sorted(kinds_of(kite)) == ["hold", "return"] and kinds_of(tern) == ["return"]


@pytest.mark.parametrize(
    ("kind", "ways"), [("pause", {"1": {"wait_s": 40.0}}), ("return", {"x": {"wait_s": 40.0}}), ("return", {"1": {"wait_s": 1e6}})]
)
def test_ways_are_of_returns_and_of_uavs(kind: str, ways: dict[str, Any], two: Any, client: Client) -> None:
    south = two[0]
    answer = post(client, f"missions/{south.pk}/commands", {"kind": kind, "ways": ways})
    assert answer.status_code in (400, 409)
