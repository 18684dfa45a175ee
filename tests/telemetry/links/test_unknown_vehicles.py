"""Vehicles that nobody knows are adopted or ignored, by administrators alone; and what is told of a UAV's connection."""

from datetime import timedelta
from typing import Any

import pytest
from django.contrib.gis.geos import Point
from django.test import Client
from django.utils import timezone

from missions.models import TargetState, Uav, UavType
from telemetry.models import UavLink, UnknownVehicle, UnknownVehicleState
from tests.accounts.users import a_user, client_of
from tests.missions.api import post
from tests.missions.commands.outbox import a_uav
from tests.missions.flights import an_operator, dispatched
from tests.missions.worlds import world
from tests.telemetry.links.uav_clients import linked_uav, report, seconds_ago
from workspace.models import AuditEntry, Organisation, Role

pytestmark = pytest.mark.django_db


@pytest.fixture
def client() -> Client:
    return client_of(a_user(Role.ADMINISTRATOR))


def vehicle(system_id: int = 41, place: Point | None = None, **facts: Any) -> UnknownVehicle:
    last_message_at = facts.pop("last_message_at", timezone.now())
    return UnknownVehicle.objects.create(
        mavlink_system_id=system_id, location=place, last_message_at=last_message_at, autopilot="px4", **facts
    )


def listed(client: Client, query: str = "") -> list[int]:
    answer = client.get(f"/api/v1/unknown-vehicles{query}")
    assert answer.status_code == 200
    return [row["mavlink_system_id"] for row in answer.json()["results"]]


def test_new_ones_are_listed_the_last_heard_first(client: Client) -> None:
    assert listed(client) == []
    now = timezone.now()
    vehicle(41, last_message_at=now - timedelta(hours=1))
    vehicle(42, Point(9.5, 47.1), last_message_at=now)
    vehicle(43, state=UnknownVehicleState.IGNORED)
    assert listed(client) == [42, 41]
    assert listed(client, "?state=ignored") == [43]
    assert client.get("/api/v1/unknown-vehicles?state=lost").status_code == 400
    row = client.get("/api/v1/unknown-vehicles").json()["results"][0]
    assert (row["position"], row["autopilot"], row["is_signed"], row["uav"]) == ([9.5, 47.1], "px4", False, None)


def test_a_uav_that_exists_gets_the_system_id(client: Client) -> None:
    kite, found = a_uav("Kite", link="http"), vehicle(41)
    answer = post(client, f"unknown-vehicles/{found.pk}/adopt", {"uav": kite.pk})
    facts = answer.json()["properties"]
    assert (answer.status_code, facts["mavlink_system_id"], facts["link"]) == (200, 41, "mavlink")
    found.refresh_from_db()
    assert (found.state, found.uav, found.settled_by is not None) == (UnknownVehicleState.ADOPTED, kite, True)
    assert AuditEntry.objects.filter(subject_type="unknown_vehicle", action="settle").count() == 1
    assert listed(client) == []


def test_a_new_uav_is_made_where_the_vehicle_is(client: Client) -> None:
    kind = UavType.objects.create(name="Kestrel")
    found = vehicle(41, Point(9.5, 47.1))
    answer = post(client, f"unknown-vehicles/{found.pk}/adopt", {"name": "Kite", "uav_type": kind.pk}).json()
    assert answer["geometry"]["coordinates"] == [9.5, 47.1]
    assert (answer["properties"]["name"], answer["properties"]["type"], answer["properties"]["mavlink_system_id"]) == ("Kite", kind.pk, 41)


def test_a_vehicle_without_a_place_needs_one(client: Client) -> None:
    found = vehicle(41)
    answer = post(client, f"unknown-vehicles/{found.pk}/adopt", {"name": "Kite"})
    assert (answer.status_code, answer.json()["error"]["code"]) == (409, "no_position")
    assert not Uav.objects.exists()
    assert post(client, f"unknown-vehicles/{found.pk}/adopt", {"name": "Kite", "position": [9.5, 47.1]}).status_code == 200


@pytest.mark.parametrize("body", [{}, {"uav": 1, "name": "Kite"}, {"uav": "x"}, {"name": ""}, {"name": "Kite", "system": 3}])
def test_what_says_neither_whose_it_is_nor_what_is_new_is_refused(client: Client, body: dict[str, Any]) -> None:
    found = vehicle(41, Point(9.5, 47.1))
    assert post(client, f"unknown-vehicles/{found.pk}/adopt", body).status_code == 400
    assert UnknownVehicle.objects.get().state == UnknownVehicleState.NEW


