"""A UAV without a type, or without any limit that was stated or waived on purpose, is not planned, approved, uploaded or started."""

from typing import Any

import pytest
from django.db import IntegrityError
from django.test import Client

from missions.models import CommandKind, Mission, MissionUav, Uav, UavType
from missions.selectors.planning_context import planning_context, read_targets
from missions.services import PlanRequest
from missions.services.approval.approval import approve_mission
from missions.services.commands.dispatch import dispatch_mission
from missions.services.commands.planned_starts import begin_planned_starts
from missions.services.commands.refused import Refused
from missions.services.commands.steering import command_uav
from tests.accounts.users import a_user, client_of
from tests.missions.api import mission_body, patch, plan_body, post
from tests.missions.commands.outbox import a_uav
from tests.missions.flights import approved, carry, dispatched, fleet
from tests.missions.worlds import UAV_AT, World, request, uav, world
from workspace.models import Role, User

pytestmark = pytest.mark.django_db

NO_TYPE = "Kite is incomplete: it has no type. Choose one on its page."
TAKE_OFF = {"altitude_relative_m": 20.0}
NO_RANGE = "Kite is incomplete: its range is not stated. State a range or a battery, or choose unlimited range for its type."


@pytest.fixture
def person() -> User:
    return a_user(Role.OPERATOR)


@pytest.fixture
def client(person: User) -> Client:
    return client_of(person)


def a_type(client: Client, **facts: Any) -> int:
    return int(post(client, "uav-types", {"name": "Quad", **facts}).json()["id"])


def kite(client: Client, **facts: Any) -> dict[str, Any]:
    made = post(client, "uavs", {"name": "Kite", "position": list(UAV_AT), **facts})
    assert made.status_code == 201, made.content
    feature: dict[str, Any] = made.json()
    return feature


def test_a_uav_saved_with_a_name_alone_lacks_a_type_and_a_range_and_returns_to_its_start(client: Client) -> None:
    properties = kite(client)["properties"]
    assert properties["missing"] == ["type", "range"]
    assert properties["end_action"] == "return"


@pytest.mark.parametrize(
    ("of_type", "own", "missing"),
    [
        ({}, {}, ["range"]),
        ({"max_range_m": 9_000.0}, {}, []),
        ({"range_unlimited": True}, {}, []),
        ({"battery_wh": 90.0, "mass_kg": 2.0}, {}, []),
        ({}, {"max_range_m": 9_000.0}, []),
        ({}, {"battery_wh": 90.0, "mass_kg": 2.0}, []),
    ],
)
def test_a_range_a_battery_or_a_type_that_is_unlimited_on_purpose_completes_it(
    client: Client, of_type: dict[str, Any], own: dict[str, Any], missing: list[str]
) -> None:
    assert kite(client, type=a_type(client, **of_type), **own)["properties"]["missing"] == missing


def test_a_type_has_a_range_or_none_on_purpose_but_not_both(client: Client) -> None:
    both = post(client, "uav-types", {"name": "Quad", "max_range_m": 9_000.0, "range_unlimited": True})
    assert both.status_code == 400
    assert both.json()["error"]["details"]["range_unlimited"] == ["State a range or choose unlimited range, not both."]
    limited = a_type(client, max_range_m=9_000.0)
    assert patch(client, f"uav-types/{limited}", {"range_unlimited": True}).status_code == 400
    assert patch(client, f"uav-types/{limited}", {"range_unlimited": True, "max_range_m": None}).json()["range_unlimited"] is True


def test_the_database_keeps_no_range_beside_an_unlimited_one() -> None:
    with pytest.raises(IntegrityError, match="uav_type_range_or_unlimited"):
        UavType.objects.create(name="Quad", max_range_m=9_000.0, range_unlimited=True)


@pytest.mark.parametrize(("typed", "words"), [(False, NO_TYPE), (True, NO_RANGE)])
def test_no_plan_uses_it_and_every_plan_says_why(client: Client, typed: bool, words: str) -> None:
    here = world()
    own = kite(client, **({"type": a_type(client)} if typed else {}))
    plan = post(client, "plans", plan_body(here.towers[0], uavs=[{"id": own["id"]}])).json()
    (warning,) = plan["warnings"]
    assert (warning["code"], warning["uav"], warning["message"]) == ("uav_incomplete", 0, words)
    assert words in plan["unassigned"][0]["message"]
    assert [route["targets"] for route in plan["routes"]] == [[]]
    reach = post(client, "reachability", {"uavs": [{"id": own["id"]}]}).json()
    assert [(one["code"], one["message"]) for one in reach["grounded"]] == [("uav_incomplete", words)]