def test_a_taken_name_or_system_id_changes_nothing(client: Client) -> None:
    a_uav("Kite", mavlink_system_id=41)
    tern = a_uav("Tern")
    found = vehicle(41, Point(9.5, 47.1))
    assert post(client, f"unknown-vehicles/{found.pk}/adopt", {"uav": tern.pk}).json()["error"]["code"] == "system_id_taken"
    other = vehicle(42, Point(9.5, 47.1))
    assert post(client, f"unknown-vehicles/{other.pk}/adopt", {"name": "Kite"}).json()["error"]["code"] == "name_taken"
    assert set(UnknownVehicle.objects.values_list("state", flat=True)) == {UnknownVehicleState.NEW}


def test_one_is_adopted_once(client: Client) -> None:
    found = vehicle(41)
    post(client, f"unknown-vehicles/{found.pk}/adopt", {"uav": a_uav("Kite").pk})
    again = post(client, f"unknown-vehicles/{found.pk}/adopt", {"uav": a_uav("Tern").pk})
    assert (again.status_code, again.json()["error"]["code"]) == (409, "already_settled")
    assert post(client, f"unknown-vehicles/{found.pk}/ignore").status_code == 409
    assert client.delete(f"/api/v1/unknown-vehicles/{found.pk}/ignore").status_code == 409


def test_an_ignored_one_can_be_heeded_again_or_adopted(client: Client) -> None:
    found = vehicle(41)
    address = f"unknown-vehicles/{found.pk}/ignore"
    assert [post(client, address).json()["state"] for _ in range(2)] == ["ignored", "ignored"]
    assert listed(client) == []
    assert client.delete(f"/api/v1/{address}").json()["settled_by"] is None
    assert listed(client) == [41]
    post(client, address)
    assert post(client, f"unknown-vehicles/{found.pk}/adopt", {"uav": a_uav("Kite").pk}).status_code == 200


def test_another_organisations_uav_is_none_to_adopt_for(client: Client) -> None:
    foreign = a_uav("Kite", Organisation.objects.create(name="Elsewhere"))
    assert post(client, f"unknown-vehicles/{vehicle(41).pk}/adopt", {"uav": foreign.pk}).status_code == 404


@pytest.mark.parametrize("role", [Role.VIEWER, Role.OPERATOR, Role.CURATOR])
def test_others_neither_see_nor_settle_them(role: Role) -> None:
    found, client = vehicle(41), client_of(a_user(role))
    asked = [client.get("/api/v1/unknown-vehicles"), post(client, f"unknown-vehicles/{found.pk}/adopt", {"uav": 1})]
    assert {answer.status_code for answer in [*asked, post(client, f"unknown-vehicles/{found.pk}/ignore")]} == {403}


# --- how a UAV is connected --------------------------------------------------------------------------------------------------------


def test_a_uav_that_was_never_heard_says_so(client: Client) -> None:
    reported = client.get(f"/api/v1/uavs/{a_uav('Kite').pk}/connection").json()
    assert (reported["link"], reported["last_message_at"], reported["last_message_link"], reported["mode"], reported["is_in_air"]) == (
        "mavlink",
        None,
        None,
        "",
        None,
    )


def test_a_companions_newest_report_says_how_the_uav_does(client: Client) -> None:
    kite = linked_uav()
    kite.report(report(2, mode="Mission", is_armed=True, is_in_air=True, battery_percent=64.0, waypoint_sequence=3))
    kite.report(report(1, mode="Standby", is_in_air=False, measured_at=seconds_ago(600)))
    kite.report(report(3, mode="Nonsense", measured_at=seconds_ago(-86_400)))
    reported = client.get(f"/api/v1/uavs/{kite.uav.pk}/connection").json()
    assert (reported["link"], reported["last_message_link"], reported["mode"], reported["is_in_air"]) == ("http", "http", "Mission", True)
    assert (reported["battery_percent"], reported["waypoint_sequence"]) == (64.0, 3)
    assert reported["last_message_at"] <= reported["server_time"]


def test_the_door_by_which_a_uav_was_heard_is_told(client: Client) -> None:
    kite = a_uav("Kite")
    UavLink.objects.create(uav=kite, last_message_at=timezone.now(), address="udp 10.0.0.7:14550", mode="AUTO")
    assert client.get(f"/api/v1/uavs/{kite.pk}/connection").json()["last_message_link"] == "mavlink"


def test_what_a_companion_flies_to_is_in_progress() -> None:
    here, kite = world(), linked_uav(is_simulated=True)
    mission = dispatched(an_operator(), [kite.uav], [here.towers[1], here.towers[4]])
    visits = list(
        mission.routes.get().waypoints.filter(target__isnull=False).order_by("sequence").values_list("sequence", "target__sequence")
    )
    kite.report(report(1, waypoint_sequence=visits[0][0]))
    state = dict(mission.targets.values_list("sequence", "state"))
    assert (state[visits[0][1]], state[visits[-1][1]]) == (TargetState.IN_PROGRESS, TargetState.PENDING)