def test_a_figure_of_the_request_does_not_complete_a_stored_uav(client: Client) -> None:
    here, own = world(), kite(client)
    plan = post(client, "plans", plan_body(here.towers[0], uavs=[{"id": own["id"], "max_range_m": 9_000.0}])).json()
    assert [warning["code"] for warning in plan["warnings"]] == ["uav_incomplete"]


def test_one_in_the_air_is_planned_whatever_it_lacks(client: Client, monkeypatch: pytest.MonkeyPatch) -> None:
    here, own = world(), kite(client)
    asked: PlanRequest = request(here.towers[0], uavs=(uav(name="Kite", **{"uav": own["id"]}),))
    ground, targets, deleted = read_targets(asked)
    assert planning_context(asked, ground, targets, deleted).out_of_service == {own["id"]: "without_type"}
    monkeypatch.setattr("missions.selectors.planning_context.uavs_in_the_air", lambda stored: set(stored))
    assert planning_context(asked, ground, targets, deleted).out_of_service == {}


def sent(person: User) -> tuple[Mission, Uav]:
    """A mission that its UAV holds, made before a type was needed."""
    (own,) = fleet("Kite")
    mission = dispatched(person, [own], world().towers[:1])
    carry(own)
    Uav.objects.filter(pk=own.pk).update(uav_type=None)
    own.refresh_from_db()
    return mission, own


def codes(refused: pytest.ExceptionInfo[Refused]) -> set[str]:
    return {reason.code for reason in refused.value.reasons}


def test_a_plan_made_before_is_not_approved(client: Client, person: User) -> None:
    here: World = world()
    own = a_uav(organisation=person.organisation)
    made = post(client, "missions", mission_body(here.towers[0], uavs=[{"id": own.pk}]))
    mission = Mission.objects.get(pk=post(client, f"missions/{made.json()['id']}/plan").json()["id"])
    assert mission.state == "planned"
    Uav.objects.filter(pk=own.pk).update(uav_type=None)
    answer = post(client, f"missions/{mission.pk}/approve")
    assert answer.status_code == 409
    assert ("uav_incomplete", NO_TYPE) in {(reason["code"], reason["message"]) for reason in answer.json()["error"]["details"]["reasons"]}
    with pytest.raises(Refused) as refused:
        approve_mission(mission=mission, actor=person)
    assert "uav_incomplete" in codes(refused)


def test_an_approved_mission_is_neither_uploaded_nor_started_with_it(person: User) -> None:
    mission, own = sent(person)
    with pytest.raises(Refused) as refused:
        dispatch_mission(mission=mission, actor=person, place=0)
    assert "uav_incomplete" in codes(refused)
    for kind in (CommandKind.START, CommandKind.ARM, CommandKind.TAKE_OFF):
        with pytest.raises(Refused) as refused:
            command_uav(uav=own, kind=kind, actor=person, parameters=TAKE_OFF if kind == CommandKind.TAKE_OFF else None)
        assert codes(refused) == {"uav_incomplete"}
    with pytest.raises(Refused) as refused:
        begin_planned_starts(mission=mission, actor=person)
    assert "uav_incomplete" in codes(refused)


def test_the_others_are_uploaded_while_one_that_has_its_route_lacks_its_type(person: User) -> None:
    tern, kite_ = fleet("Tern", "Kite")
    mission, _approval = approved(person, [tern, kite_], world().towers[4:6])
    places = {row.uav_id: row.sequence for row in mission.mission_uavs.all()}
    dispatch_mission(mission=mission, actor=person, place=places[kite_.pk])
    carry(kite_)
    Uav.objects.filter(pk=kite_.pk).update(uav_type=None)
    (sent_to,) = dispatch_mission(mission=mission, actor=person)
    assert sent_to.uav == tern
    with pytest.raises(Refused) as refused:
        dispatch_mission(mission=mission, actor=person, place=places[kite_.pk])
    assert "uav_incomplete" in codes(refused)


def test_it_is_always_held_and_called_back(person: User) -> None:
    _mission, own = sent(person)
    for kind in (CommandKind.HOLD, CommandKind.RETURN, CommandKind.ABORT):
        assert command_uav(uav=own, kind=kind, actor=person).kind == kind


def test_a_plan_without_it_is_out_of_date_once_it_is_complete(client: Client) -> None:
    here, own = world(), kite(client)
    made = post(
        client, "missions", mission_body(here.towers[0], uavs=[{"id": own["id"]}, {"name": "Tern", "position": list(UAV_AT)}])
    ).json()
    post(client, f"missions/{made['id']}/plan")
    assert client.get(f"/api/v1/missions/{made['id']}").json()["is_stale"] is False
    patch(client, f"uavs/{own['id']}", {"type": a_type(client, range_unlimited=True)})
    assert client.get(f"/api/v1/missions/{made['id']}").json()["is_stale"] is True
    assert UavType.objects.get().range_unlimited
    assert MissionUav.objects.filter(uav=own["id"]).exists()
